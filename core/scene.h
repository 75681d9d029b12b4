#pragma once
/// The scene as plain structs, SI throughout: what a run is, decided once, before any state exists.
/// `read_scene` (core/scene_reader.h) fills it from TOML, checks every key, unit and range, and resolves
/// files named in it. Defaults here are the defaults of the scene language; `write_scene` writes all of them
/// out.
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/materials.h"
#include "core/vector.h"

namespace tuft {

/// What becomes of the parts of a mesh file whose names say neither backing nor fibre.
enum class UndecidedParts { refuse, leave_out, backing, fibre };

/// A carpet mesh made elsewhere (docs/carpet_meshes.md), instead of a generated one.
struct CarpetMeshFile {
  std::string file;         ///< empty: the carpet is generated
  std::string content;      ///< content_hash of the file: results of another are never taken for its own
  std::string unit = "mm";  ///< of lengths in the file
  double shift_z = 0;       ///< m, added to heights
  UndecidedParts undecided_parts = UndecidedParts::refuse;
};

/// How the yarn of a tuft is made: one tape, split above its root, or separate filaments.
enum class Yarn { slit_film, monofilament };

/// Carpet as made (inputs/turfs/*.toml or inline under [turf.carpet]).
struct CarpetDesign {
  double gauge = 0;             ///< m between rows of tufts (y direction)
  double stitch_spacing = 0;    ///< m between tufts along a row (x direction)
  int strands_per_tuft = 0;     ///< >= 1
  double pile_length = 0;       ///< m, strand length from the backing
  double strand_width = 0;      ///< m
  double strand_thickness = 0;  ///< m
  double lean = 0;              ///< rad, mean tilt of a strand from the vertical
  double fan_out = 0;           ///< rad, standard deviation of the tilt within a tuft (seeded)
  Yarn yarn = Yarn::slit_film;
  int legs_per_tuft = 1;         ///< 1 or 2, at both ends of the stitch, equal shares of strands
  double leg_spacing = 0;        ///< m between legs along the row; 0: a quarter of stitch_spacing
  double leg_width = 0;          ///< m, root of a leg across the row; 0: its strands side by side, flat
  double unsplit_length = 0;     ///< m from the root over which a slit-film tape is whole
  double curl = 0;               ///< rad, turn of a strand's tangent in a pile length, on a helix
  double length_scatter = 0;     ///< standard deviation of length over pile_length, cut off at two
  double element_length = 0;     ///< m, along the strand; rounded to a whole number of elements
  double backing_thickness = 0;  ///< m
  double backing_element = 0;    ///< m, largest element side of the backing
  ShellMaterial fibre, backing;
  ShellSection fibre_section, backing_section;
  double damping = 0;                ///< 1/s, mass-proportional damping of the carpet during the drop, >= 0
  FrictionLaw body_friction;         ///< of fibres and backing against rig bodies and the tray
  double contact_restitution = 0.5;  ///< (0, 1], of carpet nodes on rig bodies and the tray
  CarpetMeshFile mesh;               ///< with a file, only thicknesses of the above still shape the carpet
};

struct SceneInfo {
  std::string name;
  double duration = 0;  ///< s, from the release of the rig
};

struct Layer {
  Index material = 0;  ///< index into Scene::materials
  double depth = 0;    ///< m, as placed
};

struct Turf {
  std::string design;  ///< file the carpet came from; empty: inline
  CarpetDesign carpet;
  std::array<double, 2> size{};  ///< m, x and y of the patch
  double tray_depth = 0;         ///< m, height of the tray's walls; default: sum of layers + 20 mm
  std::vector<Layer> layers;     ///< bottom to top
};

enum class Approach { sph, dem };
enum class Kernel { cubic_spline, wendland_c2 };

struct SphOptions {
  std::string preset = "accurate";  ///< accurate | fast | paper | specimen | custom
  double pitch = 0.002;             ///< m, lattice spacing
  double smoothing_length = 0;      ///< m; set by the preset unless given
  Kernel kernel = Kernel::wendland_c2;
  double viscosity_linear = 0.3;        ///< artificial viscosity, Monaghan alpha
  double viscosity_quadratic = 0.6;     ///< Monaghan beta
  double zero_energy_viscosity = 0.05;  ///< zeta of the control of zero-energy modes (sph_loops.h)
};

/// What two unlike grains have between them; what is left out is the mean of the two materials.
struct GrainPair {
  std::array<Index, 2> materials{};
  std::optional<double> friction = {};                 ///< >= 0
  std::optional<double> restitution = {};              ///< (0, 1]
  std::optional<double> rolling_friction = {};         ///< >= 0
  std::optional<double> cohesion_energy_density = {};  ///< J/m^3, >= 0
};

/// Normal and tangential springs of grains: stiffening with overlap (Hertz, Mindlin), constant (Hooke), or
/// constant and plastic (dem_bridge/hooke_hysteresis.h).
enum class GrainContact { hertz, hooke, hooke_hysteresis };
/// Rolling resistance: an elastic-plastic spring (epsd2), or a constant torque against rolling (cdt).
enum class RollingModel { epsd2, cdt };

struct DemOptions {
  double coarse_graining = 1;  ///< >= 1, scales diameters; material properties kept (docs/theory/dem.md)
  std::map<std::string, double> material_coarse_graining;  ///< own factor for a grain material, by name
  GrainContact contact = GrainContact::hertz;
  /// m/s, > 0 with Hooke (plastic or not), 0 with Hertz: two grains meeting at it overlap as much as under
  /// Hertz's law. The reader makes it the missile's speed where a scene leaves it out.
  double characteristic_velocity = 0;
  // Of hooke_hysteresis, see dem_bridge/hooke_hysteresis.h and docs/conditioning.md for where they come from.
  double unloading_ratio = 3;  ///< > 1: stiffness of unloading and loading again over that of first loading
  double plastic_depth = 0.3;  ///< > 0: the deepest dent, over twice the effective radius
  double adhesion_ratio = 1;   ///< >= 0: stiffness of the pull that parts dented grains over that of loading
  RollingModel rolling = RollingModel::epsd2;
  std::vector<GrainPair> pairs;
  std::string
      host;  ///< path of liggghts_host, or tcp://machine:port of one that listens; empty: beside the program
  int ranks = 1;  ///< MPI processes of the host, >= 1, on one machine
  /// Of two grains, over the smaller radius, beyond which a run stops, from the release of the rig on; 0:
  /// none.
  double overlap_limit = 0;
  double answer_timeout = 30;  ///< s without an answer until the host counts as hung
  /// [0, 1] of their friction, on each other and on strands, that grains have while they are laid
  /// (coupler/laying.h): 1 a bed as poured, 0 the densest, as tamped.
  double packing_friction = 1;
  double settle_time = 0.003;      ///< s of packing dynamics, at least
  double settle_time_limit = 0.1;  ///< s, at most; grains that are not at rest then are said not to be
  /// Share of their weight that nothing bears, below which grains are at rest (coupler/bed_state.h): packed,
  /// and before the rig is released.
  double rest_tolerance = 0.1;
  bool use_cache = true;
};

struct InfillChoice {
  Approach approach = Approach::sph;
  SphOptions sph;
  DemOptions dem;
};

/// The state, free of stress, in which SPH infill goes on at the density that conditioning reached
/// (docs/conditioning.md).
enum class ConditionedState {
  automatic,  ///< compacted for materials to whose law compaction matters (effect density_hardening), else
              ///< initial
  initial,    ///< the material's own, with the density reached as its reference
  compacted   ///< as if the law had been pressed beyond that density and released
};

/// A studded cylinder that rolls over the patch along x, as test turf is prepared. Assumed, all of it, after
/// the hand-drawn studded rollers of laboratories; no standard was at hand.
struct ConditioningRoller {
  double diameter = 0.118;      ///< m, of the cylinder
  int studs_around = 12;        ///< on its circumference; 0: a smooth roller
  double stud_spacing = 0.03;   ///< m between rings of studs along the axis, each turned by half a spacing
  double stud_length = 0.012;   ///< m, beyond the cylinder
  double stud_diameter = 0.01;  ///< m, of the round tips
  double speed = 1;             ///< m/s
  int passes = 3;               ///< to and fro in turn; each comes deeper, the last to the depth asked for
};

/// What the turf goes through before the rig is released.
struct Conditioning {
  std::string method = "none";  ///< none | compaction | roller
  // Published (Bustamante et al. 2024): a plate presses by 6 mm in 110 ms, is lifted, the infill settles; at
  // 140 ms it is made deformable. Assumed: the share of lifting in those 30 ms.
  double depth = 0.006;        ///< m below the infill's surface as placed, to which the plate comes
  double press_time = 0.110;   ///< s in which the plate comes down from the tips of the fibres
  double lift_time = 0.020;    ///< s in which it goes back up
  double settle_time = 0.010;  ///< s under gravity, the plate gone
  /// More than 1: the plate comes again, deeper by what is missing, until the bed stays at `depth` below the
  /// surface as placed within `tolerance`, at most so often. Each time is followed by settle_time.
  int presses = 1;
  double tolerance = 0.0005;  ///< m
  ConditioningRoller roller;
  /// Over the edge of the cube that an SPH particle fills. Measured: with 0.96 a bed can be pressed by 6 of
  /// 50 mm and stays pressed (docs/conditioning.md).
  double sphere_diameter = 0.96;
  double sphere_friction = 0.5;  ///< literature: sand 0.4-0.5, sand on rubber 0.4-0.7, rubber 0.6-1.0
  ConditionedState state = ConditionedState::automatic;
  double frames = 0.005;  ///< s between frames meanwhile

