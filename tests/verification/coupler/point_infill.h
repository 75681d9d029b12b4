#pragma once
/// An infill of free point masses with no forces between them: what contact does to it can be worked out by
/// hand.
#include "core/infill.h"

namespace tuft::coupler {

class PointInfill final : public Infill {
 public:
  Vec3Array position, velocity;
  std::vector<double> radius_, mass_;
  std::vector<Index> layer_, material_;
  Vec3 gravity{0, 0, 0};
  double step = 1e-3;  ///< s, the step it says it can bear

  void add(const Vec3& x, const Vec3& v, double radius, double mass) {
    position.push_back(x);
    velocity.push_back(v);
    radius_.push_back(radius);
    mass_.push_back(mass);
    layer_.push_back(0);
    material_.push_back(0);
  }

  [[nodiscard]] std::string_view approach() const override { return "point"; }
  [[nodiscard]] ParticleView particles() const override {
    return {position.x, position.y, position.z, velocity.x, velocity.y, velocity.z, {},
            {},         {},         radius_,    mass_,      layer_,     material_,  {}};
  }
  [[nodiscard]] double stable_step() const override { return step; }
  AdvanceReport advance(double window, int substeps, const ContactImpulses& contact) override {
    AdvanceReport report;
    energy_.kinetic = energy_.gravity_potential = 0;
    const double dt = window / substeps;
    for (std::size_t i = 0; i < mass_.size(); ++i) {
      const Vec3 impulse = contact.linear[i] / substeps;
      for (int s = 0; s < substeps; ++s) {
        const Vec3 before = velocity[i];
        const Vec3 after = before + impulse / mass_[i] + gravity * dt;
        if (s == substeps - 1) {  // as of the last kick
          energy_.kinetic += 0.25 * mass_[i] * (before.squaredNorm() + after.squaredNorm());
          energy_.gravity_potential -= mass_[i] * gravity.dot(position[i]);
        }
        velocity.set(i, after);
        position.add(i, dt * after);
        report.impulse_received += mass_[i] * (after - before - gravity * dt);
      }
      report.impulse_scale += contact.linear[i].cwiseAbs();
    }
    report.substeps = substeps;
    return report;
  }
  void set_damping(double) override {}
  [[nodiscard]] InfillEnergy energy() const override { return energy_; }
  [[nodiscard]] std::uint64_t particle_steps() const override { return 0; }
  void save(h5::Group&) override {}
  void load(const h5::Group&) override {}
  [[nodiscard]] std::vector<Field> fields() const override { return {}; }

 private:
  InfillEnergy energy_;
};

}  // namespace tuft::coupler
