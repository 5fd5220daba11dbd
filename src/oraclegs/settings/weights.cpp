#include "oraclegs/settings/weights.h"

#include <algorithm>

#include "oraclegs/core/error.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/weights/folder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSuffix = ".safetensors";

std::vector<fs::path> FilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.is_regular_file(ignored) && entry.path().extension() == kSuffix) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::vector<fs::path> FindWeights(const std::string& model, const fs::path& given) {
  std::error_code ignored;
  if (given.empty()) {
    try {
      if (const auto file = LocateWeights(model)) return {*file};
      return FilesIn(WeightsFolder() / model);  // put there by hand
    } catch (const UsageError&) {               // there is no home folder
      return {};
    }
  }
  if (fs::is_regular_file(given, ignored)) return {given};
  if (!fs::is_directory(given, ignored)) {
    throw InputError("{}: does not exist; name a {} file with the weights of {}", given.string(), kSuffix, model);
  }
  std::vector<fs::path> files = FilesIn(given);
  if (files.empty()) {
    throw InputError("{}: has no {} file in it; name one with the weights of {}", given.string(), kSuffix, model);
  }
  return files;
}

int64_t BytesOf(const SafetensorsFile& file) {
  int64_t bytes = 0;
  for (const auto& [name, tensor] : file.tensors()) bytes += static_cast<int64_t>(tensor.bytes.size());
  return bytes;
}

std::string HowToFetch(const std::string& model) {
  return fmt::format("`oraclegs models fetch {}` brings them", model);
}

std::vector<fs::path> FindLpips(const WeightOptions& options) {
  return FindWeights(kLpipsModel, options.lpips_weights);
}

fs::path FindKeypointWeights() {
  const std::vector<fs::path> files = FindWeights(kKeypointModel, {});
  return files.size() == 1 && HasNetworksLibrary() ? files[0] : fs::path();
}

DepthSource ChooseDepthSource(const RunOptions& options, SensorDepth sensor) {
  const Auto<DepthPrior>& asked = options.depth.depth_prior;
  if (!options.depth.depth_folder.empty()) return {DepthPrior::kStereo, {}};
  if (asked == DepthPrior::kNone || asked == DepthPrior::kStereo) return {asked.value(), {}};
  if (asked == DepthPrior::kSensor && sensor == SensorDepth::kNone) {
    throw InputError(
        "--depth-prior sensor: no photo of the scene has a depth of a sensor; name depth in transforms.json "
        "(depth_file_path) or export Polycam's raw data, or leave --depth-prior out");
  }
  const bool takes_sensor = asked.is_auto() && options.method.method.empty() && sensor == SensorDepth::kMost;
  if (asked == DepthPrior::kSensor || takes_sensor) return {DepthPrior::kSensor, {}};
  const std::vector<fs::path> files = FindWeights(kDepthModel, options.weights.depth_weights);
  if (files.size() > 1) {
    throw InputError("{}: holds {} files, Depth Anything V2 has one; name one with --depth-weights",
                     files[0].parent_path().string(), files.size());
  }
  if (asked.is_auto() && (files.empty() || !HasNetworksLibrary())) return {DepthPrior::kStereo, {}};
  if (files.empty()) {
    throw InputError("--depth-prior {} needs the weights of Depth Anything V2; {}, or name a file with --depth-weights",
                     Word(asked.value()), HowToFetch(kDepthModel));
  }
  RequireNetworksLibrary("--depth-prior " + Word(asked.ValueOr(DepthPrior::kFused)));
  return {asked.ValueOr(DepthPrior::kFused), files[0]};
}

}  // namespace oraclegs
