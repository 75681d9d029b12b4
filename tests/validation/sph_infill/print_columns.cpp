// Sections of docs/verification/sph.md on columns of grains that collapse, and docs/images/sph_collapse.svg.
#include <fstream>
#include <numbers>

#include "tests/validation/sph_infill/print_columns.h"

namespace tuft::sph::test {

double run_out(CollapseCase c, double aspect, int particles, const Numerics& numerics) {
  c.aspect = aspect;
  c.particles = particles;
  return column_collapse(numerics, c).run_out;
}

namespace {

constexpr std::array aspects{0.5, 1.0, 2.0, 4.0};
constexpr std::array<int, 3> plane_particles{8, 12, 20}, axisymmetric_particles{8, 11, 16};

std::string published_words(bool axisymmetric, double aspect) {
  const RunOutLaws laws = published_run_out(axisymmetric, aspect);
  return axisymmetric ? fmt::format("{:.2f}", laws.low)
                      : fmt::format("{:.2f} to {:.2f}", laws.low, laws.high);
}

struct Curve {
  std::string label;
  CollapseResult result;
};

void write_profiles(const std::string& path, const std::vector<Curve>& curves) {
  const double scale = 90, left = 50, top = 20, height = 1.5 * scale, width = 7 * scale;
  std::ofstream out(path);
  out << fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {}" font-family="sans-serif" font-size="12">)",
      left + width + 20, top + height + 45);
  out << R"(<rect width="100%" height="100%" fill="white"/>)";
  const auto x_of = [&](double x) { return left + x * scale; };
  const auto y_of = [&](double z) { return top + height - z * scale; };
  for (int k = 0; k <= 7; ++k)
    out << fmt::format(
        R"(<line x1="{0:.1f}" y1="{1}" x2="{0:.1f}" y2="{2}" stroke="#ddd"/><text x="{0:.1f}" y="{3}" text-anchor="middle">{4}</text>)",
        x_of(k), top, y_of(0), y_of(0) + 16, k);
  for (int k = 0; k <= 1; ++k)
    out << fmt::format(
        R"(<line x1="{0}" y1="{1:.1f}" x2="{2}" y2="{1:.1f}" stroke="#ddd"/><text x="{3}" y="{4:.1f}" text-anchor="end">{5}</text>)",
        left, y_of(k), left + width, left - 6, y_of(k) + 4, k);
  out << fmt::format(
      R"(<text x="{}" y="{}" text-anchor="middle">x / L0</text><text x="12" y="{}">z / L0</text>)",
      left + width / 2, y_of(0) + 36, top + 4);
  const std::array<const char*, 4> colour{"#4269d0", "#efb118", "#3ca951", "#ff725c"};
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::string points;
    const CollapseResult& r = curves[c].result;
    for (std::size_t k = 0; k < r.profile_x.size(); ++k)
      points += fmt::format("{:.1f},{:.1f} ", x_of(r.profile_x[k]), y_of(r.profile_z[k]));
    out << fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="2"/>)", points,
                       colour[c % 4]);
    out << fmt::format(R"(<text x="{}" y="{}" fill="{}">{}</text>)", left + width - 130,
                       top + 18 + 18 * double(c), colour[c % 4], curves[c].label);
  }
  out << "</svg>\n";
}

/// particles: along L0, three times.
void print_run_outs(bool axisymmetric, const std::array<int, 3>& particles, double aspect) {
  const CollapseCase grains{.axisymmetric = axisymmetric}, stiff{.axisymmetric = axisymmetric, .friction = 2};
  print("| {} ", aspect);
  for (const double zeta : {0.0, 0.05})
    for (const int n : particles)
      print("| {:.2f} ", run_out(grains, aspect, n, {Preset::accurate, 0.3, zeta}));
  print("| {} | {:.2f} |\n", published_words(axisymmetric, aspect), run_out(stiff, aspect, particles[1]));
}

void print_heading(const std::array<int, 3>& n) {
  print(
      "| a | zeta 0, L0 of {} particles | {} | {} | zeta 0.05, {} | {} | {} | published | friction 2.0 ({}) "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|\n",
      n[0], n[1], n[2], n[0], n[1], n[2], n[1]);
}

}  // namespace

