#include "sph_infill/strain_path.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/error.h"
#include "sph_infill/sph_infill.h"

namespace tuft::sph {
namespace {

constexpr std::string_view kind_names[] = {"isotropic",  "oedometric",   "triaxial",         "simple_shear",
                                           "pure_shear", "direct_shear", "velocity_gradient"};

SymmetricTensor stress_of(const SoilState& state) {
  SymmetricTensor s = state.deviator;
  s.xx -= state.pressure, s.yy -= state.pressure, s.zz -= state.pressure;
  return s;
}

/// The stress that a segment's `stress` speaks of, compression positive.
double watched_stress(PathKind kind, const SoilState& state) {
  switch (kind) {
    case PathKind::isotropic:
      return state.pressure;
    case PathKind::oedometric:
    case PathKind::triaxial:
      return -stress_of(state).zz;
    case PathKind::direct_shear:
      return state.deviator.zx;
    default:
      return state.deviator.xy;
  }
}

/// Strain and turn of a change `size` of the segment's strain (compression positive), as of a constant
/// velocity gradient. Strains that follow from a kept stress are left 0.
StrainStep motion(PathKind kind, double size) {
  switch (kind) {
    case PathKind::isotropic:
      return {{-size / 3, -size / 3, -size / 3, 0, 0, 0}, {}};
    case PathKind::oedometric:
    case PathKind::triaxial:
      return {{0, 0, -size, 0, 0, 0}, {}};
    case PathKind::simple_shear:  // v_x = rate y: the axial vector of the spin is -rate/2 along z
      return {{0, 0, 0, 0.5 * size, 0, 0}, {0, 0, -0.5 * size}};
    case PathKind::direct_shear:  // v_x = rate z: rate/2 along y
      return {{0, 0, 0, 0, 0, 0.5 * size}, {0, 0.5 * size, 0}};
    default:
      return {{0, 0, 0, 0.5 * size, 0, 0}, {}};
  }
}

/// Walks one segment after another.
class Walker {
 public:
  Walker(const SoilLaw& law, const PointTest& test, PathRecord& record)
      : law_(law), test_(test), record_(record) {
    now_.state = compacted_state(law, test.residual_compression);
    stored_at_start_ = volume() * stored_energy(law, now_.state);
    describe(0);
    record_.rows = {now_};
  }

  void walk(std::size_t index) {
    const PathSegment& segment = test_.segments[index];
    now_.segment = index + 1;
    if (segment.fresh && index > 0) start_again();
    first_row_ = record_.rows.size();
    stride_ = 1, since_row_ = 0;
    kept_ = stress_of(now_.state);
    guess_ = {0, 0};
    if (segment.duration)
      walk_gradient(segment);
    else if (segment.strain)
      walk_strain(segment);
    else
      walk_to_stress(segment);
    keep_last_row();
    record_.completed = index + 1;
  }

 private:
  struct Counted {
    std::size_t steps;
    double work_size, largest_energy_gap;
  };
  [[nodiscard]] double volume() const { return std::exp(-now_.state.compression); }

  /// A point as the first was; time goes on.
  void start_again() {
    PathRow fresh;
    fresh.time = now_.time;
    fresh.segment = now_.segment;
    fresh.state = compacted_state(law_, test_.residual_compression);
    now_ = fresh;
    describe(0);
    record_.rows.push_back(now_);
  }

  [[noreturn]] void fail(const PathSegment& segment, const std::string& what) const {
    throw_run_error("{}: segments.{} ({}): {}", test_.file, now_.segment - 1,
                    kind_names[static_cast<std::size_t>(segment.kind)], what);
  }

  void walk_strain(const PathSegment& segment) {
    const auto steps = static_cast<std::size_t>(std::ceil(std::abs(*segment.strain) / test_.step - 1e-9));
    const double size = *segment.strain / static_cast<double>(steps);
    for (std::size_t k = 0; k < steps; ++k) {
      take(step_of(segment, size));
      note(rate_of(segment));
    }
  }

