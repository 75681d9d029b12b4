/// `tuft micro` of whole scenes: both infills cell by cell, and one strand among grains of true size.
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "cli/commands/command.h"
#include "core/hdf5_file.h"
#include "coupler/micro_reader.h"
#include "micro_scale/network_statistics.h"
#include "rigs/run_folder.h"

namespace tuft::test {
namespace {

/// The numbers behind a row's title.
std::vector<double> row_of(const std::string& table, const std::string& title) {
  const std::size_t at = table.find("\n  " + title);
  if (at == std::string::npos) return {};
  std::istringstream row(
      table.substr(at + 3 + title.size(), table.find('\n', at + 1) - at - 3 - title.size()));
  std::vector<double> numbers;
  for (double number = 0; row >> number;) numbers.push_back(number);
  return numbers;
}

/// A ring of infill, pressed with 10 N and unloaded.
constexpr double diameter = 0.016, height = 0.008;  // m
constexpr const char* small_ring[] = {"rig.diameter=16 mm",
                                      "rig.height=8 mm",
                                      "infill.sph.pitch=2 mm",
                                      "infill.dem.material_coarse_graining.sbr=1.5",
                                      "rig.preloads=[\"10 N\"]",
                                      "rig.seating_force=2 N",
                                      "rig.cycles=1",
                                      "rig.speed_factor=100.0",
                                      "rig.sample_travel=20 um",
                                      "rig.frame_rows=5",
                                      "numerics.contact_pressure=100 kPa",
                                      "output.micro.fields=true",
                                      "output.micro.cell=4 mm"};

class MicroOfAComparison : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<std::string> words{"compare", "inputs/oedometer_sbr.toml", "--out", folder_};
    for (const char* setting : small_ring) words.insert(words.end(), {"--set", setting});
    const Outcome outcome = run_tuft(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  }

  [[nodiscard]] std::string of(const std::string& approach) const { return folder_ + "/" + approach; }
  [[nodiscard]] h5::Group root(const std::string& approach) const {
    return h5::File::open(of(approach) + "/run.h5").root();
  }