void print_row_of_columns(bool axisymmetric, double aspect) {
  print_run_outs(axisymmetric, axisymmetric ? axisymmetric_particles : plane_particles, aspect);
}

void print_plane_columns() {
  print(R"(
## Collapse of columns

Dry grains after Bui et al. (2008): rho 2650 kg/m^3, K 0.7 MPa, Poisson's ratio 0.3 (assumed), no cohesion, no tension;
30 degrees (assumed) unless said otherwise, the floor's Coulomb friction the same. L0 = 0.1 m. Plane: a slab 6 particles
thick between two frictionless walls, so that stress builds up across it as in plane strain. Axisymmetric: a quarter
between two walls of symmetry. Run-out (L - L0)/L0, L where the deposit becomes thinner than L0/40; default numerics.

Published: plane, Lube et al. 2005, 1.2 a (a < 1.8), 1.9 a^(2/3) (a > 2.8); Lajeunesse et al. 2005, 1.8 a (a < 3),
2.3 a^(2/3): the band; axisymmetric, Lube et al. 2004, 1.24 a (a < 1.7), 1.6 sqrt(a) (literature, not seen first hand).

![Deposits of the plane columns](../images/sph_collapse.svg)

Plane:

)");
  print_heading(plane_particles);
  for (const double aspect : aspects) print_row_of_columns(false, aspect);
}

void print_axisymmetric_columns() {
  print("\nAxisymmetric:\n\n");
  print_heading(axisymmetric_particles);
  for (const double aspect : aspects) print_row_of_columns(true, aspect);
}

void print_deposits() {
  print(R"(
Deposits of the plane columns with L0 of 16 particles: height of the surface at the back wall over L0, share of particles
with another nearer than half a pitch. Published heights: Lube et al. 2005, a below 1.15, 0.65 a^0.4 above; Lajeunesse et al.
2005, a below 0.7, a^(1/3) above (literature, not seen first hand). Particles come close though nothing pulls them together: a
lattice that spreads to twice its length has rows half as far apart, and no force of a continuum sets that right. Walls
add to it: a quarter of the particles next to them, an eighth of the others (a = 2, L0 of 10 particles).

| a | height | published | nearer than half a pitch |
|---|---|---|---|
)");
  std::vector<Curve> curves;
  for (const double aspect : aspects) {
    curves.push_back(
        {fmt::format("a = {}", aspect), column_collapse({}, {.aspect = aspect, .particles = 16})});
    const double lube = aspect < 1.15 ? aspect : 0.65 * std::pow(aspect, 0.4),
                 lajeunesse = aspect < 0.7 ? aspect : std::cbrt(aspect);
    print("| {} | {:.2f} | {:.2f}, {:.2f} | {:.1f} % |\n", aspect, curves.back().result.height, lube,
          lajeunesse, 100 * curves.back().result.close);
  }
  write_profiles("docs/images/sph_collapse.svg", curves);
}

void print_rods() {
  print(R"(
Bui et al.'s aluminium rods, 0.2 x 0.1 m (a = 0.5), 19.8 degrees: run-out with L0 of 10, 20 and 40 particles. The laws'
band at a = 0.5, of grains with more friction, is 0.60 to 0.90.

| alpha | zeta | 10 | 20 | 40 |
|---|---|---|---|---|
)");
  for (const Numerics numerics : {Numerics{Preset::accurate}, Numerics{Preset::accurate, 0.3, 0.05}}) {
    print("| {} | {} ", numerics.alpha, numerics.zeta);
    for (const int particles : {10, 20, 40}) {
      CollapseCase rods;
      rods.length = 0.2;
      rods.aspect = 0.5;
      rods.friction = std::tan(19.8 * std::numbers::pi / 180);
      rods.particles = particles;
      print("| {:.2f} ", column_collapse(numerics, rods).run_out);
    }
    print("|\n");
  }
  print(R"(
Run-outs grow as the pitch falls, for artificial viscosity is of the order of alpha c h: at a = 1, 10 particles without it run a
quarter farther (last table). Columns this coarse and flat tell 30 degrees from 2.0 by a sixth only: half of such a column does not move, and what does is
a few particles thick.
)");
}

