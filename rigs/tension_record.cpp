#include "rigs/tension_record.h"

#include <fmt/format.h>

#include "core/scene_reader.h"

namespace tuft::rigs {

RecordFile create_tension_record(const std::filesystem::path& path, const Scene& scene,
                                 const std::string& version) {
  std::vector<Channel> channels{
      {"/history/time", "s", {}, false},         {"/history/test", "1", {}, false},
      {"/history/rate", "1/s", {}, false},       {"/history/test_time", "s", {}, false},
      {"/history/strain", "1", {}, false},       {"/history/stress", "Pa", {}, false},
      {"/history/true_stress", "Pa", {}, false}, {"/history/force", "N", {}, false},
      {"/history/force_held", "N", {}, false},   {"/history/principal_strain", "1", {}, false},
      {"/history/failed", "1", {}, false},       {"/energy/time", "s", {}, false},
      {"/energy/error", "1", {}, false}};
  for (const auto name : coupler::EnergyTerms::names)
    channels.push_back({"/energy/" + std::string(name), "J", {}, false});
  return RecordFile::create(path, channels, [&](h5::Group& root) {
    root.set_attribute("version", version);
    root.set_attribute("approach", "fe");
    root.write_string("scene", write_scene(scene));
  });
}

void append_tension_row(RecordFile& record, double time, std::size_t test, double rate, const TensionRow& row,
                        const coupler::EnergyLedger& ledger) {
  record.append("/history/time", time);
  record.append("/history/test", static_cast<double>(test));
  record.append("/history/rate", rate);
  record.append("/history/test_time", row.time);
  record.append("/history/strain", row.strain);
  record.append("/history/stress", row.stress);
  record.append("/history/true_stress", row.true_stress);
  record.append("/history/force", row.force);
  record.append("/history/force_held", row.force_held);
  record.append("/history/principal_strain", row.principal_strain);
  record.append("/history/failed", row.failed ? 1.0 : 0.0);
  record.append("/energy/time", time);
  record.append("/energy/error", ledger.error());
  const auto values = ledger.last().values();
  for (std::size_t i = 0; i < values.size(); ++i)
    record.append("/energy/" + std::string(coupler::EnergyTerms::names[i]), values[i]);
}

void add_tension_results(std::map<std::string, Quantity>& results, double rate,
                         const std::vector<TensionRow>& rows) {
  const TensionResults r = evaluate_tension(rows);
  const auto add = [&](const char* name, std::optional<double> value, const char* unit) {
    if (value) results[fmt::format("rate_{:g}_{}", rate, name)] = {*value, unit};
  };
  add("initial_modulus", r.initial_modulus, "Pa");
  add("stress_at_05_percent", r.stress_at_5, "Pa");
  add("stress_at_10_percent", r.stress_at_10, "Pa");
  add("stress_at_20_percent", r.stress_at_20, "Pa");
  add("peak_stress", r.peak_stress, "Pa");
  add("strain_at_peak", r.strain_at_peak, "1");
  add("strain_at_failure", r.strain_at_failure, "1");
  add("stress_at_failure", r.stress_at_failure, "Pa");
}

}  // namespace tuft::rigs
