#pragma once
// Has processes of this machine's devices or of a cluster's machines make parts of a run's stages.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "oraclegs/core/options.h"
#include "oraclegs/experiments/launch/make_launcher.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

struct SpreadOptions {
  int spread = 1;
  LauncherKind launcher = LauncherKind::kLocal;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit(
        "spread", self.spread,
        "Divide proxy models, proposals and validation among so many processes, each with a GPU of its own where there "
        "are enough; results are the same; 1 = this process does all",
        Range{1, 1024});
    visit("launcher", self.launcher,
          "Of --spread: where the processes run: local = this machine; slurm = a cluster's queue, whose machines must "
          "see photos and workspace under the same paths");
  }
};

struct SpreadRequest {
  SpreadOptions options;
  std::string device = "auto";    ///< of the processes
  int threads = 0;                ///< of each; 0 = the cores of this machine are divided
  std::filesystem::path program;  ///< oraclegs, whose command `share` they run
};

using LauncherMaker = std::function<std::unique_ptr<Launcher>(LauncherKind kind, const LaunchOptions& options)>;

/// For RunRequest::spread; empty where nothing is to be divided. Logs are kept in OUT/parts/logs. A process that fails
/// is a warning: the run's own process makes its parts. slurm: of --launcher slurm.
std::function<void(Run*, const StageParts&)> SpreadBy(const SpreadRequest& request, const SlurmOptions& slurm,
                                                      const LauncherMaker& make_launcher = MakeLauncher);

}  // namespace oraclegs
