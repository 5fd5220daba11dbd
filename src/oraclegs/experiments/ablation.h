#pragma once
// One scene trained several times, each time with one part of the program more.

#include <string>
#include <vector>

#include "oraclegs/experiments/ablation_report.h"
#include "oraclegs/run/start.h"

namespace oraclegs {

/// What is compared.
enum class AblationSuite { kParts, kTampering };
template <>
struct EnumWords<AblationSuite> {
  static constexpr EnumWord<AblationSuite> kWords[] = {{AblationSuite::kParts, "parts"},
                                                       {AblationSuite::kTampering, "tampering"}};
};

struct AblateOptions {
  int seeds = 3;
  std::string rows;
  AblationSuite suite = AblationSuite::kParts;
  std::string shares = {};
  std::string also = {};

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("suite", self.suite,
          "What is compared: parts = one part of the program more in each row; tampering = how far the oracle protects "
          "the result from proposals that lie in places: trainings without proposals and on proposals of which a share "
          "of the pixels is tampered with, all pixels trusted alike, as the oracle says, and as an ideal oracle would");
    visit("seeds", self.seeds, "Trainings of each row, of seeds --seed, --seed + 1, ...", Range{1, 1000});
    visit(
        "also", self.also,
        "Of --suite parts: more scenes, separated by commas; each is trained alike in a folder of its own below --out, "
        "and the table is the mean over all scenes");
    visit("shares", self.shares,
          "Of --suite tampering: tampered pixels in per cent, whole numbers separated by commas; 100 = everything; "
          "0,10,30,50,100 unless given");
    visit("rows", self.rows,
          "Of --suite parts: rows to train, by number or name, separated by commas: mcmc, union, schedule, lpips "
          "(with its weights only), sfm, depth and confidence, which are the paper's, then dense, regularizers, "
          "calibration, proxies; all unless given");
  }
};

struct AblationRequest {
  RunRequest run;  ///< its options are those of every row, but for what rows are about
  AblateOptions options;
  std::string command;  ///< as it was typed, for the report
};

/// Trains the rows of ablation_rows.h seed after seed, each in a workspace of its own, out/rows/NN-NAME/seed-S; those
/// of one scene share structure from motion, depth and proposals where their options allow. Writes out/ablation.json
/// and out/ablation.md anew after each run (options.also is RunSuite's, ablation_suite.h); given again, it goes on
/// where it was stopped. Tells "row 4 of 10 ..." and the time that is left. A row that fails is a warning and the
/// others go on, but the first failure is thrown when nothing was scored at all. Throws UsageError for contradicting
/// options or another suite, InputError when the scene cannot be read, the row of LPIPS is asked for and its weights
/// are not there, or `out` holds something else, Interrupted.
Ablation RunAblation(const AblationRequest& request, const Listener& listener);

/// How long `left` runs, by their row, will take, where those of row r took known[r] seconds (0 = not known: as long as
/// the mean of the others). 0 when nothing is known.
double SecondsLeft(const std::vector<double>& known, const std::vector<size_t>& left);

}  // namespace oraclegs