void print_fine_columns() {
  print(R"(
The same plane columns (30 degrees, zeta 0) at finer pitch, and those of friction 2.0:

| a | L0 of 20 particles | 40 | more | published | friction 2.0 |
|---|---|---|---|---|---|
)");
  const CollapseCase grains{.friction = std::tan(30 * std::numbers::pi / 180)}, stiff{.friction = 2};
  for (const auto& [aspect, fine, finest] :
       {std::tuple{0.5, 40, 80}, std::tuple{1.0, 40, 0}, std::tuple{2.0, 40, 0}, std::tuple{4.0, 0, 32}}) {
    print("| {} | {:.2f} ", aspect, run_out(grains, aspect, 20));
    print("| {} ", fine > 0 ? fmt::format("{:.2f}", run_out(grains, aspect, fine)) : "");
    print("| {} ", finest > 0 ? fmt::format("{:.2f} ({})", run_out(grains, aspect, finest), finest) : "");
    const int particles = aspect < 2 ? 40 : 20;
    print("| {} | {:.2f} ({}) |\n", published_words(false, aspect), run_out(stiff, aspect, particles),
          particles);
  }
  print(R"(
Flat columns need the pitch, for little of them moves and that is thin: at 12 particles they are told from friction 2.0 by a sixth, at 40
by a fifth, and at 80 they are at the band's edge. The tallest leave it at the top instead: from a = 2 to 4 run-outs grow as
a^0.9. Balmforth & Kerswell 2005 report powers of 0.9 +- 0.1 in wide channels and 0.65 +- 0.05 in narrow ones, whose side walls hold
back what is deep; the laws' 2/3 is that of narrow ones (literature, not seen first hand).
)");
}

void print_channel() {
  print(R"(
Glass beads in a narrow channel, after Lajeunesse et al. 2005: 22 degrees, the beads' angle of repose; between side walls
0.45 L0 apart (theirs were 45 mm) with friction tan 13.1 degrees (beads on glass, Jop et al. 2005). The slab is a slice of
the channel and bears its share of the walls' friction. None of the three is
adjusted to the run-outs (literature, not seen first hand); but this channel was set up when constant friction without walls, above and
below, had not met all four aspect ratios.
zeta 0; the last columns say what the walls do.

| a | L0 of 12 particles | 20 | 40 (a = 4: 32) | published | friction 2.0 (12) | walls 0.9 L0 apart (20) | frictionless (20) |
|---|---|---|---|---|---|---|---|
)");
  CollapseCase beads = beads_in_a_channel();
  CollapseCase stiff = beads, wide = beads, smooth = beads;
  stiff.friction = 2;
  wide.channel = 0.9;
  smooth.wall_friction = 0;
  for (const double aspect : aspects)
    print("| {} | {:.2f} | {:.2f} | {:.2f} | {} | {:.2f} | {:.2f} | {:.2f} |\n", aspect,
          run_out(beads, aspect, 12), run_out(beads, aspect, 20),
          run_out(beads, aspect, aspect > 2 ? 32 : 40), published_words(false, aspect),
          run_out(stiff, aspect, 12), run_out(wide, aspect, 20), run_out(smooth, aspect, 20));
  print(R"(
So one material in one channel is within the band at all four aspect ratios at the finest pitch, and friction 2.0 is below it at all of
them. It is not converged: run-outs still rise with pitch, by 1 to 22 % from 20 particles on, and at 20 a = 0.5 is below the band.
The walls take a third from the tallest column and a tenth from the flattest; from a = 2 to 4 the power is 0.80, of frictionless walls 1.02. How wide
the channel was over L0 in each experiment is not known here; twice as wide, a = 4 is a tenth above the band.
)");
}

