#include "dem_bridge/clump_bodies.h"

#include <Eigen/Dense>

#include <cmath>
#include <cstring>
#include <numbers>

#include "core/error.h"
#include "dem_bridge/protocol.h"

namespace tuft::dem {
namespace {

constexpr double largest_misfit = 1e-6;  // of the diameter

/// Kabsch: the rotation that takes the shape's centres nearest to where the spheres are. For spheres in a row
/// or plane, which leave turns open, one of those that do. The centre of mass is met by the shares of mass.
void fit(GrainBody& body, const ClumpBody& shape, const Grains& grains) {
  body.centre = Vec3(0, 0, 0);
  for (std::size_t k = 0; k < body.count; ++k)
    body.centre += shape.share[k] * grains.position[body.first + k];
  Mat3 overlap = Mat3::Zero();
  for (std::size_t k = 0; k < body.count; ++k)
    overlap += (grains.position[body.first + k] - body.centre) * shape.centre[k].transpose();
  const Eigen::JacobiSVD<Mat3> svd(overlap, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 right_handed = Mat3::Identity();
  right_handed(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  body.axes = svd.matrixU() * right_handed * svd.matrixV().transpose();
}

void check_fit(const GrainBody& body, const ClumpBody& shape, const Grains& grains, std::string_view name) {
  for (std::size_t k = 0; k < body.count; ++k) {
    const std::size_t i = body.first + k;
    const Vec3 wanted = body.centre + body.diameter * (body.axes * shape.centre[k]);
    const double off = (grains.position[i] - wanted).norm() / body.diameter,
                 thicker = std::abs(grains.radius[i] / body.diameter - shape.radius[k]);
    if (!(std::max(off, thicker) <= largest_misfit))
      throw_input_error(
          "DEM infill: sphere {} is off its place in a clump of {} by {:.3g} of the clump's size, its radius "
          "by {:.3g}; pack them by that material's clump",
          i, name, off, thicker);
    if (grains.material[i] != body.material || grains.density[i] != grains.density[body.first])
      throw_input_error("DEM infill: sphere {} is of another material or density than the first of its clump",
                        i);
  }
}

}  // namespace

std::vector<ClumpBody> clump_shapes(const std::vector<Material>& materials) {
  std::vector<ClumpBody> shapes(materials.size());
  for (std::size_t m = 0; m < materials.size(); ++m)
    if (materials[m].grain && materials[m].grain->clump)
      shapes[m] = make_clump_body(*materials[m].grain->clump, materials[m].name);
  return shapes;
}

GrainBodies find_bodies(const Grains& grains, const std::vector<Material>& materials) {
  GrainBodies found;
  if (grains.body.empty()) return found;
  found.shapes = clump_shapes(materials);
  std::vector<bool> seen;
  for (std::size_t i = 0; i < grains.size();) {
    const Index number = grains.body[i];
    if (number < 0) {
      ++i;
      continue;
    }
    GrainBody body;
    body.first = i;
    body.material = grains.material[i];
    while (i < grains.size() && grains.body[i] == number) ++i;
    body.count = i - body.first;
    const auto place = static_cast<std::size_t>(number);
    if (place >= seen.size()) seen.resize(place + 1, false);
    if (seen[place])
      throw_input_error("DEM infill: the spheres of clump {} do not follow each other", number);
    seen[place] = true;
    const ClumpBody& shape = found.shapes[static_cast<std::size_t>(body.material)];
    const std::string& name = materials[static_cast<std::size_t>(body.material)].name;
    if (shape.size() != body.count)
      throw_input_error("DEM infill: clump {} has {} spheres, one of {} has {}", number, body.count, name,
                        shape.size());
    body.diameter = grains.radius[body.first] / shape.radius[0];
    body.mass = std::numbers::pi / 6 * std::pow(body.diameter, 3) * grains.density[body.first];
    fit(body, shape, grains);
    check_fit(body, shape, grains, name);
    found.bodies.push_back(body);
  }
  return found;
}

std::vector<std::uint8_t> bodies_file(const GrainBodies& bodies, const Grains& grains) {
  std::vector<std::uint8_t> bytes;
  const auto add = [&bytes](const auto& record) {
    const auto* const data = reinterpret_cast<const std::uint8_t*>(&record);
    bytes.insert(bytes.end(), data, data + sizeof record);
  };
  for (const GrainBody& body : bodies.bodies) {
    const ClumpBody& shape = bodies.shape_of(body);
    const Vec3 inertia = bodies.inertia_of(body);
    BodyRecord record;
    record.first = body.first;
    record.count = body.count;
    record.mass = body.mass;
    record.density = grains.density[body.first];
    record.reach = body.diameter * shape.reach;
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto at = static_cast<std::size_t>(c);
      record.centre[at] = body.centre[c];
      record.inertia[at] = inertia[c];
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        record.axes[static_cast<std::size_t>(axis)][at] = body.axes(c, axis);
    }
    add(record);
    for (std::size_t k = 0; k < body.count; ++k) {
      const Vec3 place = body.diameter * shape.centre[k];
      add(BodySphere{{place.x(), place.y(), place.z()}, shape.share[k]});
    }
  }
  return bytes;
}

}  // namespace tuft::dem
