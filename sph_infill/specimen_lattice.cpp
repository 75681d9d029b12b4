#include "sph_infill/specimen_lattice.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sph_infill/row_slopes.h"

namespace tuft::sph {
namespace {

std::vector<double> row_slopes(int rows, double spacing, std::array<double, 2> across,
                               const SphOptions& options) {
  std::vector<double> slopes;
  for (int k = 0; k < rows; ++k) slopes.push_back(row_slope(options, k * spacing, across));
  return slopes;
}

/// Weights mirrored from one wall to the other.
Eigen::VectorXd mirrored(const Eigen::VectorXd& half, int rows) {
  Eigen::VectorXd all(rows);
  for (int k = 0; k < rows; ++k) all[k] = half[std::min(k, rows - 1 - k)];
  return all;
}

/// Force on each row under a uniform unit stress, per area: sum_i w_i dL_i/du_k, with the corrected gradient
/// L_i = sum_j w_j (u_j - u_i) g_ij / sum_j w_j (z_j - z_i) g_ij.
Eigen::VectorXd row_forces(const Eigen::VectorXd& weight, const std::vector<double>& slope) {
  const auto rows = weight.size();
  Eigen::VectorXd force = Eigen::VectorXd::Zero(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    double moment = 0;
    for (Eigen::Index j = 0; j < rows; ++j)
      moment +=
          weight[j] * slope[static_cast<std::size_t>(std::abs(j - i))] * static_cast<double>(std::abs(j - i));
    for (Eigen::Index j = 0; j < rows; ++j) {
      if (j == i) continue;
      const double sign = j > i ? 1 : -1;
      const double pair =
          weight[i] * weight[j] * sign * slope[static_cast<std::size_t>(std::abs(j - i))] / moment;
      force[j] += pair;
      force[i] -= pair;
    }
  }
  return force;
}

void check_options(const SphOptions& options) {
  if (!(options.pitch > 0) || !std::isfinite(options.pitch))
    throw_input_error("infill.sph.pitch is {} m; it must be above 0", options.pitch);
  if (!(options.smoothing_length > 0) || !std::isfinite(options.smoothing_length))
    throw_input_error("infill.sph.smoothing_length is {} m; it must be above 0", options.smoothing_length);
}

/// Spaces of about `pitch` in `length`.
int spaces_in(double length, double pitch, int fewest, const char* what) {
  if (!(length > 0) || !std::isfinite(length))
    throw_input_error("the specimen's {} is {} m; it must be above 0", what, length);
  const int spaces = static_cast<int>(std::lround(length / pitch));
  if (spaces < fewest)
    throw_input_error(
        "infill.sph.pitch: {:.3g} mm leaves {} spaces between rows in the specimen's {} of {:.3g} mm, at "
        "least {} "
        "are needed; make it {:.3g} mm or less",
        1e3 * pitch, spaces, what, 1e3 * length, fewest, 1e3 * length / fewest);
  return spaces;
}

void scale_volumes(std::vector<double>& volumes, double total) {
  double sum = 0;
  for (const double v : volumes) sum += v;
  for (double& v : volumes) v *= total / sum;
}

}  // namespace

std::vector<double> row_weights(int rows, double spacing, std::array<double, 2> across,
                                const SphOptions& options) {
  const std::vector<double> slope = row_slopes(rows, spacing, across, options);
  const int unknown = (rows + 1) / 2, inner = rows - 2;
  Eigen::VectorXd half = Eigen::VectorXd::Ones(unknown);
  half[0] = 0.5;
  // Besides equilibrium of the inner rows: the sum.
  const auto residual = [&](const Eigen::VectorXd& w) {
    const Eigen::VectorXd all = mirrored(w, rows), force = row_forces(all, slope);
    Eigen::VectorXd r(inner + 1);
    r.head(inner) = force.segment(1, inner);
    r[inner] = all.sum() - (rows - 1);
    return r;
  };
  // Newton, by differences, in the least-squares sense: near the middle rows the equations say the same
  // twice.
  constexpr int most = 50;
  constexpr double difference = 1e-6, longest = 0.2, close = 1e-13;
  for (int iteration = 0; iteration < most; ++iteration) {
    const Eigen::VectorXd r = residual(half);
    Eigen::MatrixXd jacobian(r.size(), unknown);
    for (int k = 0; k < unknown; ++k) {
      Eigen::VectorXd moved = half;
      moved[k] += difference;
      jacobian.col(k) = (residual(moved) - r) / difference;
    }
    Eigen::VectorXd step = jacobian.colPivHouseholderQr().solve(-r);
    if (step.norm() > longest) step *= longest / step.norm();
    half += step;
    if (step.norm() < close) break;
  }
  if (!half.allFinite() || !(half.minCoeff() > 0.1))
    throw_input_error(
        "infill.sph: {} rows with a smoothing length of {:.3g} times their spacing leave no volumes in "
        "equilibrium; "
        "make infill.sph.pitch smaller or use preset \"accurate\"",
        rows, options.smoothing_length / spacing);
  const Eigen::VectorXd all = mirrored(half, rows);
  return {all.begin(), all.end()};
}

Lattice fill_ring(const RingSpecimen& specimen, Index material, const SphOptions& options) {
  check_options(options);
  const int rings = spaces_in(specimen.radius, options.pitch, fewest_spaces / 2, "radius");
  const int rows = spaces_in(specimen.height, options.pitch, fewest_spaces, "height") + 1;
  const double between_rings = specimen.radius / rings, spacing = specimen.height / (rows - 1);
  const double along_ring = 2 * std::numbers::pi / 6 * between_rings;
  // A diameter is a set of rows between two walls.
  const std::vector<double> of_ring =
      row_weights(2 * rings + 1, between_rings, {along_ring, spacing}, options);
  const double in_plane = std::sqrt(between_rings * along_ring);
  const std::vector<double> of_row = row_weights(rows, spacing, {in_plane, in_plane}, options);

  Lattice lattice;
  lattice.pitch = in_plane;
  for (int k = 0; k <= rings; ++k) {
    const double radius = k * between_rings;
    const int count = std::max(1, 6 * k);
    const double cell =
        k == 0 ? std::numbers::pi / 4 * between_rings * between_rings : between_rings * along_ring;
    for (int c = 0; c < count; ++c) {
      const double angle = 2 * std::numbers::pi * c / count;
      for (int row = 0; row < rows; ++row) {
        lattice.position.push_back({radius * std::cos(angle), radius * std::sin(angle), row * spacing});
        lattice.volume.push_back(cell * spacing * of_ring[static_cast<std::size_t>(rings + k)] *
                                 of_row[static_cast<std::size_t>(row)]);
      }
    }
  }
  const std::size_t count = lattice.volume.size();
  scale_volumes(lattice.volume, std::numbers::pi * specimen.radius * specimen.radius * specimen.height);
  lattice.layer.assign(count, 0);
  lattice.material.assign(count, material);
  lattice.radius.assign(count, 0.5 * spacing);
  lattice.stands_on_walls = true;
  return lattice;
}

Lattice fill_box(const BoxSpecimen& specimen, Index material, const SphOptions& options) {
  check_options(options);
  const int nx = spaces_in(specimen.size[0], options.pitch, fewest_spaces, "length");
  const int ny = spaces_in(specimen.size[1], options.pitch, fewest_spaces, "width");
  int nz = spaces_in(specimen.height, options.pitch, fewest_spaces, "height");
  if (nz % 2 == 0) nz += nz * options.pitch < specimen.height || nz == fewest_spaces ? 1 : -1;
  const double dx = specimen.size[0] / nx, dy = specimen.size[1] / ny, dz = specimen.height / nz;
  const std::vector<double> wx = row_weights(nx + 1, dx, {dy, dz}, options),
                            wy = row_weights(ny + 1, dy, {dx, dz}, options),
                            wz = row_weights(nz + 1, dz, {dx, dy}, options);
  Lattice lattice;
  lattice.pitch = std::sqrt(dx * dy);
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j)
      for (int k = 0; k <= nz; ++k) {
        lattice.position.push_back(
            {i * dx - 0.5 * specimen.size[0], j * dy - 0.5 * specimen.size[1], k * dz});
        lattice.volume.push_back(dx * dy * dz * wx[static_cast<std::size_t>(i)] *
                                 wy[static_cast<std::size_t>(j)] * wz[static_cast<std::size_t>(k)]);
      }
  const std::size_t count = lattice.volume.size();
  scale_volumes(lattice.volume, specimen.size[0] * specimen.size[1] * specimen.height);
  lattice.layer.assign(count, 0);
  lattice.material.assign(count, material);
  lattice.radius.assign(count, 0.5 * dz);
  lattice.stands_on_walls = true;
  return lattice;
}

}  // namespace tuft::sph
