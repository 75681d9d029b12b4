/// Runs that share packings: the same bits from the cache or not, beside each other or after a kill.
#include <csignal>
#include <nlohmann/json.hpp>

#include "cli/commands/command.h"
#include "cli/commands/same_records.h"

namespace tuft::test {
namespace {

namespace fs = std::filesystem;

class SharedPackings : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"TUFT_CACHE", "TMPDIR"})
      before_.emplace_back(name, std::getenv(name) == nullptr ? "" : std::getenv(name));
    fs::create_directories(place_.path("tmp"));
    ::setenv("TMPDIR", place_.path("tmp").c_str(), 1);
    use_cache("cache");
  }
  void TearDown() override {
    EXPECT_TRUE(fs::is_empty(place_.path("tmp")));
    for (const auto& [name, value] : before_)
      value.empty() ? ::unsetenv(name.c_str()) : ::setenv(name.c_str(), value.c_str(), 1);
  }
  void use_cache(const std::string& name) { ::setenv("TUFT_CACHE", place_.path(name).c_str(), 1); }

  [[nodiscard]] std::vector<std::string> words(const std::string& name,
                                               const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"--set", "infill.dem.use_cache=true", "--set", "scene.duration=2 ms"};
    all.insert(all.end(), more.begin(), more.end());
    return grain_run(place_.path(name), all);
  }
  void run(const std::string& name, const std::vector<std::string>& more = {}) const {
    const Outcome outcome = run_tuft(words(name, more));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_TRUE(outcome.error.empty()) << outcome.error;
  }
  [[nodiscard]] nlohmann::json summary(const std::string& name) const {
    return nlohmann::json::parse(read_text(place_.path(name + "/summary.json")));
  }
  [[nodiscard]] bool from_cache(const std::string& name) const {
    return summary(name)["notes"]["packing_from_cache"]["value"] == 1;
  }
  [[nodiscard]] std::vector<std::string> remarks(const std::string& name) const {
    std::vector<std::string> found;
    const nlohmann::json told = summary(name);
    for (const auto& remark : told["remarks"])
      if (const auto text = remark.get<std::string>(); text.find("packed anew") != std::string::npos)
        found.push_back(text);
    return found;
  }
  [[nodiscard]] fs::path kept(const std::string& cache = "cache") const {
    fs::path found;
    for (const auto& entry : fs::directory_iterator(place_.path(cache))) {
      EXPECT_TRUE(found.empty()) << "one file: " << entry.path();
      found = entry.path();
    }
    return found;
  }

  const Workplace place_;
  std::vector<std::pair<std::string, std::string>> before_;
};

TEST_F(SharedPackings, ServeAnotherRigAndGiveTheBitsOfOneMadeAnew) {
  run("anew");
  EXPECT_FALSE(from_cache("anew"));
  run("kept");
  EXPECT_TRUE(from_cache("kept"));
  EXPECT_LT(summary("kept")["cost"]["packing"].get<double>(),
            summary("anew")["cost"]["packing"].get<double>());
  expect_same_records(place_.path("kept"), place_.path("anew"));
  run("other_rig", {"--set", "rig.speed=1 m/s"});
  EXPECT_TRUE(from_cache("other_rig"));
  EXPECT_FALSE(kept().empty());
}

TEST_F(SharedPackings, ThatAreDamagedAreMadeAnewAndSaidToBe) {
  run("first");
  const fs::path file = kept();
  fs::resize_file(file, fs::file_size(file) / 2);
  const auto damaged = run_tuft(words("damaged"));
  ASSERT_EQ(damaged.exit_code, 0) << damaged.error;
  EXPECT_FALSE(from_cache("damaged"));
  ASSERT_EQ(remarks("damaged").size(), 1u);
  EXPECT_NE(remarks("damaged")[0].find(file.string()), std::string::npos) << remarks("damaged")[0];
  EXPECT_NE(damaged.out.find(remarks("damaged")[0]), std::string::npos) << damaged.out;
  EXPECT_NE(read_text(place_.path("damaged/log.txt")).find(remarks("damaged")[0]), std::string::npos);
  expect_same_records(place_.path("damaged"), place_.path("first"));
  run("after");
  EXPECT_TRUE(from_cache("after"));
  EXPECT_TRUE(remarks("after").empty());
}

