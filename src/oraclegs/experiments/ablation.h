#pragma once
// Trains one scene several times, each time with one more part of the program.

#include <string>
#include <vector>

#include "oraclegs/experiments/ablation_report.h"
#include "oraclegs/run/start.h"

namespace oraclegs {

enum class Comparison { kParts, kTampering };
template <>
struct EnumWords<Comparison> {
  static constexpr EnumWord<Comparison> kWords[] = {{Comparison::kParts, "parts"},
                                                    {Comparison::kTampering, "tampering"}};
};

struct AblateOptions {
  int seeds = 3;
  std::string rows;
  Comparison compare = Comparison::kParts;
  std::string shares = {};
  std::string also = {};
  std::string suite = {};
  bool dry_run = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("compare", self.compare,
          "What is compared: parts = one part of the program more in each row; tampering = how far the oracle protects "
          "the result from proposals that lie in places: trainings without proposals and on proposals of which a share "
          "of the pixels is tampered with, all pixels trusted alike, as the oracle says, and as an ideal oracle would");
    visit("seeds", self.seeds, "Trainings of each row, of seeds --seed, --seed + 1, ...", Range{1, 1000});
    visit("also", self.also,
          "Of --compare parts: more scenes, separated by commas; each is trained alike in a folder of its own below "
          "--out, "
          "and the table is the mean over all scenes");
    visit(
        "suite", self.suite,
        "Of --compare parts: all scenes of mipnerf360, blender, llff or dtu, which lie in the folder that is given in "
        "place of a scene, at each number of views that papers report, or --views, side by side; --preset paper "
        "stands for the paper's settings of each");
    visit("dry-run", self.dry_run, "Of --compare parts: print the command of each training; run nothing");
    visit("shares", self.shares,
          "Of --compare tampering: tampered pixels in per cent, whole numbers separated by commas; 100 = everything; "
          "0,10,30,50,100 unless given");
    visit("rows", self.rows,
          "Of --compare parts: rows to train, by number or name, separated by commas: mcmc, union, schedule, lpips "
          "(with its weights only), sfm, depth and confidence, which are the paper's, then dense, regularizers, "
          "calibration, proxies; all unless given");
  }
};

struct AblationRequest {
  RunRequest run;  ///< its options hold for every row, except those that rows are about
  AblateOptions options;
  std::string command;  ///< as typed, for the report
};

/// Trains the rows of ablation_rows.h seed after seed, each in a workspace of its own, out/rows/NN-NAME/seed-S. Runs of
/// one scene share structure from motion, depth and proposals where their options allow. Rewrites out/ablation.json and
/// out/ablation.md after each run; a second call continues where the first was stopped. options.also is ignored, see
/// RunScenes (ablation_suite.h). Reports "row 4 of 10 ..." and the time left. A row that fails is a warning and the
/// others go on; the first failure is thrown when nothing was scored at all. Throws UsageError for contradicting
/// options or another suite; InputError when the scene cannot be read, when the row of LPIPS is asked for without its
/// weights, or when `out` holds something else; Interrupted.
Ablation RunAblation(const AblationRequest& request, const Listener& listener);

/// Commands that train what RunAblation would, quoted for a shell, a line each. Throws as that does before it runs.
std::string AblationCommands(const AblationRequest& request);

/// Seconds that the runs `left` (given by their rows) will take, when a run of row r took known[r] seconds. 0 = not
/// known: the mean of the known ones is assumed. Returns 0 when nothing is known.
double SecondsLeft(const std::vector<double>& known, const std::vector<size_t>& left);

}  // namespace oraclegs
