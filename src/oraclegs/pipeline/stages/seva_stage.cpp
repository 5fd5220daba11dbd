#include "oraclegs/pipeline/stages/seva_stage.h"

#include "oraclegs/weights/folder.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/pipeline/workspace/fingerprint.h"

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

SevaFiles FindSevaFiles() {
  return {{FindModel(kSevaModels[0])}, FindModel(kSevaModels[1]), FindModel(kSevaModels[2])};
}

std::string SevaKey(const RunOptions& options) {
  const SevaFiles files = FindSevaFiles();
  nlohmann::json json = OptionsToJson(options.seva);
  for (const char* name : {"seva-halves", "seva-memory"}) json.erase(name);  // how it fits into memory
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

void GenerateViews(const Run& run, const SevaViews& views) {
  const SevaOptions& options = run.options.seva;
  const torch::Device device = ChooseDevice(run.options.device.device, ProbeDevices());
  const int64_t free = FreeBytes(device);
  const SevaModel model(FindSevaFiles(), {device, SevaPrecision(options.precision)});
  SevaNetworks networks = model.networks();
  networks.free_bytes = free;
  SevaRequest request;
  request.photographs = &views.photos;
  for (const Target& target : views.targets) request.targets.push_back(target.camera);
  request.workspace = run.workspace.proposals() / kChunks;
  request.key = views.key;
  const auto pictures = SevaGenerator(networks, options, run.listener).Generate(request);
  RemoveGenerated(run.workspace.proposals());
  for (size_t t = 0; t < pictures.size(); ++t) {
    for (size_t k = 0; k < pictures[t].size(); ++k) {
      const fs::path folder = run.workspace.proposals() / SevaSource(static_cast<int>(k));
      WritePng(folder / (views.targets[t].name + ".png"), ToImage8(pictures[t][k]));
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

std::optional<Proposal> SevaProposer::Propose(const Target& target, int hidden) const {
  if (hidden >= 0) return std::nullopt;
  const fs::path path = folder_ / (target.name + ".png");
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return std::nullopt;
  Proposal proposal{target.name, source_, target.camera, ToFloat(ReadImage(path))};
  const ImageF& rgb = proposal.rgb;
  if (rgb.width != target.camera.width || rgb.height != target.camera.height || rgb.channels != 3) {
    throw InputError("{}: is {} x {} with {} channels, not {} x {} with 3; delete it and run again", path.string(),
                     rgb.width, rgb.height, rgb.channels, target.camera.width, target.camera.height);
  }
  return proposal;
}

}  // namespace oraclegs