/// The file is whole, but of a carpet with one shell value more or one node less.
TEST_F(SharedPackings, OfACarpetOfAnotherSizeAreMadeAnewAndSaidToBe) {
  run("first");
  for (const char* lacks : {"carpet_elements", "nodes"}) {
    const fs::path file = kept();
    h5::File changed = h5::File::create_atomically(file);
    {
      const h5::Group old = h5::File::open(file).root();
      h5::Group root = changed.root();
      for (const std::string& name : old.names()) {
        std::vector<double> values = old.read_doubles(name);
        const bool node = name == "carpet_x" || name == "carpet_y" || name == "carpet_z";
        if (name == lacks || (node && lacks == std::string("nodes"))) values.pop_back();
        root.write(name, std::span<const double>(values));
      }
    }
    changed.commit();
    run(lacks);
    EXPECT_FALSE(from_cache(lacks));
    ASSERT_EQ(remarks(lacks).size(), 1u);
    EXPECT_NE(remarks(lacks)[0].find("does not fit a carpet of"), std::string::npos) << remarks(lacks)[0];
    expect_same_records(place_.path(lacks), place_.path("first"));
  }
}

TEST_F(SharedPackings, OfASpecimenThatAreDamagedAreMadeAnewAndSaidToBe) {
  const auto ring = [&](const std::string& name) {
    const Outcome outcome = run_tuft({"run",   "inputs/oedometer_sbr.toml",
                                      "--out", place_.path(name),
                                      "--set", "infill.approach=dem",
                                      "--set", "infill.dem.material_coarse_graining.sbr=2.5",
                                      "--set", "infill.dem.settle_time=1 ms",
                                      "--set", "rig.diameter=16 mm",
                                      "--set", "rig.height=8 mm",
                                      "--set", "rig.preloads=[\"5 N\"]",
                                      "--set", "rig.seating_force=2 N",
                                      "--set", "rig.cycles=1",
                                      "--set", "rig.speed_factor=500.0",
                                      "--set", "rig.sample_travel=20 um"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  };
  ring("first");
  fs::resize_file(kept(), 1000);
  ring("damaged");
  ASSERT_EQ(remarks("damaged").size(), 1u);
  ring("kept");
  EXPECT_TRUE(remarks("kept").empty());
  expect_same_records(place_.path("damaged"), place_.path("first"));
  expect_same_records(place_.path("kept"), place_.path("first"));
}

TEST_F(SharedPackings, AreWrittenByTwoRunsAtOnceWhoseBitsAreThoseOfEachAlone) {
  use_cache("alone");
  run("whole");
  use_cache("cache");
  {
    RunningTuft one(words("one")), two(words("two"));
    for (RunningTuft* beside : {&one, &two}) {
      const Outcome outcome = beside->wait();
      EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    }
  }
  for (const char* name : {"one", "two"}) expect_same_records(place_.path(name), place_.path("whole"));
  run("third");
  EXPECT_TRUE(from_cache("third")) << kept();
  expect_same_records(place_.path("third"), place_.path("whole"));
}

TEST_F(SharedPackings, OfARunBesideOneThatIsKilledGiveItTheBitsOfItAlone) {
  use_cache("alone");
  run("whole");
  use_cache("cache");
  for (const char* at : {"scene.toml", "checkpoint.h5"}) {  // while it packs, and in the middle
    const std::string survivor = std::string("beside_") + at, killed = std::string("killed_at_") + at;
    RunningTuft beside(words(survivor));
    const Outcome end =
        run_tuft(words(killed), {.blow_at = place_.path(killed + "/" + at),
                                 .blow = [](const Processes& run) { ::kill(run.tuft, SIGKILL); }});
    EXPECT_EQ(end.exit_code, 128 + SIGKILL);
    const Outcome outcome = beside.wait();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    expect_same_records(place_.path(survivor), place_.path("whole"));
    const Outcome resumed = run_tuft({"resume", place_.path(killed)});
    ASSERT_EQ(resumed.exit_code, 0) << resumed.error;
    expect_same_records(place_.path(killed), place_.path("whole"));
  }
}

}  // namespace
}  // namespace tuft::test
