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
  void take_out_failed();
  void settle_elements();
  void move(double dt, const Vec3Array& force, const Vec3Array* moment);
  void book_start_from_rest();
  void stop_on_inverted_element() const;
  void stop_on_instability(double dt, const Vec3Array& force, const Vec3Array* moment) const;
  [[nodiscard]] double largest_frequency_squared() const;
  // subcycling.cpp
  [[nodiscard]] std::vector<double> steps_of_families() const;
  void split_off_slow_elements();
  void update_groups(bool all, double impulse);
  void move_subcycled(double dt, const Vec3Array& force, const Vec3Array* moment);

  void book_grips(double dt, const Vec3Array& force);
  [[nodiscard]] Vec3 holding_force(std::size_t node, const Vec3Array& force) const;

  /// Nodes that are driven, and what drives them (carpet_drive.cpp).
  struct Grips {
    std::vector<std::size_t> nodes;
    std::vector<Vec3> force;         ///< N, per driven node, at the last force evaluation
    double work = 0, last_work = 0;  ///< J; total includes that of the last step
    Vec3 impulse{0, 0, 0};           ///< N s
    double exchanged = 0;            ///< N s
  } grips;

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
  double eroded_energy = 0;               ///< J, work that had gone into elements until they failed
  bool from_rest = false;                 ///< stopped since the last step
  std::uint64_t steps = 0;
};

}  // namespace tuft::fe
