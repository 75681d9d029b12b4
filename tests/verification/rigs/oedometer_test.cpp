// The oedometer against the soil law in uniaxial strain.
#include <gtest/gtest.h>

#include "core/scene_reader.h"
#include "rigs/oedometer.h"
#include "verification/rigs/specimen_support.h"

namespace tuft::rigs {
namespace {

Scene small_ring(const std::string& material, const Overrides& more = {}) {
  Overrides overrides{{"rig.material", material},        {"rig.diameter", "20 mm"}, {"rig.height", "10 mm"},
                      {"rig.preloads", "[\"200 N\"]"},   {"rig.cycles", "2"},       {"rig.speed_factor", "200.0"},
                      {"rig.sample_travel", "5 um"},     {"infill.sph.pitch", "2.5 mm"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return read_scene("inputs/oedometer_sand.toml", overrides);
}


TEST(Oedometer, Probe2) {
  Overrides more;
  std::string all = getenv("PROBE") ? getenv("PROBE") : "";
  std::string material = getenv("MAT") ? getenv("MAT") : "sbr";
  while (!all.empty()) { auto c = all.find(';'); std::string one = all.substr(0, c); auto e = one.find('='); more.push_back({one.substr(0,e), one.substr(e+1)}); if (c == std::string::npos) break; all = all.substr(c+1); }
  more.push_back({"rig.cycles","1"});
  const Scene scene = small_ring(material, more);
  Oedometer rig(scene);
  double en = 0;
  try { en = test::run_test(scene, rig, 0); } catch (std::exception& e) { printf("%s\n", e.what()); }
  test::UniaxialPoint point(*scene.materials[0].continuum);
  const auto& rows = rig.rows(0);
  double inertia = 0;
  std::size_t n = 0; double next = 0, peak = 0;
  for (auto& r : rows) peak = std::max(peak, r.stress);
  for (std::size_t i = 0; i < rows.size(); ++i) {
        point.move_to(-std::log(1 - rows[i].strain));
        inertia = std::max(inertia, std::abs(rows[i].inertia_force));
        bool print = rows[i].direction > 0 ? rows[i].stress >= next*peak : rows[i].stress <= next*peak;
        if (i && rows[i].direction < 0 && rows[i-1].direction > 0) next = 0.9;
        if (!print) continue;
        next += rows[i].direction > 0 ? 0.1 : -0.1;
        printf(" %s%.4f:%.4f", rows[i].direction > 0 ? "" : "-", rows[i].strain, rows[i].stress/point.stress());
  }
  printf("\n rows %zu energy %g inertia %g end stress %g\n", n = rows.size(), en, inertia / 200, rows.back().stress);
}

}  // namespace
}  // namespace tuft::rigs
