#pragma once
/// run.h5 and the results of a tension rig.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/record_file.h"
#include "core/scene.h"
#include "coupler/energy_ledger.h"
#include "rigs/run.h"
#include "rigs/tension_results.h"

namespace tuft::rigs {

/// Starts run.h5: /history and /energy, with the rows of all tests one after the other; /history/test says of
/// which (from 0). Time is that since the first test began.
[[nodiscard]] RecordFile create_tension_record(const std::filesystem::path& path, const Scene& scene,
                                               const std::string& version);
void append_tension_row(RecordFile& record, double time, std::size_t test, double rate, const TensionRow& row,
                        const coupler::EnergyLedger& ledger);

/// "rate_0.1_stress_at_20_percent" and so on; what a test did not reach is left out.
void add_tension_results(std::map<std::string, Quantity>& results, double rate,
                         const std::vector<TensionRow>& rows);

}  // namespace tuft::rigs
