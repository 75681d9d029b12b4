#pragma once
/// What LIGGGHTS remembers of a contact, as its models laid it out: first single values of the normal model
/// (hooke/hysteresis: the largest overlap), then vectors of three, the tangential spring's and the rolling
/// spring's.
namespace tuft::dem {

/// Place of the tangential spring, of `values` in all.
[[nodiscard]] constexpr int first_vector(int values) {
  return values % 3;
}

}  // namespace tuft::dem
