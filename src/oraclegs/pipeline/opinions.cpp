#include "oraclegs/pipeline/opinions.h"

#include <algorithm>

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/pipeline/start_points.h"
#include "oraclegs/pipeline/train_inputs.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {
namespace {

constexpr size_t kFewestPhotographs = 3;  // left after leaving some out: two show a surface, one is hidden

template <class T>
std::vector<T> Without(const std::vector<T>& all, const std::vector<int>& left_out) {
  std::vector<T> rest;
  for (size_t v = 0; v < all.size(); ++v) {
    if (std::find(left_out.begin(), left_out.end(), static_cast<int>(v)) == left_out.end()) rest.push_back(all[v]);
  }
  return rest;
}

/// The trainer's progress as part of the stage that trains several.
Listener Counted(const Listener& listener, int64_t before, int64_t total) {
  return [=](const Event& event) {
    if (const auto* step = std::get_if<StepDone>(&event)) {
      listener(StepDone{"propose", before + step->done, total, "iterations of quick models", step->detail});
    } else if (!std::holds_alternative<Note>(event)) {
      listener(event);
    }
  };
}

}  // namespace

TrainOptions OpinionOptions(const RunOptions& options, TrainOptions decided) {
  const double share = options.propose.opinion_share;
  const auto scaled = [&](int iterations) { return std::max(1, static_cast<int>(share * iterations)); };
  decided.iterations = scaled(decided.iterations);
  decided.sh_degree_interval = scaled(decided.sh_degree_interval);
  decided.refine_start = scaled(decided.refine_start);
  decided.max_gaussians = std::min(decided.max_gaussians, options.propose.opinion_gaussians);
  // Nothing that concerns proposals reaches a quick model: other values of these ask for no new ones.
  const TrainOptions unused;
  decided.schedule = "none";
  decided.synthetic_floor = unused.synthetic_floor, decided.synthetic_peak = unused.synthetic_peak;
  decided.proposal_weight = unused.proposal_weight, decided.proposal_ssim = unused.proposal_ssim;
  decided.proposal_lpips = unused.proposal_lpips;
  decided.confidence_gate = unused.confidence_gate, decided.confidence_power = unused.confidence_power;
  return decided;
}

std::vector<Opinion> TrainOpinions(Run* run, const std::vector<Photo>& photos, const Geometry& geometry,
                                   const TrainOptions& options, const std::string& key) {
  const int wanted = run->options.propose.opinions, n = std::min<int>(wanted, static_cast<int>(photos.size()));
  const std::vector<TrainView> views = TrainViews(photos, geometry);
  const StartOptions& start = run->options.start;
  std::vector<Opinion> opinions;
  for (int k = 0; k < n; ++k) {
    const std::vector<int> left_out = LeftOut(static_cast<int>(photos.size()), n, k);
    const std::string stage = fmt::format("opinion {}", k), file = fmt::format("proposals/opinions/{}.ply", k);
    const auto path = run->workspace.root() / file;
    if (!run->workspace.IsDone(stage, key)) {
      run->workspace.MarkUndone(stage);
      const std::vector<TrainView> kept = Without(views, left_out);
      const std::vector<Photo> shown = Without(photos, left_out);
      Geometry rest;
      rest.maps = Without(geometry.maps, left_out);
      rest.gains = Without(geometry.gains, left_out);
      rest.points = FuseDepth(rest.maps, shown, FusionOf(rest.gains));
      if (kept.size() < kFewestPhotographs || rest.points.size() < kPlentyOfPoints) {
        run->listener(
            Warning{fmt::format("no quick models for --proposers splat: one would have {} photographs and {} dense "
                                "points, and needs {} and "
                                "{}; photographs are warped instead",
                                kept.size(), rest.points.size(), kFewestPhotographs, kPlentyOfPoints)});
        return {};
      }
      const PointCloud cloud = DenseStart(start, shown, rest, static_cast<size_t>(options.max_gaussians));
      Trainer trainer(
          options, start.seed + static_cast<uint64_t>(k), BackgroundColor(run->options.photo.background), kept,
          InitializeGaussians(
              cloud, {start.init_scale > 0 ? start.init_scale : kDenseScale, start.init_opacity, start.init_flatness}));
      const auto result =
          trainer.Run({}, Counted(run->listener, int64_t{k} * options.iterations, int64_t{n} * options.iterations));
      WriteGaussianPly(path, trainer.gaussians(), options.sh_degree);
      run->workspace.MarkDone(stage, {{"key", key}, {"seconds", result.seconds}, {"files", {file}}});
    }
    opinions.push_back({ReadGaussianPly(path).gaussians, left_out});
  }
  return opinions;
}

}  // namespace oraclegs