  [[nodiscard]] bool on() const { return method != "none"; }
};

/// Clegg impact tester: a rigid flat-ended cylinder with one degree of freedom, falling free.
struct CleggRig {
  double mass = 2.25;                    ///< kg
  double diameter = 0.050;               ///< m
  double height = 0.1467;                ///< m
  double speed = 2.85;                   ///< m/s at first contact
  std::array<double, 2> position{0, 0};  ///< m, axis in x and y relative to the middle of the patch
  double filter_cutoff = 1000;           ///< Hz, low-pass of the acceleration
  double touch_force = 22;               ///< N, force that starts the clock of first contact: 1 g of 2.25 kg
};

/// Which way a strip of backing is cut: its length along the stitch, or across it.
enum class StripDirection { along, across };
/// What the grips of a tension test hold of the strip's ends beside their length: the width too, as clamps
/// do, or nothing, so that the ends contract as the rest does.
enum class StripGrips { hold_width, let_contract };

/// Tension of one strand or of a strip of backing at constant nominal strain rate; one test a rate. Neither
/// infill nor turf around it.
struct TensionRig {
  std::vector<double> rates{0.1};           ///< 1/s, speed of the driven grip over the gauge length
  std::vector<double> gauge_lengths{0.04};  ///< m between the grips: one for all rates, or one for each
  double width = 0;  ///< m; 0: strand_width, or 16 mm along and 21 mm across the stitch
  StripDirection direction = StripDirection::along;  ///< of a strip of backing
  StripGrips grips = StripGrips::hold_width;
  double strain_limit = 0.6;  ///< engineering strain at which a test ends, failed or not
  int samples = 1000;         ///< rows recorded over a test
  double mass_factor = 1;     ///< >= 1, of the density, for longer steps in slow tests
};

/// What the shear strain of a direct shear test is: the displacement of the halves over the specimen's length
/// (the relative lateral displacement of ASTM D3080), or over its height.
enum class ShearStrainBasis { length, height };

/// Tests of infill alone between rigid walls, a fresh specimen for each load of a list: `oedometer`
/// (one-dimensional compression in a ring, loaded and unloaded in cycles at constant speed of the upper
/// plate), `direct_shear` (a box in two halves, the lower of which is driven under a constant normal
/// load) and `pull_out` (a strand of the carpet drawn out of a box between two platens that were pressed
/// together).
struct SpecimenRig {
  Index material = 0;         ///< index into Scene::materials
  double height = 0;          ///< m; 0: 12.7 mm in the ring, 19.5 mm in the box
  double speed = 0;           ///< m/s, of the plate or the lower half; 0: 1 mm/s, 0.1 mm/s
  double speed_factor = 1;    ///< >= 1, the test runs so many times faster
  double wall_friction = 0;   ///< of the infill on ring or side walls
  double sample_travel = 0;   ///< m between rows at full speed; 0: 2 um, 10 um
  int frame_rows = 500;       ///< rows between frames
  int checkpoint_rows = 500;  ///< rows between checkpoints

