/// The loop over elements: gathers, calls the pure functions of element and material, scatters to the corner
/// buffer. It owns the data flow and holds no formula of the element or the material.
#include <array>

#include "fe_carpet/element_arrays.h"
#include "fe_carpet/erosion.h"
#include "fe_carpet/stable_step.h"

namespace tuft::fe {
namespace {

using Vector = Triple<Pack>;

std::array<Vector, 4> gather_corners(const ElementArrays& elements, const Vec3Array& values,
                                     std::size_t batch) {
  std::array<Vector, 4> corner;
  for (std::size_t c = 0; c < 4; ++c) {
    const Index* nodes = &elements.node[c][batch * lanes];
    corner[c] = {gather(values.x.data(), nodes), gather(values.y.data(), nodes),
                 gather(values.z.data(), nodes)};
  }
  return corner;
}

CornerModes<Pack> modes(const std::array<Vector, 4>& f) {
  return corner_modes(f[0], f[1], f[2], f[3]);
}

CornerModes<Pack> combine(const CornerModes<Pack>& a, const Pack& scale, const CornerModes<Pack>& b) {
  return {a.xi + scale * b.xi, a.eta + scale * b.eta, a.h + scale * b.h};
}

/// Rows of a batch's state, a pack each.
class StateRows {
 public:
  explicit StateRows(double* first) : first_(first) {}
  [[nodiscard]] Pack read(std::size_t row) const { return load(first_ + row * lanes); }
  void write(std::size_t row, const Pack& pack) const { store(first_ + row * lanes, pack); }
  [[nodiscard]] StateRows from(std::size_t row) const { return StateRows(first_ + row * lanes); }
  /// Adds an increment and returns the mean of before and after, whose product with the strain increment is
  /// the work.
  Pack advance(std::size_t row, const Pack& increment, Pack& after) const {
    const Pack before = read(row);
    after = before + increment;
    write(row, after);
    return before + 0.5 * increment;
  }

