#include "oraclegs/experiments/launch/make_launcher.h"

#include <algorithm>
#include <cstdlib>

#include "oraclegs/core/text.h"
#include "oraclegs/experiments/launch/slurm_launcher.h"

namespace oraclegs {
namespace {

LocalWorkers WorkersHere(const LaunchOptions& options) {
  const char* visible = std::getenv("CUDA_VISIBLE_DEVICES");
  return WorkersFor(options, ProbeDevices(), visible ? visible : "");
}

}  // namespace

LocalWorkers WorkersFor(const LaunchOptions& options, const DeviceSupport& support, const std::string& visible) {
  LocalWorkers workers;
  const bool on_any_gpu =
      ChooseDevice(options.device, support).is_cuda() && options.device.find(':') == std::string::npos;
  if (on_any_gpu) {
    workers.gpus = SplitTrimmed(visible, ',');
    for (int gpu = 0; visible.empty() && gpu < support.devices; ++gpu) workers.gpus.push_back(std::to_string(gpu));
  }
  workers.count = options.workers.ValueOr(std::max(1, static_cast<int>(workers.gpus.size())));
  return workers;
}

int LocalWorkerCount(const LaunchOptions& options) {
  return options.workers.is_auto() ? WorkersHere(options).count : options.workers.value();
}

std::unique_ptr<Launcher> MakeLauncher(LauncherKind kind, const LaunchOptions& options) {
  if (kind == LauncherKind::kSlurm) return MakeSlurmLauncher(options.slurm, options.slurm_folder);
  return std::make_unique<LocalLauncher>(WorkersHere(options));
}

}  // namespace oraclegs
