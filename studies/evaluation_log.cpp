#include "studies/evaluation_log.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <sstream>

#include "core/error.h"
#include "core/scene_files.h"

namespace tuft::studies {
namespace {

std::string header_of(const Problem& problem) {
  std::string header = "evaluation,stage";
  for (const Parameter& p : problem.parameters) header += fmt::format(",{} [{}]", p.name(), p.unit);
  header += ",misfit,of targets,failed";
  for (const Target& t : problem.targets)
    header += fmt::format(",{} [{}],misfit of {}", t.name(),
                          t.form == TargetForm::curve ? "of its size" : t.unit, t.name());
  return header + ",seconds [s],error\n";
}

/// Commas and quotes would make columns of their own.
std::string plain(std::string text) {
  std::ranges::replace(text, ',', ';');
  std::ranges::replace(text, '"', '\'');
  std::ranges::replace(text, '\n', ' ');
  return text;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line + ",");
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

double number(const std::string& cell) {
  double value = 0;
  std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return value;
}

}  // namespace

EvaluationLog::EvaluationLog(std::filesystem::path file, const Problem& problem)
    : file_(std::move(file)), problem_(problem), header_(header_of(problem)) {
  std::string kept = header_;
  std::error_code ignored;
  if (std::filesystem::exists(file_, ignored)) {
    std::string text = read_text_file(file_);
    text.erase(text.rfind('\n') + 1);  // what a kill cut off
    if (!text.empty() && !text.starts_with(header_))
      throw_input_error("{}: is a table of other parameters or targets; choose another --out",
                        file_.string());
    if (!text.empty()) kept = text;
    read(kept);
  }
  stream_.open(file_, std::ios::binary | std::ios::trunc);
  stream_ << kept << std::flush;
  if (!stream_) fail_to_write();
}

void EvaluationLog::read(const std::string& text) {
  std::istringstream lines(text.substr(header_.size()));
  for (std::string line; std::getline(lines, line); ++rows_) {
    const auto cells = cells_of(line);
    Evaluation e;
    std::size_t at = 2;
    for (std::size_t i = 0; i < problem_.parameters.size(); ++i) e.values.push_back(number(cells.at(at++)));
    at += 1;
    e.target_misfit = number(cells.at(at++));
    e.misfit = total_misfit(problem_, e.target_misfit, e.values);
    e.failed = cells.at(at++) == "1";
    for (std::size_t i = 0; i < problem_.targets.size(); ++i) {
      TargetOutcome& t = e.targets.emplace_back();
      t.measured = !cells.at(at).empty();
      t.value = number(cells.at(at++));
      t.misfit = number(cells.at(at++));
    }
    e.seconds = number(cells.at(at++));
    e.error = cells.at(at);
    known_[e.values] = std::move(e);
  }
  found_before_ = rows_;
}

const Evaluation* EvaluationLog::find(const std::vector<double>& values) const {
  const auto found = known_.find(values);
  return found == known_.end() ? nullptr : &found->second;
}

void EvaluationLog::add(const std::string& stage, const Evaluation& e) {
  std::string row = fmt::format("{},{}", ++rows_, stage);
  for (const double value : e.values) row += fmt::format(",{}", value);
  row += fmt::format(",{},{},{}", e.misfit, e.target_misfit, e.failed ? 1 : 0);
  for (const TargetOutcome& t : e.targets)
    row += t.measured ? fmt::format(",{},{}", t.value, t.misfit) : fmt::format(",,{}", t.misfit);
  row += fmt::format(",{:.3g},{}\n", e.seconds, plain(e.error));
  stream_ << row << std::flush;
  if (!stream_) fail_to_write();
  Evaluation kept = e;
  kept.outcomes.clear();
  known_[e.values] = std::move(kept);
}

void EvaluationLog::fail_to_write() const {
  throw_run_error("{}: cannot be written: {}", file_.string(), std::strerror(errno));
}

}  // namespace tuft::studies