  void walk_gradient(const PathSegment& segment) {
    TensorOf<double> gradient;
    const std::vector<double>& l = segment.velocity_gradient;
    gradient = {l[0], l[1], l[2], l[3], l[4], l[5], l[6], l[7], l[8]};
    double largest = 0;
    for (const double rate : l) largest = std::max(largest, std::abs(rate));
    const double wanted = std::ceil(largest * *segment.duration / test_.step - 1e-9);
    const auto steps = static_cast<std::size_t>(std::max(1.0, wanted));
    const double dt = *segment.duration / static_cast<double>(steps);
    const StrainStep step{dt * symmetric_part(gradient),
                          {0.5 * dt * (l[7] - l[5]), 0.5 * dt * (l[2] - l[6]), 0.5 * dt * (l[3] - l[1])},
                          dt};
    const SymmetricTensor d = deviator((1 / dt) * step.strain);
    for (std::size_t k = 0; k < steps; ++k) {
      take(step);
      note(std::sqrt(2 * double_dot(d, d)));
    }
  }

  void walk_to_stress(const PathSegment& segment) {
    const double target = *segment.stress, start = watched_stress(segment.kind, now_.state);
    if (start == target) return;
    const double sign = target > start ? 1 : -1;
    double gone = 0;
    while (true) {
      const PathRow before = now_;
      const Counted counted_before{record_.steps, record_.work_size, record_.largest_energy_gap};
      const std::array<double, 2> guess_before = guess_;
      take(step_of(segment, sign * test_.step));
      gone += test_.step;
      const auto passed = [&] { return sign * (watched_stress(segment.kind, now_.state) - target) >= 0; };
      if (passed()) {
        // The share of the last step that meets the stress.
        double low = 0, high = 1;
        for (int k = 0; k < 60 && high - low > 1e-15; ++k) {
          const double middle = 0.5 * (low + high);
          go_back(before, counted_before, guess_before);
          take(step_of(segment, middle * sign * test_.step));
          (passed() ? high : low) = middle;
        }
        go_back(before, counted_before, guess_before);
        take(step_of(segment, high * sign * test_.step));
        note(rate_of(segment));
        return;
      }
      note(rate_of(segment));
      if (gone > test_.strain_limit)
        fail(
            segment,
            fmt::format("a stress of {:.6g} Pa is not met within a strain of {:g}; it came from {:.6g} Pa to "
                        "{:.6g} Pa. Lower the stress, or raise point.strain_limit",
                        target, test_.strain_limit, start, watched_stress(segment.kind, now_.state)));
    }
  }

  void go_back(const PathRow& row, const Counted& counted, const std::array<double, 2>& guess) {
    now_ = row;
    record_.steps = counted.steps;
    record_.work_size = counted.work_size;
    record_.largest_energy_gap = counted.largest_energy_gap;
    guess_ = guess;
  }

  /// Rate of shear that the law sees, 1/s; of a triaxial segment that of an incompressible one.
  static double rate_of(const PathSegment& segment) {
    switch (segment.kind) {
      case PathKind::isotropic:
        return 0;
      case PathKind::oedometric:
        return 2 / std::sqrt(3.0) * segment.rate;
      case PathKind::triaxial:
        return std::sqrt(3.0) * segment.rate;
      default:
        return segment.rate;
    }
  }

  [[nodiscard]] StrainStep step_of(const PathSegment& segment, double size) {
    StrainStep step = motion(segment.kind, size);
    step.duration = std::abs(size) / segment.rate;
    if (segment.kind == PathKind::triaxial) keep_lateral_stress(segment, step);
    if (segment.kind == PathKind::direct_shear) keep_normal_stress(segment, size, step);
    return step;
  }

