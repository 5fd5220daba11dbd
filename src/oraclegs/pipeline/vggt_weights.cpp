#include "oraclegs/pipeline/vggt_weights.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/pipeline/fingerprint.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCommercial = "VGGT-1B-Commercial";  // what its authors call the one for any use
constexpr const char* kResearch = "VGGT-1B";
constexpr size_t kSampled = 64;  // bytes at each end of a tensor: the whole file would be read for nothing else

/// $ORACLEGS_MODELS, else ~/.cache/oraclegs; empty when neither is known.
fs::path ModelsFolder() {
  const char* chosen = std::getenv("ORACLEGS_MODELS");
  if (chosen && *chosen) return chosen;
  const char* home = std::getenv("HOME");
  return home && *home ? fs::path(home) / ".cache" / "oraclegs" : fs::path();
}

fs::path FetchedFile(const std::string& name) { return ModelsFolder() / name / "model.safetensors"; }

bool IsThere(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

VggtWeights Describe(const fs::path& path, const std::string& name) {
  const SafetensorsFile file = SafetensorsFile::Open(path);
  Fingerprint print;
  for (const auto& [key, value] : file.metadata()) print.Add(key).Add(value);
  for (const auto& [tensor, entry] : file.tensors()) {
    print.Add(tensor).Add(entry.dtype);
    for (const int64_t size : entry.shape) print.Add(static_cast<double>(size));
    const size_t sampled = std::min(kSampled, entry.bytes.size());
    print.Add(entry.bytes.substr(0, sampled)).Add(entry.bytes.substr(entry.bytes.size() - sampled));
  }
  const auto model = file.metadata().find("model");
  const bool commercial = name == kCommercial || (model != file.metadata().end() && model->second == kCommercial);
  return {path, commercial ? kCommercial : kResearch, print.Hex(), commercial};
}

}  // namespace

std::optional<VggtWeights> FindVggtWeights(const fs::path& given) {
  if (!given.empty()) {
    if (!IsThere(given))
      throw InputError("{}: there is no such file; name VGGT's weights with --vggt-weights", given.string());
    return Describe(given, kResearch);
  }
  for (const auto& [folder, name] : {std::pair{"vggt-commercial", kCommercial}, std::pair{"vggt", kResearch}}) {
    if (IsThere(FetchedFile(folder))) return Describe(FetchedFile(folder), name);
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