 private:
  double* first_;
};

constexpr std::size_t drilling_rows = 4, hourglass_modes = 6;

/// Values of state of the one-point element's hourglass modes.
template <class Law>
std::size_t hourglass_rows(const Law& law, const ShellSection& section) {
  return hourglass_modes * (section.hourglass == HourglassControl::stiffness ? law.shear_rows() : 1);
}

/// Drilling penalty; returns its work.
Pack advance_drilling(const StateRows& rows, const ModeStiffness<Pack>& k, const ShellModes<Pack>& de,
                      ShellModes<Pack>& s) {
  Pack work = rows.advance(0, k.spin * de.spin, s.spin) * de.spin;
  work += rows.advance(1, k.spin_deviation * de.spin_xi, s.spin_xi) * de.spin_xi;
  work += rows.advance(2, k.spin_deviation * de.spin_eta, s.spin_eta) * de.spin_eta;
  work += rows.advance(3, k.spin_deviation * de.spin_h, s.spin_h) * de.spin_h;
  return work;
}

/// Hourglass stiffness of the one-point element; returns its work. Under a viscoelastic law the modes relax:
/// fibres as uniaxial stress and slopes of shear as shear, which is exact; turns as uniaxial stress too,
/// though they are bending with the width held (which relaxes less) and twist (which relaxes more): off by 8
/// % of what is left, at most, where five sixths of the shear modulus relax.
template <class Law>
Pack advance_hourglass(const Law& law, const StateRows& rows, const ModeStiffness<Pack>& k,
                       const ShellModes<Pack>& de, ShellModes<Pack>& s) {
  const std::size_t each = law.shear_rows();
  Pack work(0.0);
  const auto uniaxial = [&](std::size_t mode, const Pack& increment, const Pack& strain, Pack& force) {
    const ShearAdvance<Pack> a = law.template relax_uniaxial<Pack>(rows.from(mode * each), increment);
    force = a.stress;
    work += a.mean * strain;
  };
  const auto shear = [&](std::size_t mode, const Pack& increment, const Pack& strain, Pack& force) {
    const ShearAdvance<Pack> a = law.template relax_shear<Pack>(rows.from(mode * each), increment);
    force = a.stress;
    work += a.mean * strain;
  };
  uniaxial(0, k.fibre_xi * de.fibre_xi, de.fibre_xi, s.fibre_xi);
  uniaxial(1, k.fibre_eta * de.fibre_eta, de.fibre_eta, s.fibre_eta);
  uniaxial(2, k.turn_xx * de.turn_x + k.turn_xy * de.turn_y, de.turn_x, s.turn_x);
  uniaxial(3, k.turn_xy * de.turn_x + k.turn_yy * de.turn_y, de.turn_y, s.turn_y);
  shear(4, k.shear_xi_eta * de.shear_xi_eta, de.shear_xi_eta, s.shear_xi_eta);
  shear(5, k.shear_eta_xi * de.shear_eta_xi, de.shear_eta_xi, s.shear_eta_xi);
  return work;
}

/// Forces proportional to the modes' rates over a step. The rows keep those of the step before: the nodes do
/// the work of the mean of both, which is returned.
Pack damp_hourglass(const StateRows& rows, const ModeStiffness<Pack>& damping, double step,
                    const ShellModes<Pack>& de, ShellModes<Pack>& s) {
  const Pack over(1 / step);
  Pack work(0.0);
  const auto damp = [&](std::size_t row, const Pack& c, const Pack& increment, Pack& force) {
    force = over * c * increment;
    work += 0.5 * (rows.read(row) + force) * increment;
    rows.write(row, force);
  };
  damp(0, damping.fibre_xi, de.fibre_xi, s.fibre_xi);
  damp(1, damping.fibre_eta, de.fibre_eta, s.fibre_eta);
  damp(2, damping.turn_xx, de.turn_x, s.turn_x);
  damp(3, damping.turn_yy, de.turn_y, s.turn_y);
  damp(4, damping.shear_xi_eta, de.shear_xi_eta, s.shear_xi_eta);
  damp(5, damping.shear_eta_xi, de.shear_eta_xi, s.shear_eta_xi);
  return work;
}

ModeStiffness<Pack> scaled_hourglass(ModeStiffness<Pack> k, double coefficient) {
  for (Pack* mode :
       {&k.fibre_xi, &k.fibre_eta, &k.turn_xx, &k.turn_xy, &k.turn_yy, &k.shear_xi_eta, &k.shear_eta_xi})
    *mode = coefficient * *mode;
  return k;
}

/// What a batch's elements do in one step, gathered.
struct BatchStep {
  ShellFrame<Pack> middle, end;
  ShellModes<Pack> de;  ///< strain increments
  Pack thickness;
};

BatchStep take_step(const ElementArrays& elements, const NodeMotion& nodes, double last_step,
                    std::size_t batch) {
  const Pack step(last_step), half_step_back(-0.5 * last_step);
  const CornerModes<Pack> x = modes(gather_corners(elements, nodes.position, batch));
  const CornerModes<Pack> v = modes(gather_corners(elements, nodes.velocity, batch));
  std::array<Vector, 4> r = gather_corners(elements, nodes.angular_velocity, batch);
  // The rotation vector of a chord, 2 tan(angle/2) to third order: it belongs to the frame halfway.
  for (Vector& corner : r) {
    const Vector turn = step * corner;
    corner = (Pack(1.0) + (1.0 / 12.0) * dot(turn, turn)) * turn;
  }
  BatchStep s;
  s.middle = shell_frame(combine(x, half_step_back, v));
  s.de = strain_increments(s.middle, CornerModes<Pack>{step * v.xi, step * v.eta, step * v.h}, modes(r),
                           corner_mean(r[0], r[1], r[2], r[3]));
  s.end = shell_frame(x);
  s.thickness = load(&elements.thickness[batch * lanes]);
  return s;
}

void store_corner(double* corner, const Vector& force, const Vector& moment) {
  store(corner, force.x);
  store(corner + lanes, force.y);
  store(corner + 2 * lanes, force.z);
  store(corner + 3 * lanes, moment.x);
  store(corner + 4 * lanes, moment.y);
  store(corner + 5 * lanes, moment.z);
}

void store_forces(double* batch, const ShellForces<Pack>& f) {
  const Pack quarter(0.25);
  const Vector sum = quarter * (f.force.xi + f.force.eta), difference = quarter * (f.force.xi - f.force.eta),
               h = quarter * f.force.h;
  const Vector moment_sum = quarter * (f.moment.xi + f.moment.eta),
               moment_difference = quarter * (f.moment.xi - f.moment.eta), moment_h = quarter * f.moment.h,
               mean = quarter * f.mean_moment;
  const Vector even = mean + moment_h, odd = mean - moment_h;
  store_corner(batch, h - sum, even - moment_sum);
  store_corner(batch + corner_values, difference - h, odd + moment_difference);
  store_corner(batch + 2 * corner_values, h + sum, even + moment_sum);
  store_corner(batch + 3 * corner_values, Pack(-1.0) * difference - h, odd - moment_difference);
}

/// Membrane forces and moments in the thickness that the step has led to.
struct ThinnedSection {
  SectionForces<Pack> forces;
  Pack stretch;  ///< of the thickness
};

template <int Points, class Law>
ThinnedSection advance_thinned(const Law& law, const StateRows& rows, const Pack& t,
                               const SectionStrain<Pack>& e) {
  ThinnedSection s{advance_section<Points, Law, Pack>(law, rows, t, e), Pack(1.0)};
  s.stretch = 1.0 + s.forces.thickness_strain;
  PlaneStress<Pack>&n = s.forces.force, &m = s.forces.moment;
  const Pack square = s.stretch * s.stretch;
  n = {s.stretch * n.xx, s.stretch * n.yy, s.stretch * n.xy};
  m = {square * m.xx, square * m.yy, square * m.xy};
  s.forces.work *= 1.0 + 0.5 * s.forces.thickness_strain;
  return s;
}

/// A family's law for one batch: the same for all, or from a table.
template <class Law>
const Law& law_of_batch(const ElementFamily& /*family*/, const Law& law, std::size_t /*batch*/) {
  return law;
}
OrthotropicLaw<Pack> law_of_batch(const ElementFamily& family, const OrthotropicTable& table,
                                  std::size_t batch) {
  const double* first = &table.stiffness[(batch - family.first_batch) * OrthotropicTable::values * lanes];
  const auto value = [first](std::size_t v) { return load(first + v * lanes); };
  return {value(0), value(1), value(2),  value(3),  value(4),  value(5),  value(6), value(7),
          value(8), value(9), value(10), value(11), value(12), value(13), value(14)};
}

/// Isotropic and at least as stiff, for bounds.
const IsotropicLaw& bounding_law(const IsotropicLaw& law) {
  return law;
}
const IsotropicLaw& bounding_law(const ViscoelasticLaw& law) {
  return law.instantaneous;
}
const IsotropicLaw& bounding_law(const OrthotropicTable& table) {
  return table.stiffer;
}

/// Sums over the batches of a block.
struct Works {
  Pack strain{0.0}, hourglass{0.0};
  Pack uprightness{1.0};  ///< smallest
};

/// Adds the works of a step to those of the batch's elements and marks those whose strain is too large. s:
/// their forces at its end. An element that goes may be turned inside out as it does.
void follow_failure(ElementArrays& elements, const ElementFamily& family, std::size_t batch,
                    std::size_t block, const Works& before, const Works& after, const Pack& principal_strain,
                    const ShellModes<Pack>& de, const ShellModes<Pack>& s, Pack& upright) {
  const StateRows rows =
      StateRows(&elements.state[elements.state_of_batch(batch)]).from(family.rows - family.failure_rows());
  rows.write(0, rows.read(0) + (after.strain - before.strain));
  rows.write(1, rows.read(1) + (after.hourglass - before.hourglass));
  const auto too_far = principal_strain > family.failure_strain;
  if (stdx::none_of(too_far)) return;
  stdx::where(too_far, upright) = 1.0;
  store(&elements.last_half_work[batch * lanes], 0.5 * work(s, de));
  for (std::size_t lane = 0; lane < lanes; ++lane)
    if (too_far[lane] && elements.element[batch * lanes + lane] >= 0)
      elements.failed[batch * lanes + lane] = elements.failing[block] = 1;
}

/// Rows of a followed point's strain, after the two of the works.
StateRows strain_rows(const ElementFamily& family, const StateRows& rows, std::size_t point) {
  return rows.from(family.rows - family.failure_rows() + 2 + 6 * point);
}

template <int Points, class Law>
void update_one_point(ElementArrays& elements, const ElementFamily& family, const Law& law,
                      const NodeMotion& nodes, double last_step, std::size_t batch, std::size_t block,
                      Works& works) {
  const Works before = works;
  const BatchStep step = take_step(elements, nodes, last_step, batch);
  const ShellFrame<Pack>& f = step.middle;
  const ShellModes<Pack>& de = step.de;
  const Pack t = step.thickness;
  const StateRows rows(&elements.state[elements.state_of_batch(batch)]);
  const ModeStiffness<Pack> k = mode_stiffness<Law, Pack>(law, f, t);
  const ShellSection& options = family.section;
  ShellModes<Pack> s;
  if (options.hourglass == HourglassControl::stiffness) {
    works.hourglass +=
        advance_hourglass(law, rows, scaled_hourglass(k, options.hourglass_coefficient), de, s);
  } else {
    const double step_length = last_step > 0 ? last_step : 1;  // before the first step nothing has moved
    const ModeStiffness<Pack> damping =
        mode_damping(f, k, load(&elements.mass[batch * lanes]), load(&elements.inertia_ratio[batch * lanes]),
                     options.hourglass_coefficient);
    works.hourglass += damp_hourglass(rows, damping, step_length, de, s);
  }
  const std::size_t drilling = hourglass_rows(law, options);
  works.hourglass += advance_drilling(rows.from(drilling), k, de, s);

  const std::size_t shear = drilling + drilling_rows, sr = law.shear_rows();
  const ThinnedSection section = advance_thinned<Points, Law>(
      law, rows.from(shear + 2 * sr), t, {{de.exx, de.eyy, de.gxy}, {de.kxx, de.kyy, de.kxy}});
  const Pack gxz = f.xi_x * de.shear_xi + f.eta_x * de.shear_eta;
  const Pack gyz = f.xi_y * de.shear_xi + f.eta_y * de.shear_eta;
  const ShearAdvance<Pack> xz = law.template advance_shear<Pack>(rows.from(shear), gxz);
  const ShearAdvance<Pack> yz = law.template advance_shear<Pack>(rows.from(shear + sr), gyz);
  works.strain += f.area * (section.forces.work + t * (xz.mean * gxz + yz.mean * gyz));
  store(&elements.thickness[batch * lanes], t * section.stretch);

  const Pack area = step.end.area, shear_area = area * t * section.stretch;
  const SectionForces<Pack>& forces = section.forces;
  s.exx = area * forces.force.xx;
  s.eyy = area * forces.force.yy;
  s.gxy = area * forces.force.xy;
  s.kxx = area * forces.moment.xx;
  s.kyy = area * forces.moment.yy;
  s.kxy = area * forces.moment.xy;
  s.shear_xi = shear_area * (step.end.xi_x * xz.stress + step.end.xi_y * yz.stress);
  s.shear_eta = shear_area * (step.end.eta_x * xz.stress + step.end.eta_y * yz.stress);
  Pack upright = uprightness(f, step.end);
  if (family.failure_points > 0) {
    const Pack strain = advance_strain<Pack>(strain_rows(family, rows, 0),
                                             {{de.exx, de.eyy, de.gxy}, {de.kxx, de.kyy, de.kxy}},
                                             (0.5 * outermost_height<Points>()) * t);
    follow_failure(elements, family, batch, block, before, works, strain, de, s, upright);
  }
  works.uprightness = stdx::min(works.uprightness, upright);
  store_forces(&elements.forces[batch * batch_values], nodal_forces(step.end, s));
}

/// Forces in the thickness that the step has led to: one for all points, as the state has. Were each point
/// thinned by its own strain of the step, which the next step forgets, a strip under tension N would have
/// forces -N nu' (rate of in-plane bending) dt: damping below zero, that grows until the element breaks.
void thin_forces(const Pack& stretch, ShellModes<Pack>& s) {
  const Pack square = stretch * stretch;
  for (Pack* force : {&s.exx, &s.eyy, &s.gxy, &s.fibre_xi, &s.fibre_eta, &s.shear_xi, &s.shear_xi_eta,
                      &s.shear_eta, &s.shear_eta_xi})
    *force = stretch * *force;
  for (Pack* moment : {&s.kxx, &s.kyy, &s.kxy, &s.turn_x, &s.turn_y}) *moment = square * *moment;
}

template <int Points, class Law>
void update_full(ElementArrays& elements, const ElementFamily& family, const Law& law,
                 const NodeMotion& nodes, double last_step, std::size_t batch, std::size_t block,
                 Works& works) {
  constexpr double gauss = 0.57735026918962576;
  const Works before_step = works;
  Pack principal_strain(0.0);
  const BatchStep step = take_step(elements, nodes, last_step, batch);
  const Pack t = step.thickness, zero(0.0);
  const StateRows rows(&elements.state[elements.state_of_batch(batch)]);
  ShellModes<Pack> s{zero, zero, zero, zero, zero, zero, zero, zero, zero,
                     zero, zero, zero, zero, zero, zero, zero, zero, zero};
  const Pack drilling = step.middle.area * t * law.drilling_modulus();
  ModeStiffness<Pack> k;
  k.spin = drilling_share * drilling;
  k.spin_deviation = (drilling_share_of_deviations / 3) * drilling;
  works.hourglass += advance_drilling(rows, k, step.de, s);

  const std::size_t sr = law.shear_rows(), point_rows = 2 * sr + section_rows<Points>(law);
  const FibrePair<Pack> before = fibre_pair(law, step.middle), after = fibre_pair(law, step.end);
  Pack strain_work(0.0), thickness_strain(0.0);
  for (std::size_t p = 0; p < 4; ++p) {
    const double xi = p == 0 || p == 3 ? -gauss : gauss, eta = p < 2 ? -gauss : gauss;
    const PointShape<Pack> shape = point_shape(step.middle, xi, eta);
    const PointStrain<Pack> e = strain_at(shape, before, step.de, xi, eta);
    const StateRows point = rows.from(drilling_rows + p * point_rows);
    const ShearAdvance<Pack> xz = law.template advance_shear<Pack>(point, e.gxz);
    const ShearAdvance<Pack> yz = law.template advance_shear<Pack>(point.from(sr), e.gyz);
    const SectionForces<Pack> section =
        advance_section<Points, Law, Pack>(law, point.from(2 * sr), t, e.section);
    strain_work += shape.j.determinant * (section.work + t * (xz.mean * e.gxz + yz.mean * e.gyz));
    thickness_strain += 0.25 * section.thickness_strain;
    add_point_forces(point_shape(step.end, xi, eta), after, section, t * xz.stress, t * yz.stress, xi, eta,
                     s);
    if (family.failure_points > 0)
      principal_strain =
          stdx::max(principal_strain, advance_strain<Pack>(strain_rows(family, rows, p), e.section,
                                                           (0.5 * outermost_height<Points>()) * t));
  }
  works.strain += (1.0 + 0.5 * thickness_strain) * strain_work;
  const Pack stretch = 1.0 + thickness_strain;
  thin_forces(stretch, s);
  Pack upright = uprightness(step.middle, step.end);
  if (family.failure_points > 0)
    follow_failure(elements, family, batch, block, before_step, works, principal_strain, step.de, s, upright);
  works.uprightness = stdx::min(works.uprightness, upright);
  store(&elements.thickness[batch * lanes], t * stretch);
  store_forces(&elements.forces[batch * batch_values], nodal_forces(step.end, s));
}

template <ElementKind Kind, int Points, class Law>
void update_batches(ElementArrays& elements, const ElementFamily& family, const NodeMotion& nodes,
                    double last_step, std::size_t first, std::size_t last, std::size_t block) {
  const Law& law = std::get<Law>(family.law);
  Works works;
  for (std::size_t batch = first; batch < last; ++batch) {
    const auto& of_batch = law_of_batch(family, law, batch);
    if constexpr (Kind == ElementKind::one_point)
      update_one_point<Points>(elements, family, of_batch, nodes, last_step, batch, block, works);
    else
      update_full<Points>(elements, family, of_batch, nodes, last_step, batch, block, works);
  }
  elements.strain_work[block] += sum_lanes(works.strain);
  elements.hourglass_work[block] += sum_lanes(works.hourglass);
  elements.uprightness[block] = stdx::hmin(works.uprightness);
}

template <int Points, class Law>
void choose(ElementFamily& family, const Law& law) {
  const std::size_t point_rows = 2 * law.shear_rows() + section_rows<Points>(law);
  if (family.section.element == ElementKind::one_point) {
    family.update = update_batches<ElementKind::one_point, Points, Law>;
    family.rows = hourglass_rows(law, family.section) + drilling_rows + point_rows;
  } else {
    family.update = update_batches<ElementKind::fully_integrated, Points, Law>;
    family.rows = drilling_rows + 4 * point_rows;
  }
  if (family.failure_strain > 0)
    family.failure_points = family.section.element == ElementKind::one_point ? 1 : 4;
  family.rows += family.failure_rows();
}

}  // namespace

void choose_element_function(ElementFamily& family) {
  std::visit(
      [&family](const auto& law) {
        switch (family.section.thickness_points) {
          case 2:
            return choose<2>(family, law);
          case 3:
            return choose<3>(family, law);
          case 4:
            return choose<4>(family, law);
          case 5:
            return choose<5>(family, law);
          default:
            return choose<1>(family, law);
        }
      },
      family.law);
}

Pack batch_frequency_squared(const ElementArrays& elements, const Vec3Array& position, std::size_t batch) {
  const ElementFamily& family = elements.family[static_cast<std::size_t>(elements.batch_family[batch])];
  const ShellFrame<Pack> f = shell_frame(modes(gather_corners(elements, position, batch)));
  const Pack t = load(&elements.thickness[batch * lanes]);
  // Padding has no mass: with any other than a tiny one its bound is zero, whatever its shape.
  Pack padding_safe_mass = load(&elements.mass[batch * lanes]);
  stdx::where(padding_safe_mass <= 0.0, padding_safe_mass) = 1.0;
  const IsotropicLaw& law =
      std::visit([](const auto& l) -> const IsotropicLaw& { return bounding_law(l); }, family.law);
  const ModeStiffness<Pack> k = mode_stiffness<IsotropicLaw, Pack>(law, f, t);
  const Pack inertia_ratio = load(&elements.inertia_ratio[batch * lanes]);
  const auto bound = [&](const ModeStiffness<Pack>& modes_stiffness) {
    return frequency_squared_bound(f, law, t, padding_safe_mass, inertia_ratio, modes_stiffness);
  };
  const ShellSection& section = family.section;
  if (section.element == ElementKind::fully_integrated) return bound(k);
  if (section.hourglass == HourglassControl::stiffness)
    return bound(scaled_hourglass(k, section.hourglass_coefficient));
  // Damping forces C v are taken from the velocity before the step, which is stable while K + (2/dt) C <=
  // (4/dt^2) M: as a stiffness of omega C at the limit omega = 2/dt. Should that be above the omega tried, by
  // a factor b in its square, b omega is enough, since K + b omega C <= b (K + omega C).
  const Pack tried = bound(scaled_hourglass(k, 0)), omega = stdx::sqrt(tried);
  ModeStiffness<Pack> damped =
      mode_damping(f, k, padding_safe_mass, inertia_ratio, section.hourglass_coefficient);
  for (Pack* mode : {&damped.fibre_xi, &damped.fibre_eta, &damped.turn_xx, &damped.turn_yy,
                     &damped.shear_xi_eta, &damped.shear_eta_xi})
    *mode = omega * *mode;
  damped.spin = k.spin;
  const Pack over = stdx::max(Pack(1.0), bound(damped) / stdx::max(tried, Pack(1e-300)));
  return tried * over * over;
}

Index find_inverted_element(const ElementArrays& elements, const NodeMotion& nodes, double last_step,
                            std::span<const std::uint8_t> of_family) {
  for (std::size_t batch = 0; batch < elements.batch_count; ++batch) {
    if (!of_family[static_cast<std::size_t>(elements.batch_family[batch])]) continue;
    const CornerModes<Pack> x = modes(gather_corners(elements, nodes.position, batch));
    const CornerModes<Pack> v = modes(gather_corners(elements, nodes.velocity, batch));
    const Pack upright = uprightness(shell_frame(combine(x, Pack(-0.5 * last_step), v)), shell_frame(x));
    for (std::size_t lane = 0; lane < lanes; ++lane)
      if (!(upright[lane] > 0) && elements.element[batch * lanes + lane] >= 0)
        return elements.element[batch * lanes + lane];
  }
  return -1;
}

}  // namespace tuft::fe