  /// Lateral strains under which the stresses along x and y stay. Strength that depends on the rate has a
  /// cusp where the rate is nothing, at which Newton's method may stick: then it starts again from elsewhere.
  void keep_lateral_stress(const PathSegment& segment, StrainStep& step) {
    using Pair = std::array<double, 2>;
    const double size = std::abs(step.strain.zz);
    const double tolerance = 1e-10 * (now_.state.bulk_modulus * size + std::abs(kept_.xx));
    const auto miss = [&](const Pair& e) -> Pair {
      StrainStep tried = step;
      tried.strain.xx = e[0], tried.strain.yy = e[1];
      SoilState state = now_.state;
      update_soil(law_, tried, state);
      const SymmetricTensor s = stress_of(state);
      return {s.xx - kept_.xx, s.yy - kept_.yy};
    };
    for (const Pair& start : {guess_, Pair{0, 0}, Pair{0.5, 0.5}, Pair{-0.5, -0.5}, Pair{2, 2}, Pair{-2, -2},
                              Pair{8, 8}, Pair{-8, -8}}) {
      Pair e{start[0] * size, start[1] * size};
      if (!find_root(miss, 1e-6 * size, tolerance, e)) continue;
      step.strain.xx = e[0], step.strain.yy = e[1];
      guess_ = {e[0] / size, e[1] / size};
      return;
    }
    fail(segment, fmt::format("stresses of {:.6g} and {:.6g} Pa along x and y cannot be kept; raise them, or "
                              "lower point.step",
                              -kept_.xx, -kept_.yy));
  }

  /// Strain along z under which the stress along z stays. That stress rises with compression, so the strain
  /// lies between two that are found by doubling; then false position (Illinois).
  void keep_normal_stress(const PathSegment& segment, double size, StrainStep& step) {
    const double wide = std::abs(size);
    const double tolerance = 1e-10 * (now_.state.bulk_modulus * wide + std::abs(kept_.zz));
    const auto miss = [&](double strain) {
      StrainStep tried = step;
      tried.strain.zz = strain;
      SoilState state = now_.state;
      update_soil(law_, tried, state);
      return stress_of(state).zz - kept_.zz;
    };
    double low = guess_[0] * wide, at_low = miss(low);
    double high = low, at_high = at_low;
    for (double reach = 0.25 * wide; at_low > 0 && reach < 1e6 * wide; reach *= 2)
      high = low, at_high = at_low, low -= reach, at_low = miss(low);
    for (double reach = 0.25 * wide; at_high < 0 && reach < 1e6 * wide; reach *= 2)
      low = high, at_low = at_high, high += reach, at_high = miss(high);
    if (at_low > 0 || at_high < 0) fail_to_keep(segment);
    double strain = at_high < -at_low ? high : low, missed = at_high < -at_low ? at_high : at_low;
    int side = 0;
    for (int k = 0; k < 200 && std::abs(missed) > tolerance; ++k) {
      strain = at_high > at_low ? low - at_low * (high - low) / (at_high - at_low) : 0.5 * (low + high);
      missed = miss(strain);
      if (missed < 0) {
        low = strain, at_low = missed;
        if (side == -1) at_high *= 0.5;
        side = -1;
      } else {
        high = strain, at_high = missed;
        if (side == 1) at_low *= 0.5;
        side = 1;
      }
    }
    if (!(std::abs(missed) <= tolerance)) fail_to_keep(segment);
    step.strain.zz = strain;
    guess_[0] = strain / wide;
  }

  [[noreturn]] void fail_to_keep(const PathSegment& segment) const {
    fail(segment, fmt::format("a stress of {:.6g} Pa along z cannot be kept; raise it, or lower point.step",
                              -kept_.zz));
  }

  /// Newton's method with differences of size `probe` for miss(e) = 0; a step is halved until it helps, for
  /// the update has corners at yield.
  template <class Miss>
  static bool find_root(const Miss& miss, double probe, double tolerance, std::array<double, 2>& e) {
    const auto norm = [](const std::array<double, 2>& a) { return std::hypot(a[0], a[1]); };
    std::array<double, 2> f = miss(e);
    for (int k = 0; k < 40; ++k) {
      if (norm(f) <= tolerance) return true;
      const auto fx = miss({e[0] + probe, e[1]}), fy = miss({e[0], e[1] + probe});
      const double a = (fx[0] - f[0]) / probe, b = (fy[0] - f[0]) / probe, c = (fx[1] - f[1]) / probe,
                   d = (fy[1] - f[1]) / probe, determinant = a * d - b * c;
      std::array<double, 2> change{-(d * f[0] - b * f[1]) / determinant,
                                   -(a * f[1] - c * f[0]) / determinant};
      int halved = 0;
      for (; halved < 30; ++halved) {
        const std::array<double, 2> tried{e[0] + change[0], e[1] + change[1]}, missed = miss(tried);
        if (norm(missed) < norm(f)) {
          e = tried, f = missed;
          break;
        }
        change = {0.5 * change[0], 0.5 * change[1]};
      }
      if (halved == 30) return false;
    }
    return norm(f) <= tolerance;
  }

