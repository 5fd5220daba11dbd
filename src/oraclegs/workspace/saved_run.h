#pragma once
// options.json: the options of a run, and the check that they are those asked for now.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

inline constexpr int kRunFormat = 1;  ///< format of options.json

/// Content of options.json.
struct SavedRun {
  std::filesystem::path scene;      ///< absolute; OUT/photos where imported; bytes that are not UTF-8 are replaced
  std::vector<std::string> inputs;  ///< imported paths, written like scene; empty for a scene that is read where it is
  nlohmann::json options;           ///< all groups, as asked for
  nlohmann::json size;              ///< values of "auto" (settings/run_size.h); null = not known yet
  /// --iterations before the run was continued with more; 0 = it was not.
  int64_t start_iterations = 0;
};

/// True when `dir` holds a run of this program.
bool IsWorkspace(const std::filesystem::path& dir);
/// Throws InputError naming the file when it is missing or damaged.
SavedRun ReadSavedRun(const std::filesystem::path& dir);

/// "--views was 9, now is 12; --seed was 0, now is 1": the options that shape the result and differ; empty when none.
/// An option newer than the saved run has its default there. `size` has the values that "auto" got; asking for such a
/// value is no difference.
std::string DescribeDifference(const nlohmann::json& saved, const RunOptions& now, const nlohmann::json& size = {});

/// True when --iterations, of which there are more now, is the only difference that shapes the result.
bool AsksForMoreIterations(const SavedRun& saved, const RunOptions& now);

/// True when --quality, which is higher now, is the only difference that shapes the result.
bool AsksForHigherQuality(const SavedRun& saved, const RunOptions& now);

/// --quality of a saved run.
std::string QualityOf(const SavedRun& saved);

/// --iterations of a saved run, or their automatic value; 0 where it has none.
int64_t IterationsOf(const SavedRun& saved);

/// Reads a JSON file of a run. Throws InputError naming it.
nlohmann::json ReadRunJson(const std::filesystem::path& path);

}  // namespace oraclegs