  double diameter = 0.0535;            ///< m, of the ring
  std::vector<double> preloads{1500};  ///< N, a test each
  int cycles = 4;                      ///< of loading to the preload and unloading
  double seating_force = 5;            ///< N, to which the plate is unloaded

  std::array<double, 2> size{0.05, 0.05};                    ///< m, x (the shearing) and y of the box
  std::vector<double> normal_stresses{100e3, 200e3, 300e3};  ///< Pa, a test each
  double load_time = 0.02;     ///< s, over which the normal load rises, and is held again
  double platen_friction = 1;  ///< of the infill on the plates above and below
  double yield_strain = 0.12;  ///< shear strain at which the yield is read
  ShearStrainBasis strain_basis = ShearStrainBasis::length;

  std::vector<double> speeds{1e-3, 10e-3};  ///< m/s, of the grip that draws the strand, a test each
  double run_speed = 0;  ///< m/s, at which tests are run, friction being that of `speeds`; 0: each at its own
  double normal_stress = 100e3;  ///< Pa, to which the platens are pressed together, and then held
  double embedded_length = 0;    ///< m, of the strand, from its free end; 0: it passes through the whole box
  double travel = 5e-3;          ///< m, of the grip, at which a test ends
};

struct Rig {
  std::string type = "clegg";
  CleggRig clegg;
  TensionRig tension;    ///< of the types strand_tension and backing_tension
  SpecimenRig specimen;  ///< of the types oedometer, direct_shear and pull_out

