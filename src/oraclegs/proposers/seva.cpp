#include "oraclegs/proposers/seva.h"

#include <nlohmann/json.hpp>

#include "oraclegs/image/codecs.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/settings/fingerprint.h"
#include "oraclegs/settings/weights.h"
#include "oraclegs/weights/folder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kChunks = "seva_chunks";

/// "seva", or "seva_" and a number.
bool IsSource(const std::string& folder) {
  const std::string first = SevaSource(0);
  if (!folder.starts_with(first)) return false;
  if (folder == first) return true;
  return folder[first.size()] == '_' && folder.size() > first.size() + 1 &&
         folder.find_first_not_of("0123456789", first.size() + 1) == std::string::npos;
}

}  // namespace

SevaFiles FindSevaFiles(const WeightOptions& options) {
  const auto& [unet, vae, clip] = kSevaNetworks;
  const fs::path file =
      options.seva_weights.empty() ? RequireWeights(unet) : FindWeights(unet, options.seva_weights).front();
  return {{file}, RequireWeights(vae), RequireWeights(clip)};
}

std::string SevaKey(const SevaOptions& options, const SevaFiles& files) {
  nlohmann::json json = OptionsToJson(options);
  json.erase("seva-halves");  // how it fits into memory
  Fingerprint print;
  print.Add(json.dump());
  for (const fs::path& file : {files.unet.front(), files.vae, files.clip}) {
    print.AddTensors(SafetensorsFile::Open(file));
  }
  return print.Hex();
}

std::string SevaSource(int candidate) {
  return candidate == 0 ? std::string("seva") : fmt::format("seva_{}", candidate + 1);
}

void GenerateViews(const SevaRequest& request, const Listener& listener) {
  const Networks& networks = GetNetworks();
  const Device device = DeviceOfNetworks(networks, request.device, listener);
  const int64_t free = FreeBytes(device);
  const auto generator = networks.LoadViewGenerator({request.files, request.options, device, free});
  ViewRequest wanted;
  wanted.views = &request.views;
  for (const Target& target : request.targets) wanted.targets.push_back(target.camera);
  wanted.workspace = request.proposals / kChunks;
  wanted.key = request.key;
  const auto images = generator->Generate(wanted, listener);
  RemoveGenerated(request.proposals);
  for (size_t t = 0; t < images.size(); ++t) {
    for (size_t k = 0; k < images[t].size(); ++k) {
      const fs::path folder = request.proposals / SevaSource(static_cast<int>(k));
      WritePng(folder / (request.targets[t].name + ".png"), ToImage8(images[t][k]));
    }
  }
}

void RemoveGenerated(const fs::path& proposals) {
  std::error_code ignored;
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(proposals, ignored)) {
    if (IsSource(entry.path().filename().string())) folders.push_back(entry.path());
  }
  for (const fs::path& folder : folders) fs::remove_all(folder, ignored);
}

void RemoveChunks(const fs::path& proposals) {
  std::error_code ignored;
  fs::remove_all(proposals / kChunks, ignored);
}

}  // namespace oraclegs
