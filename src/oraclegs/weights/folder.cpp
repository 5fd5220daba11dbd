#include "oraclegs/weights/folder.h"

#include <cstdlib>

#include "oraclegs/core/error.h"
#include "oraclegs/weights/registry.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

bool IsFile(const fs::path& path) {
  std::error_code unreadable;
  return fs::is_regular_file(path, unreadable);
}

}  // namespace

fs::path WeightsFolder() {
  const char* chosen = std::getenv("ORACLEGS_MODELS");
  if (chosen && *chosen) return chosen;
  const char* home = std::getenv("HOME");
  if (!home || !*home) throw UsageError("HOME is not set; set ORACLEGS_MODELS to the folder for the weights of models");
  return fs::path(home) / ".cache" / "oraclegs";
}

fs::path FetchedFile(const std::string& name) { return WeightsFolder() / name / "model.safetensors"; }

std::optional<fs::path> LocateWeights(const std::string& name) {
  const WeightsInfo& model = WeightsNamed(name);
  for (const fs::path& path : {FetchedFile(model.name), WeightsFolder() / model.name / "model.safetensors.index.json",
                               WeightsFolder() / (model.name + ".safetensors")}) {
    if (IsFile(path)) return path;
  }
  return std::nullopt;
}

fs::path RequireWeights(const std::string& name) { return RequireFirstWeights({name}).weights; }

FoundWeights RequireFirstWeights(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (const auto path = LocateWeights(name)) return {name, *path};
  }
  throw InputError("{}: the weights of {} are not here; `oraclegs models fetch {}` brings them",
                   FetchedFile(names.at(0)).string(), fmt::join(names, " or "), names.at(0));
}

}  // namespace oraclegs
