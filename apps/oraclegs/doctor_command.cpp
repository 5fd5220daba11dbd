#include <filesystem>
#include <nlohmann/json.hpp>

#include "command.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/machine.h"
#include "oraclegs/core/text.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/weights/folder.h"
#include "oraclegs/weights/registry.h"
#include "version.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr double kGigabyte = 1e9;
constexpr double kMinFreeMemory = 2e9, kMinFreeDisk = 2e9;  // bytes: less is too little for a run at the defaults

struct DoctorOptions {
  bool json = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("json", self.json, "Print JSON instead of lines");
  }
};

/// Something that this machine has or lacks.
struct Finding {
  std::string name, found;
  bool here = true;
  std::string needed_for = {}, advice = {};  ///< where it is not here
};

Finding Processor() {
  const std::string name = ProcessorName();
  return {"processor", (name.empty() ? "" : name + ": ") + InstructionSetsText()};
}

Finding Memory() {
  const auto all = static_cast<double>(TotalMemory()), free = static_cast<double>(AvailableMemory());
  return {"memory", fmt::format("{:.1f} GB, {:.1f} GB of it free", all / kGigabyte, free / kGigabyte),
          free == 0 || free >= kMinFreeMemory, "larger scenes",
          "end other programs, or use smaller images and fewer Gaussians (--downscale 4 --max-gaussians 50000)"};
}

Finding Disk() {
  std::error_code unknown;
  const fs::path here = fs::current_path(unknown);
  const fs::space_info space = fs::space(here, unknown);
  if (unknown) return {"disk", "not known"};
  const auto free = static_cast<double>(space.available);
  return {"disk", fmt::format("{:.1f} GB free at {}", free / kGigabyte, OneLine(here.string())), free >= kMinFreeDisk,
          "results", "free some, or name a workspace on another disk (-o)"};
}

Finding Gpu() {
  const DeviceSupport support = ProbeDevices();
  const NvidiaGpus gpus = FindNvidiaGpus();
  std::string found = fmt::format("{}", fmt::join(gpus.models, ", "));
  if (!gpus.driver.empty()) found += (found.empty() ? "" : ", ") + fmt::format("driver {}", gpus.driver);
  const std::string faster = "training several times as fast; without it the CPU computes";
  if (support.devices > 0) {
    return {"gpu", found.empty() ? Counted(support.devices, "NVIDIA GPU") : found};
  }
  if (!support.driver) {
    return {"gpu", "no NVIDIA GPU with a driver", false, faster, "where there is a GPU, install NVIDIA's driver"};
  }
  if (found.empty()) found = "a driver";
  if (!support.has_library) {
    return {"gpu", found + ": not used", false, faster,
            "install the package oraclegs-cuda, or build with -DORACLEGS_CUDA=ON"};
  }
  if (!support.no_library.empty()) {
    return {"gpu", found + ": " + support.no_library, false, faster, "install both packages of one version"};
  }
  return {"gpu", found + ": does not answer", false, faster, "update the driver, and see what nvidia-smi says"};
}

Finding Colmap() {
  const std::optional<std::string> version = ColmapVersion();
  return {"colmap", version.value_or("not found"), version.has_value(), "photos whose cameras are not known",
          "apt install colmap"};
}

Finding Ffmpeg() {
  const std::optional<std::string> version = FfmpegVersion();
  const bool reads = !FindProgram("ffprobe").empty();
  return {"ffmpeg", version.value_or("not found") + (version && !reads ? ", without ffprobe" : ""), version && reads,
          "photos out of videos, and videos of the result", "apt install ffmpeg"};
}

Finding NetworksLibrary() {
  const std::string why = WhyNoNetworks();
  return {"networks", why.empty() ? "liboraclegs_networks.so" : why, why.empty(),
          "Depth Anything, VGGT, Stable Virtual Camera, LPIPS; without them it does what needs no network",
          "install the package oraclegs-networks, or build with libtorch"};
}

Finding Weights() {
  Finding finding{"weights", "", true, "the networks", "see `oraclegs models list`"};
  try {
    std::vector<std::string> here;
    for (const WeightsInfo& model : AllWeights()) {
      if (LocateWeights(model.name)) here.push_back(model.name);
    }
    finding.here = !here.empty();
    finding.found = finding.here ? fmt::format("{}", fmt::join(here, ", "))
                                 : fmt::format("none in {}", OneLine(WeightsFolder().string()));
  } catch (const UsageError& no_folder) {  // there is no home: the rest is worth knowing all the same
    finding.here = false;
    finding.found = no_folder.what();
  }
  return finding;
}

Finding Mesh() {
  const bool here = FindLibraryFile("liboraclegs_openvdb.so").has_value();
  return {"openvdb", here ? "liboraclegs_openvdb.so" : "not found", here, "oraclegs mesh",
          "install the whole package again, or build with OpenVDB"};
}

nlohmann::json ToJson(const std::vector<Finding>& findings) {
  nlohmann::json list = nlohmann::json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"name", finding.name}, {"found", finding.found}, {"here", finding.here}});
    if (!finding.here) list.back()["needed_for"] = finding.needed_for, list.back()["advice"] = finding.advice;
  }
  return {{"program", ProgramText()}, {"findings", std::move(list)}};
}

std::string Lines(const std::vector<Finding>& findings) {
  std::string text = ProgramText() + "\n";
  for (const Finding& finding : findings) {
    text += fmt::format("{:8} {:10} {}\n", finding.here ? "ok" : "missing", finding.name, finding.found);
    if (!finding.here) text += fmt::format("{:19} for {}\n{:19} {}\n", "", finding.needed_for, "", finding.advice);
  }
  return text;
}

class DoctorCommand : public Command {
 public:
  explicit DoctorCommand(CLI::App* app)
      : Command(app, "doctor", "Say what this machine has, what is missing for what, and how to get it",
                "oraclegs doctor\n  oraclegs doctor --json > machine.json") {
    Bind("Output", &options_);
  }

 private:
  void Body(const Listener&) override {
    const std::vector<Finding> findings = {Processor(), Memory(),          Disk(),    Gpu(), Colmap(),
                                           Ffmpeg(),    NetworksLibrary(), Weights(), Mesh()};
    // It was asked for: also with --quiet.
    WriteOut(options_.json ? ToJson(findings).dump(2, ' ', true, nlohmann::json::error_handler_t::replace) + "\n"
                           : Lines(findings));
  }

  DoctorOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeDoctor(CLI::App* app) { return std::make_unique<DoctorCommand>(app); }

}  // namespace oraclegs
