#include "oraclegs/pipeline/stages/proxy_models.h"

#include <algorithm>

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/pipeline/stages/start_points.h"
#include "oraclegs/pipeline/stages/train_inputs.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMinViewsOfProxy = 2;  // that show a surface

template <class T>
std::vector<T> Without(const std::vector<T>& all, const std::vector<int>& held_out) {
  std::vector<T> rest;
  for (size_t v = 0; v < all.size(); ++v) {
    if (std::find(held_out.begin(), held_out.end(), static_cast<int>(v)) == held_out.end()) rest.push_back(all[v]);
  }
  return rest;
}

/// A trainer's progress as part of the stage that trains several.
Listener AsProxies(const Listener& listener, int64_t before, int64_t total) {
  return [=](const Event& event) {
    if (const auto* step = std::get_if<StepDone>(&event)) {
      listener(StepDone{"proxies", before + step->done, total, "iterations of proxy models", step->detail});
    } else if (!std::holds_alternative<Note>(event)) {
      listener(event);
    }
  };
}

/// What follows with all views: of Gaussians that have found their places and colours.
TrainOptions FinishOptions(const RunOptions& options, TrainOptions proxy) {
  proxy.max_gaussians = options.train.max_gaussians;
  proxy.iterations = static_cast<int>(options.propose.proxy_finish * options.train.iterations);
  proxy.sh_degree_interval = 1;
  proxy.refine_start = 0;
  return proxy;
}

int Count(const Run& run) {
  return std::min(run.options.propose.proxy_models, static_cast<int>(run.split.train.size()));
}

/// Whether model k is trained with all views in the end.
bool GoesOn(const Run& run, int k) { return k < run.options.propose.proxy_finished; }

// Relative to the workspace.
std::string BeforeFile(int k) { return fmt::format("proposals/proxies/{}_before.ply", k); }
std::string FinishedFile(int k) { return fmt::format("proposals/proxies/{}.ply", k); }

std::vector<std::string> ProxyFiles(const Run& run, int k) {
  if (!GoesOn(run, k)) return {BeforeFile(k)};
  return {BeforeFile(k), FinishedFile(k)};
}

/// What stereo knows of the views that are not held out.
Geometry GeometryWithout(const Geometry& all, const std::vector<LoadedView>& shown, const std::vector<int>& held_out) {
  Geometry rest;
  rest.maps = Without(all.maps, held_out);
  rest.gains = Without(all.gains, held_out);
  rest.points = FuseDepth(rest.maps, shown, FusionOf(rest.gains));
  return rest;
}

/// Trains the models of one run.
class ProxyTrainer {
 public:
  explicit ProxyTrainer(Run* run)
      : run_(*run),
        training_(ViewsOf(run)),
        geometry_(run->results->geometry),
        views_(MakeTrainViews(training_, geometry_)),
        options_(ProxyOptions(run->options, SettleTrainOptions(run->options.train, training_, geometry_, Silent()))),
        finish_(FinishOptions(run->options, options_)) {}

  /// Of model `number`.
  int64_t Iterations(int number) const { return options_.iterations + (GoesOn(run_, number) ? finish_.iterations : 0); }

  /// Trains model `number` and writes its files; false, with a warning, where too little is left of the views.
  bool Train(int number, const std::vector<int>& held_out, const Listener& listener) const {
    const std::vector<TrainView> kept = Without(views_, held_out);
    const std::vector<LoadedView> shown = Without(training_.views, held_out);
    const Geometry rest = GeometryWithout(geometry_, shown, held_out);
    if (kept.size() < kMinViewsOfProxy || rest.points.size() < kMinPointsForStart) {
      run_.listener(Warning{fmt::format(
          "no proxy models for --proposers splat: one would have {} views and {} dense points, and needs {} and {}; "
          "views are warped instead",
          kept.size(), rest.points.size(), kMinViewsOfProxy, kMinPointsForStart)});
      return false;
    }
    const StartOptions& start = run_.options.start;
    const PointCloud cloud = DenseStart(start, shown, rest, static_cast<size_t>(options_.max_gaussians));
    const Gaussians gaussians = InitializeGaussians(cloud, InitializeOptionsOf(start, kDenseScale));
    const uint64_t seed = start.seed + static_cast<uint64_t>(number);
    const auto background = BackgroundColor(run_.options.image.background);
    Trainer trainer(options_, seed, background, kept, gaussians);
    trainer.Run({}, listener);
    const fs::path& root = run_.workspace.root();
    WriteGaussianPly(root / BeforeFile(number), trainer.gaussians(), options_.sh_degree);
    if (!GoesOn(run_, number)) return true;
    if (finish_.iterations == 0) {
      WriteGaussianPly(root / FinishedFile(number), trainer.gaussians(), options_.sh_degree);
      return true;
    }
    Trainer finisher(finish_, seed, background, views_, trainer.gaussians());
    finisher.Run({}, Offset(listener, options_.iterations));
    WriteGaussianPly(root / FinishedFile(number), finisher.gaussians(), finish_.sh_degree);
    return true;
  }

