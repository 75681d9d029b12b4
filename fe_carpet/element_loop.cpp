/// The loop over elements: gathers, calls the pure functions of shell_kernel.h and plane_stress.h, scatters
/// to the corner buffer. It owns the data flow and holds no formula of the element or the material.
#include <array>

#include "fe_carpet/element_arrays.h"
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

DiagonalForm<Pack> diagonals(const std::array<Vector, 4>& f) {
  return diagonal_form(f[0], f[1], f[2], f[3]);
}

DiagonalForm<Pack> combine(const DiagonalForm<Pack>& a, const Pack& scale, const DiagonalForm<Pack>& b) {
  return {a.along13 + scale * b.along13, a.along24 + scale * b.along24, a.hourglass + scale * b.hourglass};
}

/// state[value] of a batch.
class StateRows {
 public:
  explicit StateRows(double* first) : first_(first) {}
  [[nodiscard]] Pack read(std::size_t value) const { return load(first_ + value * lanes); }
  void write(std::size_t value, const Pack& pack) { store(first_ + value * lanes, pack); }
  /// Adds an increment and returns the mean of before and after, whose product with the strain increment is
  /// the work.
  Pack advance(std::size_t value, const Pack& increment, Pack& after) {
    const Pack before = read(value);
    after = before + increment;
    write(value, after);
    return before + 0.5 * increment;
  }

 private:
  double* first_;
};

/// One "point": the resultants themselves. Returns the work per area.
Pack update_resultants(StateRows rows, const PlaneStressLaw& law, const Pack& t, const ShellStrain<Pack>& e,
                       ShellResultants<Pack>& s) {
  const ShellResultants<Pack> d = elastic_resultants(law, t, e);
  constexpr std::size_t first = hourglass_values;
  Pack work = rows.advance(first + 0, d.nxx, s.nxx) * e.exx;
  work += rows.advance(first + 1, d.nyy, s.nyy) * e.eyy;
  work += rows.advance(first + 2, d.nxy, s.nxy) * e.gxy;
  work += rows.advance(first + 3, d.mxx, s.mxx) * e.kxx;
  work += rows.advance(first + 4, d.myy, s.myy) * e.kyy;
  work += rows.advance(first + 5, d.mxy, s.mxy) * e.kxy;
  work += rows.advance(first + 6, d.qxz, s.qxz) * e.gxz;
  work += rows.advance(first + 7, d.qyz, s.qyz) * e.gyz;
  return work;
}

/// Gauss points through the thickness, each with its own stress. Returns the work per area.
template <int Points>
Pack update_points(StateRows rows, const PlaneStressLaw& law, const Pack& t, const ShellStrain<Pack>& e,
                   ShellResultants<Pack>& s) {
  constexpr ThicknessRule<Points> rule = thickness_rule<Points>();
  constexpr std::size_t first_shear = hourglass_values, first_point = hourglass_values + 2;
  Pack after;
  Pack work = rows.advance(first_shear, law.transverse_shear * e.gxz, after) * e.gxz;
  s.qxz = t * after;
  work += rows.advance(first_shear + 1, law.transverse_shear * e.gyz, after) * e.gyz;
  s.qyz = t * after;
  s.nxx = s.nyy = s.nxy = s.mxx = s.myy = s.mxy = Pack(0.0);
  for (std::size_t p = 0; p < Points; ++p) {
    const Pack z = t * (0.5 * rule.height[p]);
    const Pack exx = e.exx + z * e.kxx, eyy = e.eyy + z * e.kyy, gxy = e.gxy + z * e.kxy;
    const PlaneStress<Pack> d = elastic_stress(law, exx, eyy, gxy);
    PlaneStress<Pack> stress;
    const std::size_t first = first_point + 3 * p;
    Pack point_work = rows.advance(first, d.xx, stress.xx) * exx;
    point_work += rows.advance(first + 1, d.yy, stress.yy) * eyy;
    point_work += rows.advance(first + 2, d.xy, stress.xy) * gxy;
    const Pack weight = t * rule.weight[p], lever = weight * z;
    work += rule.weight[p] * point_work;
    s.nxx += weight * stress.xx;
    s.nyy += weight * stress.yy;
    s.nxy += weight * stress.xy;
    s.mxx += lever * stress.xx;
    s.myy += lever * stress.yy;
    s.mxy += lever * stress.xy;
  }
  return t * work;
}

