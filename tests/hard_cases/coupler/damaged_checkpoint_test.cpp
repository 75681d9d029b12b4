/// Every dataset of a checkpoint, damaged in turn: what does not fit is refused in one line that names it,
/// before anything is made of it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <limits>
#include <map>

#include "core/error.h"
#include "core/hdf5_file.h"
#include "coupler/build_simulation.h"
#include "tests/verification/coupler/coarse_scene.h"

namespace tuft::coupler {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The simulation of a small bed among strands, and its checkpoint after some steps.
class Bed {
 public:
  explicit Bed(const Overrides& more, bool conditioned = false) {
    Overrides overrides{{"infill.sph.pitch", "8 mm"}};
    overrides.insert(overrides.end(), more.begin(), more.end());
    scene_ = rigs::coarse_scene(overrides);
    request_.scene = &scene_;
    request_.effects = decide_effects(scene_);
    request_.before_conditioning = conditioned;
    BuiltSimulation run = build_simulation(request_);
    for (int k = 0; k < 20; ++k) run.simulation->advance_interval(5e-5);
    h5::File file = h5::File::create_atomically(whole());
    h5::Group group = file.root().create_group("simulation");
    run.simulation->save(group);
    file.commit();
    fresh_ = build_simulation(request_);
  }
  ~Bed() {
    std::filesystem::remove(whole());
    std::filesystem::remove(damaged());
  }
  [[nodiscard]] std::filesystem::path whole() const { return folder_ / fmt::format("{}.h5", name_); }
  [[nodiscard]] std::filesystem::path damaged() const {
    return folder_ / fmt::format("{}-damaged.h5", name_);
  }

  /// What is said of the damaged one; empty: it was taken. Refused ones leave nothing behind that bears on
  /// the next.
  [[nodiscard]] std::string refusal() {
    try {
      fresh_.simulation->load(h5::File::open(damaged()).root().open_group("simulation"));
    } catch (const InputError& error) {
      return error.what();
    } catch (const std::exception& error) {
      return fmt::format("not the user's error: {}", error.what());
    }
    return "";
  }

