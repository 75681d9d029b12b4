// The micro-scale of whole runs: what they record of it, and that it changes nothing.
#include <gtest/gtest.h>

#include "coarse_scene.h"
#include "core/hdf5_file.h"
#include "coupler/micro_reader.h"
#include "micro_scale/field_comparison.h"
#include "micro_scale/network_statistics.h"

namespace tuft::rigs {
namespace {

Overrides of(const std::string& approach, const Overrides& more) {
  Overrides overrides{
      {"infill.approach", approach}, {"numerics.settle_time", "2 ms"}, {"scene.duration", "4 ms"}};
  if (approach == "dem")
    overrides.insert(overrides.end(), {{"infill.dem.host", TUFT_TEST_HOST},
                                       {"infill.dem.use_cache", "false"},
                                       {"infill.dem.material_coarse_graining", "{ sbr = 5.0, sand = 7.0 }"}});
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}
const Overrides looking{{"output.micro.contacts", "true"}, {"output.micro.fields", "true"}};

Overrides with(const Overrides& a, const Overrides& b) {
  Overrides both = a;
  both.insert(both.end(), b.begin(), b.end());
  return both;
}

h5::Group recorded(const std::string& name, const Overrides& overrides, int stop_after = 0) {
  RunRequest request;
  request.scene = coarse_scene(overrides);
  request.folder = fresh_folder(name);
  request.stop_after_checkpoints = stop_after;
  RunSummary summary = run(request);
  EXPECT_EQ(summary.error, "");
  if (stop_after > 0) {
    EXPECT_EQ(summary.status, "stopped");
    request.stop_after_checkpoints = 0;
    request.resume = true;
    summary = run(request);
  }
  EXPECT_EQ(summary.status, "completed") << summary.error;
  return h5::File::open(request.folder / "run.h5").root();
}

std::vector<double> doubles(const h5::Group& root, const std::string& path) {
  return root.read_doubles(path);
}

class MicroScaleOfRuns : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Approaches, MicroScaleOfRuns, ::testing::Values("sph", "dem"));

TEST_P(MicroScaleOfRuns, ChangesNoBitOfThem) {
  const std::string approach = GetParam();
  const h5::Group plain = recorded(approach + "-plain", of(approach, {})),
                  looked = recorded(approach + "-looked", of(approach, looking));
  for (const char* path : {"history/velocity", "history/acceleration", "energy/error",
                           "frames/infill/position", "frames/infill/velocity", "frames/carpet/position"})
    EXPECT_EQ(doubles(plain, path), doubles(looked, path)) << path;
  EXPECT_FALSE(plain.has("micro"));
  EXPECT_FALSE(plain.open_group("frames").has("contacts"));
  EXPECT_FALSE(plain.open_group("frames").has("grid"));
}

TEST_P(MicroScaleOfRuns, IsRecordedTheSameByARunThatWasResumed) {
  const std::string approach = GetParam();
  const Overrides often = with(of(approach, {{"output.checkpoint_every", "2 ms"}}), looking);
  const h5::Group through = recorded(approach + "-through", often),
                  resumed = recorded(approach + "-resumed", often, 1);
  for (const char* path :
       {"frames/contacts/end", "frames/contacts/pair", "frames/contacts/kind", "frames/contacts/normal_force",
        "frames/contacts/tangential_force", "frames/contacts/ends", "frames/grid/stress",
        "frames/grid/density", "micro/coordination", "micro/contacts_body", "micro/time"})
    EXPECT_EQ(doubles(through, path), doubles(resumed, path)) << path;
}

TEST_P(MicroScaleOfRuns, HoldsTheMassOfTheInfillAndTheForceOnTheMissile) {
  const std::string approach = GetParam();
  const h5::Group root =
      recorded(approach + "-mass", with(of(approach, {{"scene.duration", "8 ms"}}), looking));
  const std::size_t frames = coupler::micro_frames(root);
  ASSERT_GE(frames, 5u);
  const coupler::RecordedFields fields = coupler::read_fields(root, frames - 1);
  double mass = doubles(root, "frames/grid/mass_outside").back();
  for (const double density : fields.values.at("density")) mass += density * fields.grid.cell_volume();
  const Scene scene = coarse_scene(of(approach, {}));
  double expected = 0;
  for (const Layer& layer : scene.turf.layers)
    expected += scene.materials[static_cast<std::size_t>(layer.material)].bulk_density * layer.depth *
                scene.turf.size[0] * scene.turf.size[1];
  EXPECT_NEAR(mass, expected, (approach == "sph" ? 1e-6 : 0.01) * expected);

  // The missile is the body that rises; what presses it is what its acceleration needs.
  const ContactNetwork network = coupler::read_contacts(root, frames - 1);
  const micro::NetworkStatistics statistics = micro::describe_network(network, coupler::particle_count(root));
  EXPECT_GT(statistics.contacts[static_cast<std::size_t>(ContactKind::body)], 10u);
  EXPECT_GT(statistics.contacts[static_cast<std::size_t>(ContactKind::fibre)], 10u);
  if (approach == "dem") {
    EXPECT_GT(statistics.coordination, 2);
    EXPECT_LT(statistics.coordination, 8);
    EXPECT_GT(statistics.strong_share, 0.5);
  } else {
    EXPECT_EQ(statistics.contacts[static_cast<std::size_t>(ContactKind::grain)], 0u);
  }
}

/// Mean over the patch: what hangs on the material above a height is carried by the stress there, or by
/// fibres, walls and floor.
double imbalance_at_rest(const coupler::RecordedFields& fields) {
  constexpr double g = 9.81;
  const std::vector<double> density = micro::profile(fields.grid, fields.values.at("density")),
                            given = micro::profile(fields.grid, fields.values.at("boundary_force"), 3, 2),
                            stress = micro::profile(fields.grid, fields.values.at("stress"), 9, 8);
  const double h = fields.grid.spacing.z();
  double above = 0, worst = 0, weight = 0;
  for (const double rho : density) weight += g * rho * h;
  const std::size_t lowest = 2;  // the floor's force is spread over the cells below
  for (std::size_t k = density.size(); k-- > lowest;) {
    const double here = h * (g * density[k] - given[k]);
    worst = std::max(worst, std::abs(-stress[k] - (above + 0.5 * here)));
    above += here;
  }
  return worst / weight;
}

TEST(MicroScaleAtRest, WeighsTheSameInBothApproachesAndIsInBalanceWithIt) {
  std::map<std::string, double> weight;
  for (const char* approach : {"sph", "dem"}) {
    const h5::Group root = recorded(
        std::string(approach) + "-rest",
        with(of(approach, {{"numerics.settle_time", "40 ms"}, {"scene.duration", "2 ms"}}), looking));
    const std::vector<double> time = doubles(root, "frames/time");
    std::size_t frame = 0;
    while (time[frame] < -1e-9) ++frame;
    ASSERT_NEAR(time[frame], 0, 1e-9);
    const coupler::RecordedFields fields = coupler::read_fields(root, frame);
    const double imbalance = imbalance_at_rest(fields);
    RecordProperty(std::string("imbalance_") + approach, testing::PrintToString(imbalance));
    std::printf("%s: imbalance over weight %g\n", approach, imbalance);
    EXPECT_LT(imbalance, 0.02) << approach;
    for (const double rho : micro::profile(fields.grid, fields.values.at("density")))
      weight[approach] += 9.81 * rho * fields.grid.spacing.z();
  }
  EXPECT_NEAR(weight["dem"], weight["sph"], 0.01 * weight["sph"]);
}

}  // namespace
}  // namespace tuft::rigs
