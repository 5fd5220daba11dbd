#pragma once
// The launchers there are, by their names.

#include <memory>
#include <string>

#include "oraclegs/core/options.h"
#include "oraclegs/experiments/launch/launcher.h"
#include "oraclegs/experiments/launch/local_launcher.h"
#include "oraclegs/experiments/launch/slurm_options.h"
#include "oraclegs/settings/device.h"

namespace oraclegs {

enum class LauncherKind { kLocal, kSlurm };
template <>
struct EnumWords<LauncherKind> {
  static constexpr EnumWord<LauncherKind> kWords[] = {{LauncherKind::kLocal, "local"}, {LauncherKind::kSlurm, "slurm"}};
};

struct LaunchOptions {
  Auto<int> workers = {};       ///< jobs at once; auto = one for each GPU, else one
  std::string device = "auto";  ///< of the jobs, as ChooseDevice reads it
  SlurmOptions slurm = {};
  std::filesystem::path slurm_folder = {};  ///< what MakeSlurmLauncher keeps
};

/// Throws UsageError for a device that cannot be had.
std::unique_ptr<Launcher> MakeLauncher(LauncherKind kind, const LaunchOptions& options);

/// Jobs at once of MakeLauncher's local launcher. Throws UsageError for a device that cannot be had, where the number
/// depends on it.
int LocalWorkerCount(const LaunchOptions& options);

/// Workers for jobs on such a device, of a machine with these GPUs: each has one GPU where any will do. `visible` is
/// the value of CUDA_VISIBLE_DEVICES, "" = not set.
LocalWorkers WorkersFor(const LaunchOptions& options, const DeviceSupport& support, const std::string& visible);

}  // namespace oraclegs
