#pragma once
// options.json: what a run was asked for, and whether it is the one that is asked for now.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

inline constexpr int kRunFormat = 1;  ///< of options.json

/// What options.json holds.
struct SavedRun {
  std::filesystem::path scene;      ///< absolute; bytes that are not UTF-8 are replaced; OUT/photos where imported
  std::vector<std::string> inputs;  ///< what was imported, likewise; empty for a scene that is read where it is
  nlohmann::json options;           ///< of all groups, as asked for
  nlohmann::json size;              ///< what "auto" became (settings/run_size.h); null = not known yet
  /// --iterations of the run before it was continued with more; 0 = it was not.
  int64_t start_iterations = 0;
};

/// True when `dir` holds a run of this program.
bool IsWorkspace(const std::filesystem::path& dir);
/// Throws InputError naming the file when it is missing or damaged.
SavedRun ReadSavedRun(const std::filesystem::path& dir);

/// "--views was 9, now is 12; --seed was 0, now is 1": the options that shape the result and differ; empty when none.
/// A run saved before an option existed has its default; `size` is what its "auto" became, which may be asked for in
/// its place.
std::string DescribeDifference(const nlohmann::json& saved, const RunOptions& now, const nlohmann::json& size = {});

/// True when nothing that shapes the result differs but --iterations, of which there are more now.
bool AsksForMoreIterations(const SavedRun& saved, const RunOptions& now);

/// --iterations of a saved run, also of one that had them automatic; 0 where it does not say.
int64_t IterationsOf(const SavedRun& saved);

/// A JSON file of a run. Throws InputError naming it.
nlohmann::json ReadRunJson(const std::filesystem::path& path);

}  // namespace oraclegs
