#include "rigs/checkpoint_books.h"

#include "core/error.h"
#include "core/timers.h"

namespace tuft::rigs {

void write_books(const std::filesystem::path& path, const Scene& scene, const CheckpointFormat& format,
                 const CheckpointBooks& books, const std::function<void(h5::Group&)>& write_rest) {
  h5::File file = h5::File::create_atomically(path);
  h5::Group root = file.root();
  root.write_scalar(format.name, format.number);
  root.write_string("scene_hash", physics_hash(scene));
  h5::Group spent = root.create_group("spent");
  spent.write_scalar("wall", books.spent.wall);
  for (const auto& [phase, seconds] : books.spent.cost) spent.write_scalar(phase, seconds);
  h5::Group recorded = root.create_group("recorded");
  std::string names;
  std::vector<std::uint64_t> counts;
  for (const auto& [name, count] : books.recorded) {
    names += name + "\n";
    counts.push_back(count);
  }
  recorded.write_string("names", names);
  recorded.write("counts", std::span<const std::uint64_t>(counts));
  write_rest(root);
  file.commit();
}

namespace {

CheckpointBooks read_group(const h5::Group& root) {
  CheckpointBooks books;
  const h5::Group spent = root.open_group("spent");
  books.spent.wall = spent.read_double("wall");
  for (const auto phase : phase_names) books.spent.cost[std::string(phase)] = spent.read_double(phase);
  const h5::Group recorded = root.open_group("recorded");
  const std::string names = recorded.read_string("names");
  std::size_t begin = 0;
  for (const std::uint64_t count : recorded.read_counts("counts")) {
    const std::size_t end = names.find('\n', begin);
    books.recorded[names.substr(begin, end - begin)] = count;
    begin = end + 1;
  }
  return books;
}

}  // namespace

CheckpointBooks read_books(const std::filesystem::path& path, const Scene& scene,
                           const CheckpointFormat& format,
                           const std::function<void(const h5::Group&)>& read_rest) {
  if (!std::filesystem::exists(path))
    throw_input_error("{}: no checkpoint to resume from: start the scene again with tuft run", path.string());
  try {
    const h5::File file = h5::File::open(path);
    const h5::Group root = file.root();
    if (!root.has(format.name) || root.read_count(format.name) != format.number)
      throw_input_error("{}: checkpoint of another format: resume with the version that wrote it",
                        path.string());
    if (root.read_string("scene_hash") != physics_hash(scene))
      throw_input_error(
          "{}: checkpoint of another scene: restore the scene.toml it was written with, or start the scene "
          "again with tuft run",
          path.string());
    CheckpointBooks books = read_group(root);
    read_rest(root);
    return books;
  } catch (const RunError& error) {
    throw_input_error("{}: checkpoint is truncated or damaged ({}): start the scene again with tuft run",
                      path.string(), error.what());
  }
}

}  // namespace tuft::rigs
