#pragma once
/// Pieces of an XDMF 3 text that refer to datasets of an HDF5 file.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tuft::rigs::xdmf {

using Shape = std::vector<std::uint64_t>;

inline std::string dimensions(const Shape& shape) {
  return fmt::format("{}", fmt::join(shape, " "));
}

/// A whole dataset.
inline std::string data_item(const std::string& file, const std::string& path, const Shape& shape,
                             bool integer) {
  return fmt::format("<DataItem Dimensions=\"{}\" {} Format=\"HDF\">{}:{}</DataItem>", dimensions(shape),
                     integer ? "NumberType=\"Int\" Precision=\"4\"" : "NumberType=\"Float\" Precision=\"8\"",
                     file, path);
}

/// A hyperslab of a dataset: `count` rows from `first` on, read as values of shape `as`.
inline std::string rows_item(const std::string& file, const std::string& path, const Shape& shape,
                             std::uint64_t first, std::uint64_t rows, const Shape& as, bool integer) {
  Shape start(shape.size(), 0), stride(shape.size(), 1), count = shape;
  start[0] = first;
  count[0] = rows;
  return fmt::format(
      "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{}\" Type=\"HyperSlab\">\n"
      "            <DataItem Dimensions=\"3 {}\" NumberType=\"Int\" Format=\"XML\">{} {} {}</DataItem>\n"
      "            {}\n          </DataItem>",
      dimensions(as), shape.size(), dimensions(start), dimensions(stride), dimensions(count),
      data_item(file, path, shape, integer));
}

/// Row `frame` of a dataset [F, ...].
inline std::string frame_item(const std::string& file, const std::string& path, const Shape& shape,
                              std::uint64_t frame) {
  return rows_item(file, path, shape, frame, 1, Shape(shape.begin() + 1, shape.end()), false);
}

/// type: "Scalar", "Vector" or "Tensor" (nine values).
inline std::string attribute(const std::string& name, std::string_view type, const std::string& item,
                             std::string_view centre = "Node") {
  return fmt::format(
      "        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">\n          {}\n        "
      "</Attribute>\n",
      name, type, centre, item);
}

}  // namespace tuft::rigs::xdmf