 private:
  /// A trainer's progress after `before` other iterations of the same model.
  static Listener Offset(const Listener& listener, int64_t before) {
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

  const Run& run_;
  const TrainingViews& training_;
  const Geometry& geometry_;
  std::vector<TrainView> views_;
  TrainOptions options_, finish_;
};

void AddProxyKey(Run* run, Fingerprint* key) {
  const RunOptions& options = run->options;
  key->Add(options.propose.proxy_models).Add(options.propose.proxy_finished).Add(options.propose.proxy_finish);
  key->Add(options.train.iterations).Add(options.train.max_gaussians);  // of the finish
  key->Add(OptionsToJson(options.start).dump()).Add(OptionsToJson(ProxyOptions(options, options.train)).dump());
  key->Add(OptionsToJson(options.image).dump());
}

bool LoadProxy(Run* run) {
  std::vector<ProxyModel> proxies;
  const int n = Count(*run), views = static_cast<int>(run->split.train.size());
  for (int k = 0; k < n; ++k) {
    const fs::path& root = run->workspace.root();
    ProxyModel proxy{ReadGaussianPly(root / BeforeFile(k)).gaussians, std::nullopt, HeldOutViews(views, n, k)};
    if (GoesOn(*run, k)) proxy.gaussians = ReadGaussianPly(root / FinishedFile(k)).gaussians;
    proxies.push_back(std::move(proxy));
  }
  run->results->proxies = std::move(proxies);
  return true;
}

std::optional<nlohmann::json> MakeProxy(Run* run, const std::string& key) {
  run->results->proxies.clear();
  if (!CanPropose(ViewsOf(run), run->results->geometry)) return std::nullopt;
  const ProxyTrainer trainer(run);
  const int n = Count(*run), views = static_cast<int>(run->split.train.size());
  std::vector<std::string> all;
  int64_t before = 0, total = 0;
  for (int k = 0; k < n; ++k) total += trainer.Iterations(k);
  for (int k = 0; k < n; before += trainer.Iterations(k++)) {
    const std::string part = fmt::format("proxy {}", k);
    const std::vector<std::string> files = ProxyFiles(*run, k);
    all.insert(all.end(), files.begin(), files.end());
    if (run->workspace.IsDone(part, key)) continue;
    run->workspace.MarkUndone(part);
    if (!trainer.Train(k, HeldOutViews(views, n, k), AsProxies(run->listener, before, total))) return std::nullopt;
    run->workspace.MarkDone(part, {{"key", key}, {"files", files}});
  }
  LoadProxy(run);
  return nlohmann::json{{"models", n}, {"files", all}};
}

}  // namespace

TrainOptions ProxyOptions(const RunOptions& options, TrainOptions train) {
  const double share = options.propose.proxy_share;
  const auto scaled = [&](int iterations) { return std::max(1, static_cast<int>(share * iterations)); };
  train.iterations = scaled(train.iterations);
  train.sh_degree_interval = scaled(train.sh_degree_interval);
  train.refine_start = scaled(train.refine_start);
  train.max_gaussians = std::min(train.max_gaussians,
                                 options.propose.proxy_gaussians.ValueOr(std::max(1, 2 * (train.max_gaussians / 5))));
  // Nothing that concerns proposals reaches a proxy model: other values of these ask for no new ones.
  const TrainOptions unused;
  train.schedule = ScheduleKind::kNone;
  train.synthetic_floor = unused.synthetic_floor, train.synthetic_peak = unused.synthetic_peak;
  train.proposal_weight = unused.proposal_weight, train.proposal_ssim = unused.proposal_ssim;
  train.proposal_lpips = unused.proposal_lpips;
  train.confidence_gate = unused.confidence_gate, train.confidence_power = unused.confidence_power;
  return train;
}

bool CanPropose(const TrainingViews& training, const Geometry& geometry) {
  return geometry.points.size() >= kMinPointsToPropose && training.views.size() >= kMinViewsToPropose;
}

StageWork ProxyStage() {
  return {.wanted = [](const Run& run) { return run.plan.Uses(run.options, ProposerChoice::kSplat); },
          .own = AddProxyKey,
          .make = MakeProxy,
          .load = LoadProxy};
}

}  // namespace oraclegs
