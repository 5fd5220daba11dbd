#pragma once
// Launchers by their names.

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
  std::string device = "auto";  ///< device of the jobs, as ChooseDevice reads it
  SlurmOptions slurm = {};
  std::filesystem::path slurm_folder = {};  ///< folder of MakeSlurmLauncher's files
};

/// Throws UsageError for a device that does not exist.
std::unique_ptr<Launcher> MakeLauncher(LauncherKind kind, const LaunchOptions& options);

/// Number of jobs at once of MakeLauncher's local launcher. Throws UsageError for a device that does not exist, where
/// the number depends on it.
int LocalWorkerCount(const LaunchOptions& options);

/// Workers of a machine with these GPUs, for jobs on such a device. Each worker has one GPU where any will do.
/// `visible` is the value of CUDA_VISIBLE_DEVICES, "" = not set.
LocalWorkers WorkersFor(const LaunchOptions& options, const DeviceSupport& support, const std::string& visible);

}  // namespace oraclegs
