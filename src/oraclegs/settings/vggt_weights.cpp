#include "oraclegs/settings/vggt_weights.h"

#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/settings/fingerprint.h"
#include "oraclegs/settings/weights.h"
#include "oraclegs/weights/folder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCommercial = "VGGT-1B-Commercial";    // its authors' name of the network for any use
constexpr const char* kCommercialModel = "vggt-commercial";  // its name in `oraclegs models` and the converter
constexpr const char* kResearch = "VGGT-1B";

/// Path of fetched weights; nullopt when they are missing, or when there is no home folder.
std::optional<fs::path> Fetched(const std::string& model) {
  try {
    return LocateWeights(model);
  } catch (const UsageError&) {
    return std::nullopt;
  }
}

/// Number of blocks of global attention in the file, by the names of its tensors.
int64_t CountAttentionLayers(const SafetensorsFile& file) {
  int64_t layers = 0;
  const auto has = [&](int64_t layer) {
    const std::string prefix = fmt::format("aggregator.global_blocks.{}.", layer);
    const auto found = file.tensors().lower_bound(prefix);
    return found != file.tensors().end() && found->first.compare(0, prefix.size(), prefix) == 0;
  };
  while (has(layers)) ++layers;
  return layers;
}

VggtWeights Describe(const fs::path& path, const std::string& name) {
  const SafetensorsFile file = SafetensorsFile::Open(path);
  const auto model = file.metadata().find("model");
  const bool commercial = name == kCommercial || (model != file.metadata().end() && model->second == kCommercialModel);
  return {path,
          commercial ? kCommercial : kResearch,
          Fingerprint().AddTensors(file).Hex(),
          commercial,
          BytesOf(file),
          CountAttentionLayers(file)};
}

}  // namespace

std::optional<VggtWeights> FindVggtWeights(const fs::path& given) {
  if (!given.empty()) {
    std::error_code ignored;
    if (fs::is_regular_file(given, ignored)) return Describe(given, kResearch);
    throw InputError("{}: there is no such file; name VGGT's weights with --vggt-weights", given.string());
  }
  for (const auto& [model, name] : {std::pair{kCommercialModel, kCommercial}, std::pair{"vggt", kResearch}}) {
    if (const auto path = Fetched(model)) return Describe(*path, name);
  }
  return std::nullopt;
}

VggtWeights RequireVggtWeights(const fs::path& given, const std::string& needs) {
  if (auto found = FindVggtWeights(given)) return std::move(*found);
  throw InputError(
      "{}: {} needs the weights of VGGT, which are not here; `oraclegs models fetch vggt` brings them, or name a file "
      "with --vggt-weights",
      FetchedFile("vggt").string(), needs);
}

}  // namespace oraclegs
