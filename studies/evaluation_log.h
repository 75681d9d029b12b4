#pragma once
/// The table of evaluations of a calibration (evaluations.csv): a row each, on disk before the next is begun.
/// An interrupted calibration that is run again into the same folder takes from it what it has.
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "studies/calibration_problem.h"

namespace tuft::studies {

class EvaluationLog {
 public:
  /// Opens the table, reading what an earlier run left; a last row that was cut off is dropped. Throws
  /// InputError for a table of other parameters or targets, RunError when it cannot be written.
  EvaluationLog(std::filesystem::path file, const Problem& problem);

  /// The evaluation of these parameters (SI, the same bits), without its outcomes; null where there is none.
  [[nodiscard]] const Evaluation* find(const std::vector<double>& values) const;
  /// Appends a row and sees it written. Throws RunError when it cannot be.
  void add(const std::string& stage, const Evaluation& evaluation);
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t found_before() const { return found_before_; }  ///< rows of earlier runs

 private:
  void read(const std::string& text);
  [[noreturn]] void fail_to_write() const;

  std::filesystem::path file_;
  const Problem& problem_;
  std::string header_;
  std::map<std::vector<double>, Evaluation> known_;
  std::ofstream stream_;
  std::size_t rows_ = 0, found_before_ = 0;
};

}  // namespace tuft::studies