Pack update_hourglass(StateRows rows, const PlaneStressLaw& law, const Pack& t, const ShellGeometry<Pack>& g,
                      const ShellHourglass<Pack>& d, ShellHourglass<Pack>& q) {
  const ShellHourglass<Pack> increment = hourglass_resistance(law, t, g, d);
  Pack work = rows.advance(0, increment.mx, q.mx) * d.mx;
  work += rows.advance(1, increment.my, q.my) * d.my;
  work += rows.advance(2, increment.w, q.w) * d.w;
  work += rows.advance(3, increment.tx, q.tx) * d.tx;
  work += rows.advance(4, increment.ty, q.ty) * d.ty;
  return work;
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
  const Vector mean_plus = f.mean_moment + f.moment.hourglass,
               mean_minus = f.mean_moment - f.moment.hourglass;
  store_corner(batch, f.force.hourglass + f.force.along13, mean_plus + f.moment.along13);
  store_corner(batch + corner_values, f.force.along24 - f.force.hourglass, mean_minus + f.moment.along24);
  store_corner(batch + 2 * corner_values, f.force.hourglass - f.force.along13, mean_plus - f.moment.along13);
  const Vector minus_along24 = Pack(-1.0) * f.force.along24;
  store_corner(batch + 3 * corner_values, minus_along24 - f.force.hourglass, mean_minus - f.moment.along24);
}

template <int Points>
void update_batch(ElementArrays& elements, const NodeMotion& nodes, double last_step, std::size_t batch,
                  Pack& strain_work, Pack& hourglass_work) {
  const PlaneStressLaw& law = elements.law[static_cast<std::size_t>(elements.batch_material[batch])];
  const Pack t = load(&elements.thickness[batch * lanes]);
  const Pack step(last_step), half_step_back(-0.5 * last_step);
  const DiagonalForm<Pack> x = diagonals(gather_corners(elements, nodes.position, batch));
  const DiagonalForm<Pack> v = diagonals(gather_corners(elements, nodes.velocity, batch));
  const std::array<Vector, 4> w = gather_corners(elements, nodes.angular_velocity, batch);

  const ShellGeometry<Pack> middle = shell_geometry(combine(x, half_step_back, v));
  const DiagonalForm<Pack> rate_w = diagonals(w);
  const DiagonalForm<Pack> d{step * v.along13, step * v.along24, step * v.hourglass};
  const DiagonalForm<Pack> r{step * rate_w.along13, step * rate_w.along24, step * rate_w.hourglass};
  const Vector r_sum = step * ((w[0] + w[1]) + (w[2] + w[3]));
  ShellStrain<Pack> strain;
  ShellHourglass<Pack> hourglass;
  strain_increments(middle, d, r, r_sum, strain, hourglass);

  const StateRows rows(&elements.state[batch * state_values(Points) * lanes]);
  ShellResultants<Pack> resultants;
  ShellHourglass<Pack> resistance;
  hourglass_work += update_hourglass(rows, law, t, middle, hourglass, resistance);
  if constexpr (Points == 1)
    strain_work += middle.area * update_resultants(rows, law, t, strain, resultants);
  else
    strain_work += middle.area * update_points<Points>(rows, law, t, strain, resultants);

  store_forces(&elements.forces[batch * batch_values],
               nodal_forces(shell_geometry(x), resultants, resistance));
}

template <int Points>
void update_block(ElementArrays& elements, const NodeMotion& nodes, double last_step, std::size_t block) {
  const std::size_t end = std::min(elements.batch_count, (block + 1) * batches_per_block);
  Pack strain_work(0.0), hourglass_work(0.0);
  for (std::size_t batch = block * batches_per_block; batch < end; ++batch)
    update_batch<Points>(elements, nodes, last_step, batch, strain_work, hourglass_work);
  elements.strain_work[block] += sum_lanes(strain_work);
  elements.hourglass_work[block] += sum_lanes(hourglass_work);
}

}  // namespace

ElementBlockFunction element_block_function(int thickness_points) {
  switch (thickness_points) {
    case 1:
      return update_block<1>;
    case 2:
      return update_block<2>;
    case 3:
      return update_block<3>;
    case 4:
      return update_block<4>;
    case 5:
      return update_block<5>;
    default:
      return nullptr;
  }
}

Pack batch_frequency_squared(const ElementArrays& elements, const Vec3Array& position, std::size_t batch) {
  const PlaneStressLaw& law = elements.law[static_cast<std::size_t>(elements.batch_material[batch])];
  const ShellGeometry<Pack> g = shell_geometry(diagonals(gather_corners(elements, position, batch)));
  const Pack mass = load(&elements.mass[batch * lanes]);
  const Pack padding_safe_mass = stdx::max(mass, Pack(1e-300));
  return frequency_squared_bound(g, law, load(&elements.thickness[batch * lanes]), padding_safe_mass,
                                 load(&elements.inertia_ratio[batch * lanes]));
}

}  // namespace tuft::fe