  void take(const StrainStep& step) {
    const double before = volume();
    const SoilWork work = update_soil(law_, step, now_.state);
    const double middle = 0.5 * (before + volume());
    now_.strain = now_.strain + step.strain;
    now_.time += step.duration;
    now_.work += middle * work.total;
    now_.dissipated += middle * work.dissipated;
    record_.work_size += middle * std::abs(work.total);
    ++record_.steps;
  }

  /// What follows from the state.
  void describe(double shear_rate) {
    now_.yield = std::sqrt(yield_limit(law_, now_.state, now_.state.pressure, shear_rate));
    now_.stored = volume() * stored_energy(law_, now_.state);
    record_.largest_energy_gap = std::max(
        record_.largest_energy_gap, std::abs(now_.work - now_.dissipated - (now_.stored - stored_at_start_)));
  }

  /// Keeps a row now and then: every second one goes when there are twice as many as wanted.
  void note(double shear_rate) {
    describe(shear_rate);
    if (++since_row_ < stride_) return;
    since_row_ = 0;
    record_.rows.push_back(now_);
    if (record_.rows.size() - first_row_ < 2 * static_cast<std::size_t>(test_.samples)) return;
    std::size_t kept = first_row_;
    for (std::size_t k = first_row_ + 1; k < record_.rows.size(); k += 2)
      record_.rows[kept++] = record_.rows[k];
    record_.rows.resize(kept);
    stride_ *= 2;
  }

  void keep_last_row() {
    if (since_row_ != 0) record_.rows.push_back(now_);
    // Between once and twice as many as wanted: an even share of them, the last among them.
    const std::size_t count = record_.rows.size() - first_row_,
                      most = static_cast<std::size_t>(test_.samples);
    if (count <= most) return;
    for (std::size_t k = 0; k < most; ++k)
      record_.rows[first_row_ + k] = record_.rows[first_row_ + (k + 1) * count / most - 1];
    record_.rows.resize(first_row_ + most);
  }

  const SoilLaw& law_;
  const PointTest& test_;
  PathRecord& record_;
  PathRow now_;
  double stored_at_start_ = 0;
  SymmetricTensor kept_;  ///< stress at the start of the segment: triaxial keeps x and y, direct_shear z
  std::array<double, 2> guess_{};  ///< strains that follow from it over the own one, of the step before
  std::size_t first_row_ = 0, stride_ = 1, since_row_ = 0;
};

}  // namespace

SoilLaw law_of(const PointTest& test, const std::vector<EffectDecision>& effects) {
  const Material& material = test.tested();
  try {
    const SoilLaw law =
        make_soil_law(*material.continuum, effect_on(effects, "tension_cutoff"), soil_effects_of(effects));
    (void)compacted_state(law, test.residual_compression);
    return law;
  } catch (const InputError& error) {
    throw_input_error("{}: material \"{}\", continuum: {}", material.file, material.name, error.what());
  }
}

double shear_stress(const PointTest& test, const PathRow& row) {
  const bool direct = row.segment > 0 && test.segments[row.segment - 1].kind == PathKind::direct_shear;
  return direct ? row.state.deviator.zx : row.state.deviator.xy;
}

void run_strain_path(const SoilLaw& law, const PointTest& test, PathRecord& record) {
  record = {};
  Walker walker(law, test, record);
  for (std::size_t k = 0; k < test.segments.size(); ++k) walker.walk(k);
}

}  // namespace tuft::sph
