#include "oraclegs/proposers/proxy_models.h"

#include <algorithm>
#include <utility>

#include "oraclegs/core/text.h"
#include "oraclegs/depth/confidence.h"
#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/stages/start_points.h"
#include "oraclegs/stages/train_inputs.h"
#include "oraclegs/train/train_device.h"
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
      listener(StepDone{"proxies", before + step->done, total, "iterations of draft models", step->detail});
    } else if (!std::holds_alternative<Note>(event)) {
      listener(event);
    }
  };
}

/// Those of the run as it was begun: a finished run that trains on keeps its proxy models.
RunOptions OptionsOfProxies(const Run& run) {
  RunOptions options = run.options;
  if (run.start_iterations > 0) options.train.iterations = static_cast<int>(run.start_iterations);
  return options;
}

void Scale(double share, int* iterations) { *iterations = std::max(1, static_cast<int>(share * *iterations)); }
void Scale(double share, Auto<int>* iterations) {
  if (iterations->is_auto()) return;
  int scaled = iterations->value();
  Scale(share, &scaled);
  *iterations = scaled;
}

/// All views' depth, as sure as it is without the ones held out.
Geometry Unseen(const Geometry& all, const std::vector<int>& held_out) {
  Geometry unseen;
  unseen.maps = all.maps, unseen.gains = all.gains;
  for (size_t v = 0; v < all.maps.size(); ++v) {
    const bool is_held_out = std::find(held_out.begin(), held_out.end(), static_cast<int>(v)) != held_out.end();
    if (all.maps[v].size() > 0 && !is_held_out) unseen.maps[v].confidence = ConfidenceWithout(all.maps, v, held_out);
  }
  return unseen;
}

/// Geometry of the views that are not held out.
Geometry GeometryWithout(Geometry unseen, const std::vector<LoadedView>& shown, const std::vector<int>& held_out) {
  Geometry rest;
  rest.maps = Without(unseen.maps, held_out);
  rest.gains = Without(unseen.gains, held_out);
  FusionOptions fusion = FusionOf(rest.gains);
  fusion.min_confidence = ConfidenceOfPoints(rest.maps);
  rest.points = FuseDepth(rest.maps, shown, fusion);
  return rest;
}

/// Trains the models of one run.
class ProxyTrainer {
 public:
  explicit ProxyTrainer(Run* run)
      : run_(*run),
        training_(ViewsOf(run)),
        geometry_(run->results->geometry),
        views_(MakeTrainViews(training_, geometry_, ViewUseOf(*run))) {
    const RunOptions asked = OptionsOfProxies(*run);
    const TrainEvidence found = EvidenceOf(training_, geometry_);
    options_ = ProxyOptions(asked.propose.proxy_share, SettleTraining(asked.train, found, Silent()));
    finish_ = FinishOptions(asked, found);
  }

  int64_t iterations() const { return options_.iterations + finish_.iterations; }

  /// Trains model `number` and writes its files; false, with a warning, where too little is left of the views.
  bool Train(int number, const std::vector<int>& held_out, const std::vector<fs::path>& files,
             const Listener& listener) const {
    Geometry unseen = Unseen(geometry_, held_out);
    const std::vector<TrainView> kept = Without(MakeTrainViews(training_, unseen, ViewUseOf(run_)), held_out);
    const std::vector<LoadedView> shown = Without(training_.views, held_out);
    const Geometry rest = GeometryWithout(std::move(unseen), shown, held_out);
    if (kept.size() < kMinViewsOfProxy || rest.points.size() < kMinPointsForStart) {
      run_.listener(Warning{fmt::format(
          "no proxy models for --proposers proxies: one would have {} views and {} dense points, and needs {} and {}; "
          "views are warped instead",
          kept.size(), rest.points.size(), kMinViewsOfProxy, kMinPointsForStart)});
      return false;
    }
    const StartOptions& start = run_.options.start;
    const PointCloud cloud = DenseStart(start, shown, rest, static_cast<size_t>(options_.max_gaussians));
    const Gaussians gaussians = InitializeGaussians(cloud, {SettleStartScale(start, true), start.init_opacity});
    Trainer trainer = TrainerOf(number, options_, kept, gaussians);
    trainer.Run({}, listener);
    WriteGaussianPly(files[0], trainer.gaussians(), options_.sh_degree);
    if (finish_.iterations == 0) {
      WriteGaussianPly(files[1], trainer.gaussians(), options_.sh_degree);
      return true;
    }
    Trainer finisher = TrainerOf(number, finish_, views_, trainer.gaussians());
    finisher.Run({}, Offset(listener, options_.iterations));
    WriteGaussianPly(files[1], finisher.gaussians(), finish_.sh_degree);
    return true;
  }

