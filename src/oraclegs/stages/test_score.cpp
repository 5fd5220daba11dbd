#include "oraclegs/stages/test_score.h"

#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

TestScore TestScoreOf(const Run& run) {
  const int64_t every = run.options.checkpoints.eval_every;
  if (every == 0) return {};
  if (run.split.test.empty()) {
    run.listener(Warning{"--eval-every: there are no test views; train.csv has no PSNR"});
    return {};
  }
  const auto views =
      std::make_shared<const std::vector<LoadedView>>(LoadViews(run.scene, run.split.test, run.plan.image, Silent()));
  RenderOptions render;
  render.background = BackgroundColor(run.options.image.background);
  render.antialiased = run.options.train.antialiased;
  return {every, [=](const Gaussians& gaussians) { return MeanPsnr(gaussians, *views, render); }};
}

}  // namespace oraclegs
