#pragma once
// Plan of a benchmark: all runs, before any is started.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "oraclegs/core/options.h"
#include "oraclegs/experiments/bench/methods.h"
#include "oraclegs/experiments/bench/scene_check.h"
#include "oraclegs/experiments/launch/make_launcher.h"

namespace oraclegs {

struct BenchOptions {
  std::string suite;
  std::filesystem::path data;
  std::string methods = "ours,3dgs-mcmc";
  std::string views;
  int seeds = 3;
  bool dry_run = false;
  LauncherKind launcher = LauncherKind::kLocal;
  Auto<int> workers;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("suite", self.suite,
          "What is measured: mipnerf360, blender, llff or dtu, each with the images, sizes and test views that papers "
          "score; or a folder, each subfolder of which is a scene, or which is a scene itself");
    visit("data", self.data, "Folder with the scenes of a named suite, or with the folder that holds them");
    visit(
        "methods", self.methods,
        "What is compared, separated by commas: ours, ours-no-proposals (trained on the photos alone), paper (the "
        "OracleGS paper's settings for the suite and its number of views), and methods of others (docs/baselines.md): "
        "3dgs, 3dgs-mcmc, 3dgs-mcmc-random, dropgaussian, fsgs, cor-gs, dngaussian, sparsegs, comapgs");
    visit("views", self.views,
          "Numbers of training views, separated by commas; unless given, those that papers report: 12,24 for "
          "mipnerf360, 8 for blender, 3,6,9 for llff and dtu, all but every 8th for a folder");
    visit("seeds", self.seeds, "Runs of each scene, number of views and method, of seeds --seed, --seed + 1, ...",
          Range{1, 1000});
    visit("dry-run", self.dry_run, "Print which images train and test, their size, and each command; run nothing");
    visit("launcher", self.launcher, "Where the runs happen: local = this machine; slurm = a cluster's queue");
    visit("workers", self.workers, "Runs at once on this machine; auto = one for each GPU, else 1", Range{1, 1024});
  }
};

struct BenchRequest {
  BenchOptions options;
  RunArguments asked;  ///< options of all runs, as the user gave them; a method's own options win
  /// The user's preset, over which `asked` wins: its images and their size for all runs, the rest for those of this
  /// program's own methods.
  RunArguments preset;
  std::function<RunArguments(const std::string& name)> read_preset;  ///< throws UsageError where there is none
  uint64_t first_seed = 0;
  std::filesystem::path out;
  bool overwrite = false;
  std::string command;            ///< as typed, for the report
  std::string version;            ///< version and commit of the program
  std::filesystem::path program;  ///< executable whose `reconstruct` it runs
  int workers = 1;                ///< runs at once; 0 = not known, as in a cluster's queue
};

struct BenchRun {
  size_t check = 0, method = 0;  ///< indices into BenchPlan
  uint64_t seed = 0;
  std::string name = {};        ///< SUITE-SCENE-VIEWS-METHOD-seedS; also the name of its workspace
  RunArguments arguments = {};  ///< with --seed
};

struct BenchPlan {
  Suite suite;
  std::vector<Method> methods;
  std::vector<uint64_t> seeds;
  std::vector<int> views;
  std::vector<SceneCheck> checks;  ///< scene by scene, for each number of views
  std::vector<BenchRun> runs;      ///< includes scenes that cannot be run
  bool keeps_protocol = false;     ///< true for a named suite whose protocol no option changes
};

/// Reads all scenes. Throws UsageError for an unknown suite, method or number of views, a number of views that the
/// preset or, where they are a method, the paper's settings do not have, or a list of training images for several
/// numbers of views; InputError, with the first problem, when no scene exists or none can be run.
BenchPlan PlanBench(const BenchRequest& request);

std::filesystem::path WorkspaceOf(const BenchRequest& request, const BenchRun& run);

/// Command line (argv) of a run.
std::vector<std::string> CommandOf(const BenchRequest& request, const BenchPlan& plan, const BenchRun& run);

/// Output of --dry-run: protocol, images and sizes, LPIPS, and the commands quoted for a shell.
std::string PlanText(const BenchRequest& request, const BenchPlan& plan);

}  // namespace oraclegs
