#pragma once
/// Grains as wholes, for whoever looks at them: a clump is one grain, of whatever spheres it is made.
#include <span>
#include <vector>

#include "core/contact_network.h"
#include "core/infill.h"

namespace tuft::coupler {

/// First sphere of each grain, and one more: a grain's spheres follow each other. clumps:
/// DemInfill::clumps.
[[nodiscard]] std::vector<std::size_t> first_spheres(std::size_t spheres, std::span<const Index> clumps);

/// Of an infill as it stands, which must outlive this and stay as it is.
class WholeGrains {
 public:
  explicit WholeGrains(const Infill& infill);
  /// clumps: DemInfill::clumps; empty: each particle is a whole.
  WholeGrains(const ParticleView& spheres, std::span<const Index> clumps);
  WholeGrains(const WholeGrains&) = delete;
  WholeGrains& operator=(const WholeGrains&) = delete;

  /// Centres of mass, their velocities, masses; spins. Radii are those of a clump's widest sphere.
  [[nodiscard]] const ParticleView& view() const { return view_; }
  /// Of each sphere; empty where each is one.
  [[nodiscard]] std::span<const Index> grain_of_sphere() const { return grain_of_sphere_; }
  /// The same contacts and forces, of grains: branches begin and end at centres of mass. Two grains may have
  /// several contacts with each other.
  [[nodiscard]] ContactNetwork network_of(const ContactNetwork& of_spheres) const;

 private:
  void add_grain(const ParticleView& spheres, std::size_t first, std::size_t end);

  ParticleView spheres_, view_;
  std::vector<Index> grain_of_sphere_, layer_, material_;
  Vec3Array position_, velocity_, spin_;
  std::vector<double> radius_, mass_;
  std::vector<std::uint8_t> expelled_;
};

}  // namespace tuft::coupler