 private:
  /// Returns the trainer of model `number`, on the device of the run.
  Trainer TrainerOf(int number, const TrainOptions& options, const std::vector<TrainView>& views,
                    const Gaussians& start) const {
    TrainSetup setup{options,
                     run_.options.start.seed + static_cast<uint64_t>(number),
                     BackgroundColor(run_.plan.image.background),
                     {views},
                     start.To(kCpu)};
    return Trainer(std::move(setup), [device = run_.plan.device](const TrainDeviceSetup& on_device) {
      return MakeTrainDevice(device, on_device);
    });
  }

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

int Count(const Run& run) { return ProxyCount(run.options.propose, static_cast<int>(run.split.train.size())); }

/// Name of model k's record in stages.json.
std::string RecordName(int k) { return fmt::format("proxy {}", k); }

/// Files of model k, relative to the workspace: before it was trained with all views, and after.
std::vector<std::string> FilesOf(int k) {
  return {fmt::format("proposals/proxy_models/{}_before.ply", k), fmt::format("proposals/proxy_models/{}.ply", k)};
}

void AddProxyKey(Run* run, Fingerprint* key) {
  const RunOptions options = OptionsOfProxies(*run);
  key->Add(options.propose.proxy_models);
  for (const bool is_object : {false, true})
    key->Add(SettleProxyFinish(options.propose, is_object));  // the images say which
  key->Add(options.train.iterations.value());                 // whose share the finish is
  key->Add(options.train.horizon);                            // which the rates follow
  key->Add(OptionsToJson(options.start).dump())
      .Add(OptionsToJson(ProxyOptions(options.propose.proxy_share, options.train)).dump());
  key->Add(OptionsToJson(options.image).dump());
}

/// Throws InputError when a file is damaged.
ProxyModel ReadProxy(const Run& run, int k) {
  const int views = static_cast<int>(run.split.train.size());
  const std::vector<std::string> files = FilesOf(k);
  return {ReadIntactGaussianPly(run.workspace.root() / files[0]).gaussians,
          ReadIntactGaussianPly(run.workspace.root() / files[1]).gaussians, HeldOutViews(views, Count(run), k)};
}

/// Whether model k was made from inputs of this key, and can be read.
bool HasProxy(const Run& run, int k, const std::string& key) {
  if (!run.workspace.IsDone(RecordName(k), key)) return false;
  try {
    ReadProxy(run, k);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

bool LoadProxy(Run* run) {
  std::vector<ProxyModel> proxies;
  for (int k = 0; k < Count(*run); ++k) proxies.push_back(ReadProxy(*run, k));
  run->results->proxies = std::move(proxies);
  return true;
}

std::optional<nlohmann::json> MakeProxy(Run* run, const std::string& key) {
  run->results->proxies.clear();
  if (!CanPropose(ViewsOf(run), run->results->geometry) || TargetPlanOf(*run, true).count == 0) return std::nullopt;
  const int n = Count(*run), views = static_cast<int>(run->split.train.size());
  const ProxyTrainer trainer(run);
  std::vector<std::string> all;
  for (int k = 0; k < n; ++k) {
    const std::string record = RecordName(k);
    const std::vector<std::string> files = FilesOf(k);
    all.insert(all.end(), files.begin(), files.end());
    if (HasProxy(*run, k, key)) continue;
    run->workspace.MarkUndone(record);
    const int64_t each = trainer.iterations();
    if (!trainer.Train(k, HeldOutViews(views, n, k),
                       {run->workspace.root() / files[0], run->workspace.root() / files[1]},
                       AsProxies(run->listener, k * each, n * each))) {
      return std::nullopt;
    }
    run->workspace.MarkDone(record, {{"key", key}, {"files", files}});
  }
  LoadProxy(run);
  return nlohmann::json{{"models", n}, {"files", all}};
}

double SecondsOfProxies(const EstimateInput& input) {
  const ProposeOptions& propose = input.options.propose;
  if (!propose.Uses(kProxiesWord) || ProposalsOf(input) == 0) return 0;
  const bool is_object = input.covered < 1;
  const double iterations =
      (propose.proxy_share + SettleProxyFinish(propose, is_object)) * input.options.train.iterations.value();
  return ProxyCount(propose, input.scene.views) * iterations * SecondsOfIteration(input);
}

}  // namespace

template <class Train>
Train ProxyOptions(double share, Train train) {
  Scale(share, &train.iterations), Scale(share, &train.sh_degree_interval), Scale(share, &train.refine_start);
  train.horizon = 0;
  // Nothing that concerns proposals reaches a proxy model: other values of these ask for no new ones.
  const Train unused;
  train.schedule = ScheduleKind::kNone;
  train.synthetic_floor = unused.synthetic_floor, train.synthetic_peak = unused.synthetic_peak;
  train.proposal_ssim = unused.proposal_ssim, train.proposal_lpips = unused.proposal_lpips;
  train.confidence_power = unused.confidence_power;
  return train;
}
template TrainOptions ProxyOptions(double share, TrainOptions train);
template AutoTrainOptions ProxyOptions(double share, AutoTrainOptions train);

TrainOptions FinishOptions(const RunOptions& options, const TrainEvidence& found) {
  const double share = SettleProxyFinish(options.propose, found.is_object);
  TrainOptions finish = SettleTraining(ProxyOptions(share, options.train), found, Silent());
  if (share == 0) finish.iterations = 0;
  return finish;
}

int ProxyCount(const ProposeOptions& options, int views) {
  const int enough = std::min(kViewsOfProxy, views - 1);
  int models = std::min(options.proxy_models, views);
  while (models < views && views - (views + models - 1) / models < enough) ++models;
  return models;
}

StageWork ProxyStage() {
  return {.wanted = [](const Run& run) { return run.plan.Uses(run.options, kProxiesWord); },
          .own = AddProxyKey,
          .make = MakeProxy,
          .load = LoadProxy,
          .summary = [](const nlohmann::json& r) { return Counted(CountIn(r, "models"), "proxy model"); },
          .seconds = SecondsOfProxies};
}

}  // namespace oraclegs
