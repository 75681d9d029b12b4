#pragma once
/// The energy balance of a run: what went in must be stored, moving, or accounted for as lost.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "core/hdf5_file.h"

namespace tuft::coupler {

/// Energies of one moment, J. The balance: sum of all terms before `external_work` minus `external_work` is
/// constant.
struct EnergyTerms {
  double kinetic_carpet = 0;
  double kinetic_infill = 0;
  double kinetic_bodies = 0;
  double strain_carpet = 0;
  double hourglass = 0;          ///< work of hourglass resistance in the shells
  double eroded = 0;             ///< had gone into shells until they failed
  double stored_infill = 0;      ///< elastic in the infill
  double dissipated_infill = 0;  ///< plastic, frictional and viscous inside the infill
  double contact_elastic = 0;    ///< penalty and friction springs
  double contact_damping = 0;
  double contact_friction = 0;
  double gravity_potential = 0;  ///< relative to z = 0
  double damping = 0;            ///< taken out by mass-proportional damping
  double expelled = 0;           ///< kinetic, of infill as it left the turf
  double conditioning = 0;   ///< what spheres held that the continuum in their place cannot (springs, spin)
  double external_work = 0;  ///< put in: released overlap, bodies set in motion, driven bodies

  static constexpr std::size_t count = 16;
  static constexpr std::array<std::string_view, count> names{
      "kinetic_carpet",  "kinetic_infill",  "kinetic_bodies",   "strain_carpet",
      "hourglass",       "eroded",          "stored_infill",    "dissipated_infill",
      "contact_elastic", "contact_damping", "contact_friction", "gravity_potential",
      "damping",         "expelled",        "conditioning",     "external_work"};
  [[nodiscard]] std::array<double, count> values() const {
    return {kinetic_carpet,  kinetic_infill,  kinetic_bodies,   strain_carpet,
            hourglass,       eroded,          stored_infill,    dissipated_infill,
            contact_elastic, contact_damping, contact_friction, gravity_potential,
            damping,         expelled,        conditioning,     external_work};
  }
  [[nodiscard]] double balance() const {
    double sum = 0;
    for (const double value : values()) sum += value;
    return sum - 2 * external_work;
  }
};

/// Follows the balance. The relative error divides by the energy that is at stake: the larger of the scale
/// given at the start (a missile's kinetic energy) and the most that has been in motion and stored so far.
class EnergyLedger {
 public:
  EnergyLedger(double limit, double scale) : limit_(limit), scale_(scale) {}

  /// Takes a moment in. The first one is the reference.
  /// Throws RunError naming the term when a term is not finite, and when the error passes the limit: with the
  /// time, the term that rose most since the last entry, and what `fastest` says (a sentence naming the
  /// fastest particle and node), which is asked for then alone.
  void enter(double time, const EnergyTerms& terms, const std::function<std::string()>& fastest);

  [[nodiscard]] double imbalance() const { return last_.balance() - reference_; }  ///< J, of the last entry
  [[nodiscard]] double error() const { return error_; }  ///< relative, signed, of the last entry
  [[nodiscard]] double largest_error() const {
    return largest_error_;
  }  ///< relative, absolute value, over the run
  [[nodiscard]] const EnergyTerms& last() const { return last_; }
  [[nodiscard]] std::uint64_t entries() const { return entries_; }

  void save(h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  double limit_, scale_;
  std::uint64_t entries_ = 0;  ///< the first is the reference
  double reference_ = 0, error_ = 0, largest_error_ = 0;
  EnergyTerms last_;
};

}  // namespace tuft::coupler
