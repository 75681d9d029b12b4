#pragma once
/// What a run leaves in run.h5 (docs/architecture.md, "run.h5").
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/record_file.h"
#include "coupler/micro_recorder.h"
#include "coupler/simulation.h"

namespace tuft::coupler {

/// A rig's column under /history, with its unit.
struct RecordedColumn {
  std::string name, unit;
};

class Recorder {
 public:
  /// Starts run.h5. `columns`: one value each per history row. `finished`: columns written once, at the end.
  static Recorder create(const std::filesystem::path& path, const Simulation& simulation,
                         const std::string& scene_text, const std::string& version,
                         const std::vector<RecordedColumn>& columns,
                         const std::vector<RecordedColumn>& finished, const MicroSettings& micro = {});
  /// Goes on after a checkpoint that was taken when `rows` rows stood in the file.
  static Recorder reopen(const std::filesystem::path& path, const Simulation& simulation,
                         const std::map<std::string, std::uint64_t>& rows,
                         const std::vector<RecordedColumn>& columns, const MicroSettings& micro = {});

  /// One history row, and one of energies where the ledger has entered the moment. time: s since release.
  void record_history(double time, const std::vector<double>& row, const EnergyLedger& ledger);
  void record_frame(double time, const Simulation& simulation);
  void record_cost(double time, const std::map<std::string, double>& cost);
  void record_finished(const std::string& name, const std::vector<double>& values);
  /// Writes the buffer now; otherwise it is written when it holds more than 8 MB or is older than two
  /// seconds.
  void flush() { file_.flush(); }
  void flush_when_due();
  [[nodiscard]] std::map<std::string, std::uint64_t> rows() const { return file_.rows(); }

 private:
  Recorder(RecordFile file, std::vector<RecordedColumn> columns, MicroRecorder micro,
           const Simulation& simulation)
      : file_(std::move(file)),
        columns_(std::move(columns)),
        micro_(std::move(micro)),
        entries_(simulation.ledger().entries()) {}
  RecordFile file_;
  std::vector<RecordedColumn> columns_;
  MicroRecorder micro_;
  std::uint64_t entries_;  ///< of the ledger, at the last row
  std::chrono::steady_clock::time_point last_flush_ = std::chrono::steady_clock::now();
};

}  // namespace tuft::coupler