 private:
  std::filesystem::path folder_ = std::filesystem::temp_directory_path();
  std::string name_ = fmt::format("tuft-test-{}-damaged-checkpoint", ::getpid());
  Scene scene_;
  BuildRequest request_;
  BuiltSimulation fresh_;
};

struct Dataset {
  std::string path;
  std::vector<double> values;
  bool is_scalar = false;
};

std::vector<std::string> datasets_of(const std::filesystem::path& path) {
  std::vector<std::string> names;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto note = [](hid_t, const char* name, const H5O_info_t* info, void* list) -> herr_t {
    if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, note, &names, H5O_INFO_BASIC);
  H5Fclose(file);
  return names;
}

std::vector<double> values_of(const std::filesystem::path& path, const std::string& name) {
  return h5::File::open(path).root().read_doubles(name);
}

/// In a copy, puts these values in a dataset's place.
void replace(const Bed& bed, const std::string& name, const std::vector<double>& values) {
  std::filesystem::copy_file(bed.whole(), bed.damaged(), std::filesystem::copy_options::overwrite_existing);
  const hid_t file = H5Fopen(bed.damaged().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const hsize_t count = values.size();
  const hid_t space = H5Screate_simple(1, &count, nullptr),
              dataset = H5Dcreate2(file, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT,
                                   H5P_DEFAULT);
  if (count > 0) H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(dataset), H5Sclose(space), H5Fclose(file);
}

/// Of two datasets whose lengths go by each other either may be named.
const std::map<std::string, std::string> other_of_pair{{"keys", "histories"},
                                                       {"strain_work", "hourglass_work"}};

void expect_refused(Bed& bed, const std::string& path, const std::string& damage) {
  SCOPED_TRACE(fmt::format("{}, {}", path, damage));
  const std::string said = bed.refusal(), group = path.substr(0, path.rfind('/') + 1);
  const auto other = other_of_pair.find(path.substr(group.size()));
  const bool of_other = other != other_of_pair.end() &&
                        said.find(fmt::format("/{}{} ", group, other->second)) != std::string::npos;
  EXPECT_TRUE(of_other || said.find(fmt::format("/{} ", path)) != std::string::npos) << said;
  for (const char* part : {"damaged", "start the scene again"})
    EXPECT_NE(said.find(part), std::string::npos) << said;
  EXPECT_EQ(said.find(bed.damaged().string()), 0u) << said;
  EXPECT_EQ(said.find('\n'), std::string::npos) << said;
}

/// What is not damaged is taken, also after all that.
std::string refusal_of_the_whole(Bed& bed) {
  std::filesystem::copy_file(bed.whole(), bed.damaged(), std::filesystem::copy_options::overwrite_existing);
  return bed.refusal();
}

void expect_each_damage_refused(Bed& bed, std::size_t least_datasets) {
  const std::vector<std::string> names = datasets_of(bed.whole());
  EXPECT_GE(names.size(), least_datasets);
  for (const std::string& name : names) {
    const std::vector<double> values = values_of(bed.whole(), name);
    std::vector<double> more = values, spoiled = values;
    more.push_back(values.empty() ? nan : values.back());
    replace(bed, name, more);
    expect_refused(bed, name, "a value too many");
    if (values.empty()) continue;
    replace(bed, name, {values.begin(), values.end() - 1});
    expect_refused(bed, name, "a value too few");
    spoiled[spoiled.size() / 2] = nan;
    replace(bed, name, spoiled);
    expect_refused(bed, name, "a value that is no number");
  }
}

void expect_value_refused(Bed& bed, const std::string& name, std::size_t entry, double value) {
  std::vector<double> values = values_of(bed.whole(), name);
  if (values.size() <= entry) values.resize(entry + 1);
  values[entry] = value;
  replace(bed, name, values);
  expect_refused(bed, name, fmt::format("[{}] = {}", entry, value));
}

Overrides all_that_a_checkpoint_holds() {
  return {{"numerics.sleep_tolerance", "1e-6"},
          {"numerics.individual_steps", "8"},
          {"numerics.subcycle_carpet", "true"},
          {"effects.fibre_separation", "true"},
          {"effects.zero_energy_control", "true"}};
}

TEST(DamagedCheckpoint, EachDatasetOfABedOfSphThatIsTooLongTooShortOrNoNumberIsRefused) {
  Bed bed(all_that_a_checkpoint_holds());
  expect_each_damage_refused(bed, 100);
  EXPECT_EQ(refusal_of_the_whole(bed), "");
}

TEST(DamagedCheckpoint, ValuesOfABedOfSphThatCannotBeAreRefused) {
  Bed bed(all_that_a_checkpoint_holds());
  const std::string infill = "simulation/infill/", carpet = "simulation/carpet/";
  const auto particles = static_cast<double>(values_of(bed.whole(), infill + "x").size());
  const auto blocks = static_cast<double>(values_of(bed.whole(), infill + "sleep_held").size());
  struct Case {
    std::string dataset;
    std::size_t entry;
    double value;
  };
  const std::vector<Case> cases{
      {infill + "expelled", 0, particles},
      {infill + "expelled", 0, -1},
      {infill + "expelled", 0, 0.5},
      {infill + "separated_pairs", 0, particles},
      {infill + "separated_pairs", 0, -1},
      {infill + "separated_pairs", 1, 0},
      {infill + "x", 3, 1e9},
      {infill + "list_place_z", 3, -1e9},
      {infill + "compression", 2, 2},
      {infill + "volume", 0, 0},
      {infill + "volume", 0, -1e-9},
      {infill + "bulk_modulus", 0, -1},
      {infill + "stable_step", 0, 0},
      {infill + "step_before", 0, -1e-6},
      {infill + "particle_steps", 0, -1},
      {infill + "particle_steps", 0, 1e300},
      {infill + "sleep_neighbours", 0, blocks},
      {infill + "sleep_neighbours", 0, -1},
      {infill + "sleep_neighbour_count", 0, 1e9},
      {infill + "sleep_held", 0, 2},
      {infill + "sleep_listed", 0, -1},
      {infill + "sleep_quiet", 0, 1e6},
      {infill + "sleep_contact_x", 0, 1e300},
      {infill + "block_stable_step", 0, -1},
      {infill + "steps_period", 0, 0},
      {infill + "steps_period", 0, 3},
      {infill + "steps_period", 0, 16},
      {infill + "steps_kick_period", 0, 0},
      {infill + "steps_pace", 0, 0},
      {infill + "steps_pace", 0, 6},
      {infill + "steps_pace", 0, 256},
      {infill + "steps_since_kick_count", 0, 256},
      {infill + "steps_contact_rate", 0, -1},
      {infill + "steps_numbers", 0, 16},
      {infill + "steps_numbers", 1, 0},
      {infill + "steps_numbers", 1, 5},
      {infill + "steps_numbers", 2, -1},
      {infill + "steps_in_step", 0, 2},
      {infill + "list_skin", 0, 0},
      {infill + "list_skin", 0, 1},
      {infill + "list_next_skin", 0, -1},
      {infill + "own_step", 0, -1},
      {infill + "displacement", 0, -1},
      {infill + "stress_records", 5, 1e300},
      {carpet + "eroded", 0, 2},
      {carpet + "last_step", 0, -1},
      {carpet + "steps", 0, 0.5},
      {carpet + "from_rest", 0, 3},
      {carpet + "strain_work", 1000000, 0},
      {"simulation/numbers", 15, 0},
      {"simulation/numbers", 17, 1e300},
      {"simulation/ledger/state", 4, -1},
      {"simulation/searches", 0, -1},
      {"simulation/windowed", 0, 2},
      {"simulation/reference_valid", 0, -1},
      {"simulation/particle_body/keys", 0, 1e19},
      {"simulation/particle_shell/keys", 0, 1e19},
      {"simulation/node_body/keys", 0, 1e19},
      {"simulation/particle_body/initial_overlap_pairs", 0, 0.5},
  };
  for (const Case& damage : cases) expect_value_refused(bed, damage.dataset, damage.entry, damage.value);
  EXPECT_EQ(refusal_of_the_whole(bed), "");
}

TEST(DamagedCheckpoint, EachDatasetOfABedOfSpheresIsRefused) {
  Bed bed({{"conditioning.method", "compaction"}}, true);
  expect_each_damage_refused(bed, 60);
  EXPECT_EQ(refusal_of_the_whole(bed), "");
}

}  // namespace
}  // namespace tuft::coupler
