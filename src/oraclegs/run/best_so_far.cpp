#include "oraclegs/run/best_so_far.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/output/live/live.h"
#include "oraclegs/output/report/run_document.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/stage_works.h"
#include "oraclegs/train/checkpoint.h"
#include "oraclegs/train/checkpoint_folder.h"
#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {
namespace {

/// Lets work go on after a stop was asked for; asked again, the process ends at once (core/interrupt.h).
class InterruptPause {
 public:
  InterruptPause() { RequestInterrupt(false); }
  ~InterruptPause() {
    if (was_requested_) RequestInterrupt(true);  // else a caller of the library ended the run, and may begin another
  }
  InterruptPause(const InterruptPause&) = delete;
  InterruptPause& operator=(const InterruptPause&) = delete;

 private:
  bool was_requested_ = InterruptRequested();
};

enum class Worth { kNothing, kPoints, kDensePoints, kDraftModel, kBegunTraining, kLowerQuality, kHalfTrained, kResult };

struct Best {
  std::string of;
  Gaussians gaussians;
  Worth worth = Worth::kNothing;
};

Worth WorthOfTraining(int64_t iteration, int64_t total) {
  if (10 * iteration < total) return Worth::kDensePoints;  // hardly more than its start
  return 2 * iteration < total ? Worth::kBegunTraining : Worth::kHalfTrained;
}

Best FromCheckpoint(const Run& run) {
  for (const auto& path : FindCheckpoints(run.workspace.checkpoints())) {
    try {
      Checkpoint checkpoint = ReadCheckpoint(path);
      const int64_t total = run.options.train.iterations.value();
      return {fmt::format("model after {} of {} iterations", checkpoint.iteration, total),
              std::move(checkpoint.gaussians), WorthOfTraining(checkpoint.iteration, total)};
    } catch (const InputError&) {  // is said when the run goes on
    }
  }
  return {};
}

Best BestOf(const Run& run) {
  if (Best trained = FromCheckpoint(run); trained.worth != Worth::kNothing) return trained;
  constexpr std::array<std::pair<const char*, Worth>, 3> kStages = {
      {{"proxies", Worth::kDraftModel}, {"depth", Worth::kDensePoints}, {"sfm", Worth::kPoints}}};
  for (const auto& [stage, worth] : kStages) {
    EarlySplat early = EarlySplatOf(run, stage);
    if (early.gaussians.size() > 0) return {early.of, std::move(early.gaussians), worth};
  }
  return {};
}

Worth WorthOfSplat(const Run& run) {
  std::error_code ignored;
  if (!std::filesystem::exists(run.workspace.point_cloud(), ignored)) return Worth::kNothing;
  const nlohmann::json record = run.workspace.Record(kBestSoFar);
  if (!record.is_object()) return Worth::kResult;
  return static_cast<Worth>(record.value("worth", static_cast<int>(Worth::kLowerQuality)));
}

void Write(Run* run) {
  const WorkspacePaths& paths = run->workspace;
  const Best best = BestOf(*run);
  if (best.worth != Worth::kNothing && best.worth >= WorthOfSplat(*run)) {
    WriteSplat(*run, best.gaussians, {});
    run->workspace.MarkDone(kBestSoFar, {{"of", best.of}, {"worth", static_cast<int>(best.worth)}});
  }
  const std::string of = UnfinishedSplat(paths.root());
  if (of.empty()) return;
  run->listener(Note{fmt::format("{} is the {}, the best so far", paths.point_cloud().string(), of)});
  if (!run->options.report.report) return;
  WriteReport(run, LoadModel(paths.point_cloud(), run->options, run->plan.device, run->frame), {});
}

}  // namespace

void LeaveBestSoFar(Run* run) {
  const InterruptPause pause;
  try {
    Write(run);
  } catch (const std::exception& error) {  // the stop is what the user asked for
    run->listener(Warning{fmt::format("{}; the run leaves no splat of what it has so far", error.what())});
  }
}

}  // namespace oraclegs
