// The micro-scale of whole runs: what they record of it, and that it changes nothing.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <numeric>
#include <regex>
#include <sstream>

#include "coarse_scene.h"
#include "core/hdf5_file.h"
#include "coupler/micro_reader.h"
#include "micro_scale/network_statistics.h"

namespace tuft::rigs {
namespace {

Overrides of(const std::string& approach, const Overrides& more) {
  Overrides overrides{{"infill.approach", approach},
                      {"numerics.settle_time", "2 ms"},
                      {"numerics.settle_time_limit", "2 ms"},
                      {"scene.duration", "4 ms"}};
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

TEST_P(MicroScaleOfRuns, HoldsTheMassOfTheInfillAndItsContactsByKind) {
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

/// Grains lie on carpet and tray before the first window; how many, is a matter of the bed.
TEST(MicroScaleOfGrains, HoldsContactsWithCarpetAndTrayFromTheFirstFrameOn) {
  const h5::Group root = recorded("dem-first", with(of("dem", {{"scene.duration", "0.5 ms"}}), looking));
  const ContactNetwork network = coupler::read_contacts(root, 0);
  const auto contacts = micro::describe_network(network, coupler::particle_count(root)).contacts;
  EXPECT_GT(contacts[static_cast<std::size_t>(ContactKind::backing)], 0u);
  EXPECT_GT(contacts[static_cast<std::size_t>(ContactKind::body)], 0u);
}

/// ParaView's way in: every dataset that run.xdmf names exists with the dimensions it names, and every
/// hyperslab lies inside its dataset and has as many numbers as it says.
TEST_P(MicroScaleOfRuns, IsFoundByRunXdmf) {
  const std::string approach = GetParam();
  const h5::Group root = recorded(approach + "-xdmf", with(of(approach, {}), looking));
  const std::filesystem::path folder = scratch_folder(approach + "-xdmf");
  std::ifstream file(folder / "run.xdmf");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto numbers = [](const std::string& words) {
    std::istringstream stream(words);
    return std::vector<std::uint64_t>{std::istream_iterator<std::uint64_t>(stream), {}};
  };
  const auto product = [](auto begin, auto end) {
    return std::accumulate(begin, end, std::uint64_t{1}, std::multiplies<>());
  };
  const std::regex slab(
      "<DataItem ItemType=\"HyperSlab\" Dimensions=\"([^\"]+)\"[^>]*>\\s*<DataItem [^>]*>([^<]+)</DataItem>"
      "\\s*<DataItem Dimensions=\"([^\"]+)\"[^>]*>run\\.h5:/([^<]+)</DataItem>");
  std::size_t of_contacts = 0, of_grid = 0;
  for (auto match = std::sregex_iterator(text.begin(), text.end(), slab); match != std::sregex_iterator();
       ++match) {
    const std::string path = (*match)[4];
    const auto as = numbers((*match)[1]), selection = numbers((*match)[2]), shape = numbers((*match)[3]);
    EXPECT_EQ(root.shape(path), shape) << path;
    ASSERT_EQ(selection.size(), 3 * shape.size()) << path;
    const auto count = selection.begin() + static_cast<std::ptrdiff_t>(2 * shape.size());
    EXPECT_EQ(product(as.begin(), as.end()), product(count, selection.end())) << path;
    for (std::size_t d = 0; d < shape.size(); ++d)
      EXPECT_LE(selection[d] + count[static_cast<std::ptrdiff_t>(d)], shape[d]);
    of_contacts += path.starts_with("frames/contacts/") ? 1 : 0;
    of_grid += path.starts_with("frames/grid/") ? 1 : 0;
  }
  EXPECT_GT(of_contacts, 6u);
  EXPECT_GT(of_grid, 6u);
  EXPECT_NE(text.find("TopologyType=\"Polyline\""), std::string::npos);
  EXPECT_NE(text.find("TopologyType=\"3DCoRectMesh\" Dimensions=\"14 14 14\""), std::string::npos);
}

}  // namespace
}  // namespace tuft::rigs
