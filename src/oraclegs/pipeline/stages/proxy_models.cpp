#include "oraclegs/pipeline/stages/proxy_models.h"

#include <algorithm>
#include <optional>

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/pipeline/stages/start_points.h"
#include "oraclegs/pipeline/stages/train_inputs.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kFewestPhotographs = 3;  // left after leaving some out: two show a surface, one is hidden

template <class T>
std::vector<T> Without(const std::vector<T>& all, const std::vector<int>& left_out) {
  std::vector<T> rest;
  for (size_t v = 0; v < all.size(); ++v) {
    if (std::find(left_out.begin(), left_out.end(), static_cast<int>(v)) == left_out.end()) rest.push_back(all[v]);
  }
  return rest;
}

/// A trainer's progress after `before` other iterations of the same model.
Listener Counted(const Listener& listener, int64_t before) {
  return [=](const Event& event) {
    if (const auto* step = std::get_if<StepDone>(&event)) {
      StepDone counted = *step;
      counted.done += before;
      listener(counted);
    } else {
      listener(event);
    }
  };
}

/// A trainer's progress as part of the stage that trains several.
Listener AsPropose(const Listener& listener, int64_t before, int64_t total) {
  return [=](const Event& event) {
    if (const auto* step = std::get_if<StepDone>(&event)) {
      listener(StepDone{"propose", before + step->done, total, "iterations of quick models", step->detail});
    } else if (!std::holds_alternative<Note>(event)) {
      listener(event);
    }
  };
}

/// What follows with all photographs: of Gaussians that have found their places and colours.
TrainOptions FinishOptions(const RunOptions& options, TrainOptions opinion) {
  opinion.iterations = static_cast<int>(options.propose.opinion_finish * options.train.iterations);
  opinion.sh_degree_interval = 1;
  opinion.refine_start = 0;
  return opinion;
}

/// One quick model to be trained: without `left_out` first.
struct Task {
  const TrainOptions& options;
  const TrainOptions& finish;
  int number = 0;
  std::vector<int> left_out;
  fs::path before, path;  ///< the models' files
};

/// What stereo knows of the photographs that are not left out.
Geometry GeometryWithout(const Geometry& all, const std::vector<LoadedView>& shown, const std::vector<int>& left_out) {
  Geometry rest;
  rest.maps = Without(all.maps, left_out);
  rest.gains = Without(all.gains, left_out);
  rest.points = FuseDepth(rest.maps, shown, FusionOf(rest.gains));
  return rest;
}

/// Trains it and writes its files; the seconds it took, or nothing, with a warning, where too little is left.
std::optional<double> TrainOpinion(const Run& run, const std::vector<LoadedView>& photos, const Geometry& geometry,
                                   const Task& task, const Listener& listener) {
  const StartOptions& start = run.options.start;
  const std::vector<TrainView> views = TrainViews(photos, geometry), kept = Without(views, task.left_out);
  const std::vector<LoadedView> shown = Without(photos, task.left_out);
  const Geometry rest = GeometryWithout(geometry, shown, task.left_out);
  if (kept.size() < kFewestPhotographs || rest.points.size() < kPlentyOfPoints) {
    run.listener(
        Warning{fmt::format("no quick models for --proposers splat: one would have {} photographs and {} dense points, "
                            "and needs {} and {}; photographs are warped instead",
                            kept.size(), rest.points.size(), kFewestPhotographs, kPlentyOfPoints)});
    return std::nullopt;
  }
  const PointCloud cloud = DenseStart(start, shown, rest, static_cast<size_t>(task.options.max_gaussians));
  const InitializeOptions init{start.init_scale > 0 ? start.init_scale : kDenseScale, start.init_opacity,
                               start.init_flatness};
  const uint64_t seed = start.seed + static_cast<uint64_t>(task.number);
  const auto background = BackgroundColor(run.options.photo.background);
  Trainer trainer(task.options, seed, background, kept, InitializeGaussians(cloud, init));
  double seconds = trainer.Run({}, listener).seconds;
  WriteGaussianPly(task.before, trainer.gaussians(), task.options.sh_degree);
  if (task.finish.iterations == 0) {
    WriteGaussianPly(task.path, trainer.gaussians(), task.options.sh_degree);
    return seconds;
  }
  Trainer finisher(task.finish, seed, background, views, trainer.gaussians());
  seconds += finisher.Run({}, Counted(listener, task.options.iterations)).seconds;
  WriteGaussianPly(task.path, finisher.gaussians(), task.finish.sh_degree);
  return seconds;
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

std::vector<ProxyModel> TrainOpinions(Run* run, const std::vector<LoadedView>& photos, const Geometry& geometry,
                                   const TrainOptions& options, const std::string& key) {
  const int wanted = run->options.propose.opinions, n = std::min<int>(wanted, static_cast<int>(photos.size()));
  const TrainOptions finish = FinishOptions(run->options, options);
  const int64_t each = options.iterations + finish.iterations;
  std::vector<ProxyModel> opinions;
  for (int k = 0; k < n; ++k) {
    const std::string stage = fmt::format("opinion {}", k), before = fmt::format("proposals/opinions/{}_before.ply", k),
                      file = fmt::format("proposals/opinions/{}.ply", k);
    const Task task{options,
                    finish,
                    k,
                    LeftOut(static_cast<int>(photos.size()), n, k),
                    run->workspace.root() / before,
                    run->workspace.root() / file};
    if (!run->workspace.IsDone(stage, key)) {
      run->workspace.MarkUndone(stage);
      const auto seconds = TrainOpinion(*run, photos, geometry, task, AsPropose(run->listener, k * each, n * each));
      if (!seconds) return {};
      run->workspace.MarkDone(stage, {{"key", key}, {"seconds", *seconds}, {"files", {before, file}}});
    }
    opinions.push_back({ReadGaussianPly(task.before).gaussians, ReadGaussianPly(task.path).gaussians, task.left_out});
  }
  return opinions;
}

}  // namespace oraclegs
