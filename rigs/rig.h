#pragma once
/// What every rig is to a run: bodies, a release, a measurement per interval, results at the end.
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/scene.h"
#include "coupler/simulation.h"
#include "rigs/run.h"

namespace tuft::rigs {

/// One recorded history of a rig, under /history/<name> of run.h5.
struct HistoryColumn {
  std::string name, unit;
};

class Rig {
 public:
  Rig() = default;
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  virtual ~Rig() = default;

  /// Bodies of the rig, absent until release; they follow the tray's in the simulation, from index first_body
  /// on.
  [[nodiscard]] virtual std::vector<coupler::RigidBody> bodies() const = 0;
  virtual void set_first_body(std::size_t index) = 0;
  [[nodiscard]] virtual double energy_scale() const = 0;  ///< J, the energy the rig brings
  /// Sets the rig in motion; called once, when settling ends.
  virtual void release(coupler::Simulation& simulation) = 0;
  /// Measures after an interval; time is s since release.
  virtual void sample(const coupler::Simulation& simulation, double time, double interval) = 0;
  [[nodiscard]] virtual std::vector<HistoryColumn> columns() const = 0;
  [[nodiscard]] virtual std::vector<double> row() const = 0;  ///< of the last sample
  /// Histories that need the whole run (filtered signals): empty in run.h5 until the run ends, stops or
  /// fails.
  struct FinishedColumn {
    HistoryColumn column;
    std::vector<double> values;  ///< one a sample
  };
  [[nodiscard]] virtual std::vector<FinishedColumn> finished_columns() const = 0;
  [[nodiscard]] virtual std::map<std::string, Quantity> results() const = 0;

  virtual void save(h5::Group& group) const = 0;
  virtual void load(const h5::Group& group) = 0;
};

/// The rig a scene asks for. Throws InputError for a type not known.
[[nodiscard]] std::unique_ptr<Rig> make_rig(const Scene& scene);

}  // namespace tuft::rigs