  const Workplace place_;
  const std::string folder_ = place_.path("both");
};

/// One number a cell of a field in the last frame.
std::vector<double> cells_of(const h5::Group& root, const std::string& field, std::size_t components,
                             std::size_t component) {
  const h5::Group grid = root.open_group("frames").open_group("grid");
  const std::vector<double> all = grid.read_row(field, grid.shape(field).at(0) - 1);
  std::vector<double> cells;
  for (std::size_t c = component; c < all.size(); c += components) cells.push_back(all[c]);
  return cells;
}

TEST_F(MicroOfAComparison, PrintsMeansDifferenceAndCorrelationOfWhatBothFilesHold) {
  const Outcome micro = run_tuft({"micro", folder_});
  ASSERT_EQ(micro.exit_code, 0) << micro.error;
  const h5::Group a = root("sph"), b = root("dem");
  const std::vector<double> filled_a = cells_of(a, "density", 1, 0), filled_b = cells_of(b, "density", 1, 0);
  ASSERT_EQ(filled_a.size(), filled_b.size());
  const double least =
      0.1 * std::max(*std::ranges::max_element(filled_a), *std::ranges::max_element(filled_b));
  std::vector<std::size_t> taken;
  for (std::size_t c = 0; c < filled_a.size(); ++c)
    if (filled_a[c] >= least && filled_b[c] >= least) taken.push_back(c);
  ASSERT_GT(taken.size(), 20u);
  ASSERT_LT(taken.size(), filled_a.size()) << "there is room above the specimen";
  const std::string table = micro.out.substr(micro.out.find("\ncell by cell, "));
  EXPECT_EQ(table.rfind("\ncell by cell, over the " + std::to_string(taken.size()) +
                            " cells in which both have infill\n",
                        0),
            0u)
      << table.substr(0, 80);
  for (const char* part : {"mean sph", "mean dem", "rms difference", "relative", "correlation"})
    EXPECT_NE(table.find(part), std::string::npos) << part;

  struct Row {
    const char *title, *field;
    std::size_t components, component;
  };
  for (const Row& row : {Row{"density kg/m^3", "density", 1, 0}, Row{"porosity", "porosity", 1, 0},
                         Row{"velocity z m/s", "velocity", 3, 2}, Row{"stress xx Pa", "stress", 9, 0},
                         Row{"stress zz Pa", "stress", 9, 8}, Row{"stress xz Pa", "stress", 9, 2}}) {
    const std::vector<double> x = cells_of(a, row.field, row.components, row.component),
                              y = cells_of(b, row.field, row.components, row.component);
    const auto mean = [&](const auto& of_cell) {
      double sum = 0;
      for (const std::size_t c : taken) sum += of_cell(c);
      return sum / static_cast<double>(taken.size());
    };
    const double mx = mean([&](std::size_t c) { return x[c]; }),
                 my = mean([&](std::size_t c) { return y[c]; });
    const double apart = std::sqrt(mean([&](std::size_t c) { return (x[c] - y[c]) * (x[c] - y[c]); }));
    const double size = std::sqrt(mean([&](std::size_t c) { return 0.25 * (x[c] + y[c]) * (x[c] + y[c]); }));
    const double together = mean([&](std::size_t c) { return (x[c] - mx) * (y[c] - my); }),
                 of_x = mean([&](std::size_t c) { return (x[c] - mx) * (x[c] - mx); }),
                 of_y = mean([&](std::size_t c) { return (y[c] - my) * (y[c] - my); });
    const std::vector<double> expected{mx, my, apart, apart / size, together / std::sqrt(of_x * of_y)};
    const std::vector<double> printed = row_of(table, row.title);
    ASSERT_EQ(printed.size(), expected.size()) << row.title << table;
    for (std::size_t k = 0; k < expected.size(); ++k)
      EXPECT_NEAR(printed[k], expected[k], 6e-4 * std::abs(expected[k])) << row.title << " " << k;
  }
}

/// Tests that are driven by strain reach a load at frames of their own.
TEST_F(MicroOfAComparison, IsMadeAtAFrameOfEachRunWhereTwoAreGiven) {
  const Outcome both = run_tuft({"micro", folder_, "--frame", "3,5"}),
                sph = run_tuft({"micro", of("sph"), "--frame", "3"}),
                dem = run_tuft({"micro", "--frame", "5", of("dem")});
  ASSERT_EQ(both.exit_code, 0) << both.error;
  EXPECT_EQ(both.out.rfind(sph.out + dem.out, 0), 0u);
  expect_bad_input(run_tuft({"micro", folder_, "--frame", "3,5,7"}), {"--frame", "3 frames for two runs"});
  expect_bad_input(run_tuft({"micro", of("sph"), "--frame", "3,5"}), {"--frame", "2 frames for one run"});
  expect_bad_input(run_tuft({"micro", of("sph"), "--frame", "-1"}), {"--frame"});
}

/// Summed over the grid, mass is that of the infill (to a share of it that a lattice or grains are off by);
/// and at rest stress times volume is the force on the plate times its height.
void expect_mass_and_force(const std::string& printed, const std::string& folder, double mass_error) {
  const h5::Group group = h5::File::open(folder + "/run.h5").root();
  const Scene scene = rigs::read_run_scene(folder);
  const Material& sbr = scene.materials.at(static_cast<std::size_t>(scene.rig.specimen.material));
  const bool sph = scene.infill.approach == Approach::sph;
  const double mass =
      std::numbers::pi / 4 * diameter * diameter * height * (sph ? sbr.continuum->density : sbr.bulk_density);
  const std::string its = printed.substr(printed.find(sph ? "sph, frame " : "dem, frame "));
  const std::size_t hold = its.find(" cells hold ");
  ASSERT_NE(hold, std::string::npos);
  const double held = std::stod(its.substr(hold + 12)),
               beyond = std::stod(its.substr(its.find("kg of infill; ", hold) + 14));
  EXPECT_NEAR((held + beyond) / mass, 1, mass_error) << folder;

  const std::vector<double> frame_times = group.read_doubles("frames/time"),
                            times = group.read_doubles("history/time"),
                            force = group.read_doubles("history/force");
  std::size_t at = 0, frame = 0;  // row and frame in which the plate presses most
  for (std::size_t f = 0; f < frame_times.size(); ++f)
    for (std::size_t row = 0; row < times.size(); ++row)
      if (times[row] == frame_times[f] && (frame == 0 || force[row] > force[at])) at = row, frame = f;
  ASSERT_GT(force[at], 5) << "of 10 N";
  const coupler::RecordedFields fields = coupler::read_fields(group, frame);
  double stress = 0;  // J, over space
  for (std::size_t c = 8; c < fields.values.at("stress").size(); c += 9)
    stress -= fields.values.at("stress")[c] * fields.grid.cell_volume();
  // Rows of SPH have their last half beyond their centres, in the plates' reach.
  const double plate = group.open_group("frames").read_row("bodies/upper_plate/position", frame).at(2),
               reach = sph ? 0.5 * scene.infill.sph.pitch : 0;
  EXPECT_NEAR(stress / (force[at] * (plate - reach)), 1, 0.05) << folder;
}

TEST_F(MicroOfAComparison, HasTheMassOfTheSpecimenAndTheForceOfThePlateOnBothSides) {
  const Outcome micro = run_tuft({"micro", folder_});
  expect_mass_and_force(micro.out, of("sph"), 0.002);
  expect_mass_and_force(micro.out, of("dem"), 0.02);
}

TEST(MicroOfClumps, HasTheMassOfTheSpecimenTheForceOfThePlateAndContactsOfWholeClumps) {
  const Workplace place;
  std::vector<std::string> words{"run",   "inputs/oedometer_sbr_clumps.toml", "--out", place.path("run"),
                                 "--set", "output.micro.contacts=true"};
  for (const char* setting : small_ring) words.insert(words.end(), {"--set", setting});
  const Outcome outcome = run_tuft(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Outcome micro = run_tuft({"micro", place.path("run")});
  expect_mass_and_force(micro.out, place.path("run"), 0.02);
  const h5::Group root = h5::File::open(place.path("run") + "/run.h5").root();
  const std::size_t clumps = coupler::particle_count(root);
  EXPECT_EQ(4 * clumps, root.open_group("frames").open_group("infill").shape("position").at(1))
      << "of four spheres each";
  const ContactNetwork network = coupler::read_contacts(root, 0);
  for (std::size_t c = 0; c < network.size(); ++c)
    ASSERT_LT(static_cast<std::size_t>(network.particle[c]), clumps);
  EXPECT_NE(read_text(place.path("run/run.xdmf")).find("frames/infill/grain"), std::string::npos);
}

TEST(MicroPullOut, RecordsEveryKindOfContactFabricAndFieldsWithEachFrameAndOnDemand) {
  const Workplace place;
  const std::string folder = place.path("run");
  const Outcome outcome = run_tuft(
      {"run", "inputs/micro_pull_out.toml", "--out", folder, "--set", "rig.size=[\"14 mm\", \"8 mm\"]",
       "--set", "rig.height=10 mm", "--set", "rig.embedded_length=12 mm", "--set", "rig.normal_stress=20 kPa",
       "--set", "rig.travel=1 mm", "--set", "rig.run_speed=400 mm/s", "--set", "rig.load_time=2 ms"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const h5::Group root = h5::File::open(folder + "/run.h5").root();
  const std::size_t frames = coupler::micro_frames(root);
  ASSERT_GE(frames, 4u);
  EXPECT_EQ(frames, root.open_group("frames").shape("time").at(0)) << "with each frame";
  const std::size_t grains = coupler::particle_count(root);
  EXPECT_GT(grains, 150u);
  const std::vector<double> xx = root.read_doubles("micro/fabric_xx"),
                            yy = root.read_doubles("micro/fabric_yy"),
                            zz = root.read_doubles("micro/fabric_zz");
  for (std::size_t f = 0; f < frames; ++f) {
    const ContactNetwork network = coupler::read_contacts(root, f);
    const micro::NetworkStatistics statistics = micro::describe_network(network, grains);
    const auto contacts = [&](ContactKind kind) {
      return statistics.contacts[static_cast<std::size_t>(kind)];
    };
    EXPECT_GT(contacts(ContactKind::grain), grains) << f;
    EXPECT_GT(contacts(ContactKind::fibre), 3u) << f;
    EXPECT_GT(contacts(ContactKind::body), 10u) << f;
    EXPECT_NEAR(xx[f] + yy[f] + zz[f], 1, 1e-6) << f;
    EXPECT_NEAR(zz[f], statistics.fabric(2, 2), 1e-6) << f;
    const std::vector<double> density = root.open_group("micro").read_row("normal_force_density", f);
    const micro::ForceBins bins;
    ASSERT_EQ(density.size(), bins.count);
    double inside = 0;
    for (const double value : density) inside += value * bins.width;
    EXPECT_NEAR(inside, 1, 0.03) << "hardly a force is more than six times the mean; " << f;
    EXPECT_GT(root.read_doubles("micro/spin_rms").at(f) + (f == 0 ? 1 : 0), 0.0);
  }

  // The strand is drawn against what grains push it back with.
  double on_grains = 0;  // N, along the strand
  const ContactNetwork last = coupler::read_contacts(root, frames - 1);
  for (std::size_t c = 0; c < last.size(); ++c)
    if (last.kind[c] == ContactKind::fibre) on_grains += last.force(c).x();
  const double force = root.read_doubles("history/force").back();
  EXPECT_NEAR(std::abs(on_grains), force, 0.25 * force);

  const Outcome frame = run_tuft({"micro", folder}), checkpoint = run_tuft({"micro", folder, "--checkpoint"});
  ASSERT_EQ(checkpoint.exit_code, 0) << checkpoint.error;
  EXPECT_EQ(frame.out.substr(frame.out.find('\n')), checkpoint.out.substr(checkpoint.out.find('\n')));
  EXPECT_NE(checkpoint.out.find("fields by height"), std::string::npos);
}

}  // namespace
}  // namespace tuft::test
