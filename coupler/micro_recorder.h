#pragma once
/// The micro-scale in run.h5: with each frame the contacts, what they are like as a whole, and fields on a
/// grid, as far as the scene asks for them (docs/theory/micro_scale.md). Looks only: a run records the same
/// otherwise, bit by bit.
#include <vector>

#include "core/record_file.h"
#include "core/scene.h"
#include "coupler/simulation.h"
#include "micro_scale/coarse_grid.h"

namespace tuft::coupler {

struct MicroSettings {
  bool contacts = false, fields = false;
  micro::CoarseGrid grid;
  micro::Kernel kernel;
  /// kg/m^3 of the solid in each of Scene::materials; 0: not known.
  std::vector<double> solid_density;

  [[nodiscard]] bool any() const { return contacts || fields; }
};

/// The grid spans the patch, from the backing's top to a quarter of the infill's depth above it, the same for
/// both approaches; of a specimen the room. SPH rows of a specimen lie on its walls, and are pressed a little
/// into them.
[[nodiscard]] MicroSettings micro_settings(const Scene& scene);

class MicroRecorder {
 public:
  explicit MicroRecorder(MicroSettings settings) : settings_(std::move(settings)) {}

  [[nodiscard]] std::vector<Channel> channels(const Simulation& simulation) const;
  /// What never changes: the grid, the bins of the distribution of forces, and which grain a sphere is of.
  void write_static(h5::Group& root, const Simulation& simulation) const;
  /// With each frame.
  void record(RecordFile& file, double time, const Simulation& simulation);

 private:
  /// particles: whole grains (coupler/whole_grains.h), which the network is of.
  void record_contacts(RecordFile& file, double time, const Simulation& simulation,
                       const ParticleView& particles, const ContactNetwork& network);
  void record_fields(RecordFile& file, const Simulation& simulation, const ParticleView& particles,
                     const ContactNetwork& network) const;
  [[nodiscard]] std::vector<double> solid_volumes(const ParticleView& particles) const;

  MicroSettings settings_;
};

}  // namespace tuft::coupler
