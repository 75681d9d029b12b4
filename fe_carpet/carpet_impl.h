#pragma once
/// What a Carpet holds; shared by carpet.cpp (stepping) and carpet_checkpoint.cpp (save and load).
#include <cstdint>
#include <optional>
#include <vector>

#include "fe_carpet/carpet.h"
#include "fe_carpet/element_arrays.h"
#include "fe_carpet/node_arrays.h"
#include "fe_carpet/subcycling.h"

namespace tuft::fe {

struct Carpet::Impl {
  Impl(ShellMesh mesh_in, std::vector<ShellMaterial> materials_in, const CarpetOptions& options_in);

  void step(double dt, const Vec3Array& force, const Vec3Array* moment);
  void update_elements();
  void settle_elements();
  void move(double dt, const Vec3Array& force, const Vec3Array* moment);
  void stop_on_inverted_element() const;
  void stop_on_instability(double dt, const Vec3Array& force, const Vec3Array* moment) const;
  [[nodiscard]] double largest_frequency_squared() const;
  // subcycling.cpp
  [[nodiscard]] std::vector<double> steps_of_families() const;
  void split_off_slow_elements();
  void update_groups(bool all, double impulse);
  void move_subcycled(double dt, const Vec3Array& force, const Vec3Array* moment);

  ShellMesh mesh;
  std::vector<ShellMaterial> materials;
  CarpetOptions options;
  ElementArrays elements;
  MassScaling mass_scaling;
  NodeArrays nodes;
  std::optional<Subcycling> subcycling;   ///< when asked for and some material is slow
  std::vector<double> contact_stiffness;  ///< N/m per node
  double wave_speed = 0;                  ///< m/s, largest of the materials
  double initial_stable_step = 0;         ///< s
  double last_step = 0;                   ///< s, length of the step that led to the present positions
  double time = 0;                        ///< s
  bool from_rest = false;                 ///< stopped since the last step
  std::uint64_t steps = 0;
};

}  // namespace tuft::fe
