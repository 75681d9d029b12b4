#pragma once
/// Who touches whom in the infill, and with what force: the micro-scale as grains know it.
#include <cstdint>
#include <vector>

#include "core/vector.h"

namespace tuft {

enum class ContactKind : std::uint8_t { grain, backing, fibre, body };
inline constexpr std::size_t contact_kinds = 4;

/// Structure of arrays, one entry a contact, each contact once. Action is reaction: the other end bears the
/// opposite force. Sorted by kind, then particle, then other.
struct ContactNetwork {
  std::vector<ContactKind> kind;
  std::vector<Index> particle;
  /// The other particle (> particle), the carpet's surface (0: the backing, else a strand) or the body.
  std::vector<Index> other;
  Vec3Array branch;             ///< m, from the particle's centre to the other's; or to the contact point
  Vec3Array normal_force;       ///< N on the particle, along the normal of the contact
  Vec3Array tangential_force;   ///< N on the particle, across it
  std::vector<double> overlap;  ///< m, > 0

  [[nodiscard]] std::size_t size() const { return kind.size(); }
  [[nodiscard]] Vec3 force(std::size_t c) const { return normal_force[c] + tangential_force[c]; }

  /// `normal`: unit vector from the other towards the particle. Splits the force along it.
  void add(ContactKind of, Index first, Index second, const Vec3& to_other, const Vec3& normal,
           const Vec3& on_first, double depth) {
    const Vec3 along = on_first.dot(normal) * normal;
    kind.push_back(of);
    particle.push_back(first);
    other.push_back(second);
    branch.push_back(to_other);
    normal_force.push_back(along);
    tangential_force.push_back(on_first - along);
    overlap.push_back(depth);
  }
};

}  // namespace tuft