void print_shipped_columns() {
  print(R"(
As scenes have it, preset `accurate` with alpha 0.3 and zeta 0.05, all with L0 of 40 particles (a = 4: 32), and friction 2.0 at the same pitch:

| a | beads in the channel | friction 2.0 | 30 degrees, no walls | friction 2.0 | published |
|---|---|---|---|---|---|
)");
  const Numerics shipped{Preset::accurate, 0.3, 0.05};
  CollapseCase beads = beads_in_a_channel(), stiff_beads = beads;
  const CollapseCase grains{.friction = std::tan(30 * std::numbers::pi / 180)}, stiff{.friction = 2};
  stiff_beads.friction = 2;
  for (const double aspect : aspects) {
    const int particles = aspect > 2 ? 32 : 40;
    print("| {} ", aspect);
    for (const CollapseCase& c : {beads, stiff_beads, grains, stiff})
      print("| {:.2f} ", run_out(c, aspect, particles, shipped));
    print("| {} |\n", published_words(false, aspect));
  }
  print(R"(
The beads are within the band at all four aspect ratios, those of 30 degrees at three: the flattest column comes to 0.56 with 80 particles, and to 0.61 without control of zero-energy
modes. Friction 2.0 is a third and more below the band everywhere. How far a run-out can be trusted: the plane column a = 1 of 20 particles, zeta 0, runs out to 1.17 with friction 0.5774 and to
1.20 with 0.57735, and to 1.27 in a version that differs in rounding.
)");
}

void print_inertial_columns() {
  print(R"(
Does friction that grows with the rate do the same (`inertial_friction`)? mu(I) from 25.5 to 36.5 degrees, I0 = 0.279,
beads of 0.7 mm (Ionescu et al. 2015 for such channels; literature, not seen first hand), and 25.5 degrees alone; a floor of
36.5 degrees under both, no walls, L0 of 16 particles, alpha 0.1, zeta 0.05:

| a | 25.5 degrees | mu(I) | less by |
|---|---|---|---|
)");
  const auto cone = [](double tangent) { return std::sqrt(dry_grains(tangent).yield_a2); };
  const double slow = std::tan(25.5 * std::numbers::pi / 180), fast = std::tan(36.5 * std::numbers::pi / 180);
  const CollapseCase constant{.friction = slow, .floor = fast};
  CollapseCase inertial = constant;
  inertial.inertial = InertialFriction{cone(fast) / cone(slow) - 1, 0.279, 0.7e-3, 2450};
  for (const double aspect : aspects) {
    const Numerics thin{Preset::accurate, 0.1, 0.05};
    const double without = run_out(constant, aspect, 16, thin), with = run_out(inertial, aspect, 16, thin);
    print("| {} | {:.2f} | {:.2f} | {:.0f} % |\n", aspect, without, with, 100 * (1 - with / without));
  }
  print("\nIt takes 2 to 6 % from each, and is not what tells flat columns from tall ones.\n");
}

void print_round_columns() {
  print(R"(
Round columns have no side walls. At 22, 26 and 30 degrees, L0 of 16 particles, alpha 0.1, zeta 0.05:

| a | 22 degrees | 26 | 30 | published |
|---|---|---|---|---|
)");
  for (const double aspect : aspects) {
    print("| {} ", aspect);
    for (const double degrees : {22.0, 26.0, 30.0})
      print("| {:.2f} ",
            run_out({.axisymmetric = true, .friction = std::tan(degrees * std::numbers::pi / 180)}, aspect,
                    16, {Preset::accurate, 0.1, 0.05}));
    print("| {} |\n", published_words(true, aspect));
  }
  print(
      "\nAt finer pitch, 30 degrees, default numerics:\n\n| a | run-out (particles along L0) | published "
      "|\n|---|---|---|\n");
  const double thirty = std::tan(30 * std::numbers::pi / 180);
  for (const auto& [aspect, particles] :
       {std::pair{0.5, 40}, std::pair{1.0, 32}, std::pair{2.0, 24}, std::pair{4.0, 16}})
    print("| {} | {:.2f} ({}) | {} |\n", aspect,
          run_out({.axisymmetric = true, .friction = thirty}, aspect, particles), particles,
          published_words(true, aspect));
  print(
      "\nThe flat ones are short by a fifth and a seventh, the tall ones within a tenth. With friction 2.0 "
      "all are short by more than\na quarter (table above, and 0.40 for a = 0.5 with 40 particles).\n");
}

}  // namespace tuft::sph::test