  /// A rig that tests the carpet's material alone: no patch, no infill, no settling.
  [[nodiscard]] bool is_component() const { return type == "strand_tension" || type == "backing_tension"; }
  /// A rig that tests infill between rigid walls: no carpet but one strand where has_strand(), no patch, no
  /// settling.
  [[nodiscard]] bool is_specimen() const {
    return type == "oedometer" || type == "direct_shear" || has_strand();
  }
  [[nodiscard]] bool has_strand() const { return type == "pull_out"; }
};

enum class Switch { off, on, automatic };

struct Effects {
  std::map<std::string, Switch> choice;  ///< by name; names known to the program only
};

/// What an SPH particle touches bodies with: the infill between its centre and its face, or a stiff penalty.
enum class BodyContactKind { half_row, penalty };

struct Numerics {
  double step_safety = 0.8;          ///< (0, 1], of the stable step of every part
  double mass_scaling_limit = 0;     ///< [0, 1), share of the carpet's mass that may be added; 0: off
  bool subcycle_carpet = false;      ///< the carpet's slower material at a multiple of its faster one's step
  double coupling_window = 0;        ///< s; 0: the larger of the carpet's and the infill's step
  double energy_error_limit = 0.05;  ///< relative; passing it stops the run
  double sleep_tolerance = 0;        ///< strain under which SPH infill at rest sleeps; 0: none does
  int individual_steps = 1;          ///< steps of the run that an SPH particle's own may last; 1: all alike
  double contact_pressure = 800e3;   ///< Pa, highest expected: sets the contact stiffness of the continuum
  double contact_stiffness_factor = 10;  ///< times constrained modulus x pitch, of the penalty
  BodyContactKind body_contact = BodyContactKind::half_row;
  double shell_contact_radius =
      0.5;  ///< (0, 1]: contact radius of SPH particles at strands over half their diameter
  double contact_release_time = 0.002;  ///< s, over which initial overlap is let go
  double settle_time = 0.01;       ///< s of gravity settling before the rig is released; of grains at least
  double settle_time_limit = 0.1;  ///< s; grains settle on until they are at rest, at most so long
  double settle_damping = 400;     ///< 1/s, mass-proportional, while settling
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all cores
};

/// What of the micro-scale frames hold (docs/theory/micro_scale.md). Looking changes nothing of a run.
struct MicroOutput {
  bool contacts = false;  ///< the contact network with its forces and statistics, and spins
  bool fields = false;    ///< coarse-grained fields on a grid
  double cell = 0.005;    ///< m, of the grid
  double width = 0;       ///< m, coarse-graining width, half the kernel's cutoff; 0: a cell
};

struct Output {
  double frames = 0.0005;          ///< s between frames
  double histories = 0.00002;      ///< s between history rows (raw acceleration is kept at this rate)
  double checkpoint_every = 0.01;  ///< s between checkpoints; 0: only at the end and on interruption
  MicroOutput micro;
};

struct Scene {
  std::string file;  ///< as given by the user, for messages
  SceneInfo info;
  Turf turf;
  std::vector<Material> materials;  ///< all that layers name, and the components of mixtures
  InfillChoice infill;
  Conditioning conditioning;
  Rig rig;
  Effects effects;
  Numerics numerics;
  Output output;

  [[nodiscard]] double infill_depth() const {
    double sum = 0;
    for (const Layer& layer : turf.layers) sum += layer.depth;
    return sum;
  }
};

/// An effect as decided for one run: what `explain` prints and `summary.json` holds.
struct EffectDecision {
  std::string name;
  bool on = false;
  std::string why;
};

/// Decides every named effect for a scene (core/effects.cpp); names and meanings: core/effect_names.h. An
/// effect is on because the scene needs it, or as the scene says; each comes with its reason. What belongs to
/// the other kind of infill is off whatever the scene says, and what cannot act in the scene's rig (on a
/// strip of carpet, on a specimen of infill) is not listed.
[[nodiscard]] std::vector<EffectDecision> decide_effects(const Scene& scene);
/// The first effect switched on with nothing to act on, or off though another needs it; `why`: what to do.
[[nodiscard]] std::optional<EffectDecision> idle_effect(const Scene& scene);
[[nodiscard]] bool effect_on(const std::vector<EffectDecision>& decisions, std::string_view name);

}  // namespace tuft
