#include "oraclegs/run/stages.h"

#include <algorithm>

#include "oraclegs/core/host.h"
#include "oraclegs/core/text.h"
#include "oraclegs/run/needed_photos.h"
#include "oraclegs/run/time_estimate.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {
namespace {

constexpr size_t kViewsForCoverage = 3;
constexpr double kBesideObject = 0.05;  // of the pixels, where an object's edges and stray Gaussians take time

/// Share of the pixels of a Blender scene's images that show its object: their plain background costs little.
double CoveredShare(const Run& run, const std::vector<int>& views) {
  if (run.scene.format != SceneFormat::kBlender || views.empty()) return 1;
  double covered = 0, pixels = 0;
  for (size_t i = 0; i < std::min(kViewsForCoverage, views.size()); ++i) {
    const int view = views[i * views.size() / std::min(kViewsForCoverage, views.size())];
    for (const LoadedView& loaded : LoadViews(run.scene, {view}, run.plan.image, Silent())) {
      for (const float alpha : loaded.alpha) covered += static_cast<double>(alpha);
      if (loaded.alpha.empty()) covered += static_cast<double>(loaded.rgb.width) * loaded.rgb.height;
      pixels += static_cast<double>(loaded.rgb.width) * loaded.rgb.height;
    }
  }
  return std::min(1., covered / pixels + kBesideObject);
}

/// Warns only: the estimate is an upper bound, and more memory may become free.
void AnnounceMemory(int64_t needed, bool with_networks, const Listener& listener) {
  listener(Note{fmt::format("the run needs at most about {:.3g} GB of memory{}", Gigabytes(needed),
                            with_networks ? " beside its networks" : "")});
  const uint64_t available = AvailableMemory();
  if (available == 0 || static_cast<uint64_t>(needed) <= available) return;
  listener(Warning{fmt::format(
      "this run may need {:.1f} GB of memory, {:.1f} GB are available; close other programs, or lower --max-size or "
      "--max-gaussians",
      Gigabytes(needed), Gigabytes(static_cast<int64_t>(available)))});
}

}  // namespace

void AnnounceStages(Run* run) {
  const Split split = SplitOfRun(*run);
  const auto train = static_cast<int>(split.train.size()), test = static_cast<int>(split.test.size());
  const auto all = static_cast<int>(run->scene.views.size());
  const EstimateInput input{run->options,
                            SizeOf(run->scene, train),
                            run->photos.empty() ? 0 : all,
                            test,
                            all - train - test,
                            run->plan.device.is_cpu() ? CpuSlowness() : 0,
                            run->plan.refines_poses,
                            CoveredShare(*run, split.train)};
  RunPlanned planned;
  bool with_networks = false;
  for (const Stage& stage : *run->stages) {
    if (!stage.work.wanted(*run)) continue;
    const bool uses_network = stage.work.uses_network && stage.work.uses_network(*run);
    const bool known = run->plan.device.is_cpu() && !uses_network;
    with_networks |= uses_network;
    planned.stages.push_back({stage.name, known ? EstimateSeconds(stage, input) : 0});
    if (known) run->predicted[stage.name] = planned.stages.back().seconds;
  }
  run->listener(planned);
  if (run->plan.device.is_cpu()) AnnounceMemory(EstimateRunMemory(input), with_networks, run->listener);
}

}  // namespace oraclegs
