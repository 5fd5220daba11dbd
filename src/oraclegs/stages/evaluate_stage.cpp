#include "oraclegs/stages/evaluate_stage.h"

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/evaluate/trust_quality.h"
#include "oraclegs/evaluate/uncertainty.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/gaussians/transform.h"
#include "oraclegs/propose/ensemble.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/scene/frame_comments.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/stages/perceptual.h"
#include "oraclegs/stages/stage_clock.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/stages/train_inputs.h"
#include "oraclegs/workspace/non_commercial.h"

namespace oraclegs {
namespace {
namespace fs = std::filesystem;

constexpr size_t kMaxBoundPhotos = 24;  // more take time and change little

/// Where nothing is held out, the training views are rendered, so that there is something to look at.
const std::vector<int>& ScoredViews(const Split& split) { return split.test.empty() ? split.train : split.test; }

void AddEvaluateKey(Run* run, Fingerprint* key) {
  key->Add(run->files.OfAll(run->plan.lpips)).Add(ShapingOptionsToJson(run->options).dump());
  key->Add(ViewsKey(run, ScoredViews(run->split), run->plan.image));
  std::error_code ignored;
  for (const fs::path& file : {run->workspace.point_cloud(), run->workspace.exposures()}) {
    if (fs::exists(file, ignored)) key->AddFile(file);
  }
}

/// Function that brings a render of each view to the exposure that photos near by have; empty where exposures were not
/// learned.
std::function<void(size_t, const Buffer<float>&)> ExposureOfPlaces(const Run& run,
                                                                   const std::vector<LoadedView>& views) {
  const fs::path file = run.workspace.exposures();
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  const std::vector<Camera> photos = WorkingCameras(run.scene, run.split.train, run.plan.image);
  const std::vector<ExposureMap> maps = ReadExposures(file, NamesAt(run.scene, run.split.train));
  std::vector<ExposureMap> of_views;
  for (const LoadedView& view : views) of_views.push_back(ExposureAt(view.camera, photos, maps));
  return [of_views](size_t view, const Buffer<float>& render) { ShowThrough(of_views[view], render); };
}

/// Adds what is known of whether the model is right about where it can be trusted.
void AddTrust(const TrustQuality& quality, nlohmann::json* record) {
  if (quality.support) (*record)["support"] = ToJson(*quality.support);
  if (quality.of_gaussians) (*record)["uncertainty"]["gaussians"] = ToJson(*quality.of_gaussians);
  if (quality.of_models) (*record)["uncertainty"]["models"] = ToJson(*quality.of_models);
}

/// Those of the photos that draft model `k` of `models` has left out that the bound is from.
std::vector<LoadedView> UnseenPhotos(const std::vector<LoadedView>& photos, int models, int k) {
  const std::vector<int> left_out = HeldOutViews(static_cast<int>(photos.size()), models, k);
  const size_t step = (left_out.size() * static_cast<size_t>(models) + kMaxBoundPhotos - 1) / kMaxBoundPhotos;
  std::vector<LoadedView> unseen;
  for (size_t i = 0; i < left_out.size(); i += step) unseen.push_back(photos[static_cast<size_t>(left_out[i])]);
  return unseen;
}

/// Bound of the errors, by the draft models at photos that each left out; nothing for a run without them.
std::optional<ErrorBound> BoundOf(Run* run, const RenderOptions& options) {
  const nlohmann::json record = run->workspace.Record("proxies");
  if (!record.is_object()) return std::nullopt;
  const int models = record.value("models", 0);
  const auto files = record.value("files", std::vector<std::string>());  // of each model before and after it finished
  if (models < 2 || files.size() != 2 * static_cast<size_t>(models)) return std::nullopt;
  std::vector<ExpectedErrors> errors;
  for (int k = 0; k < models; ++k) {
    try {
      const fs::path before = run->workspace.root() / files[2 * static_cast<size_t>(k)];
      const Gaussians gaussians = ReadIntactGaussianPly(before).gaussians.To(run->plan.device);
      const std::vector<LoadedView> unseen = UnseenPhotos(ViewsOf(run).views, models, k);
      for (ExpectedErrors& photo : ErrorsAtUnseen(gaussians, unseen, options)) errors.push_back(std::move(photo));
    } catch (const InputError& error) {
      run->listener(Warning{fmt::format("{}; no bound of the errors is given", error.what())});
      return std::nullopt;
    }
  }
  return BoundFrom(errors);
}

TrustQuality TrustOf(const Run& run, const Model& model, const std::vector<LoadedView>& views) {
  std::optional<Uncertainty> uncertainty;
  if (auto others = ModelsBeside(run.workspace, run.workspace.Record("train"), run.plan.device, run.listener)) {
    uncertainty.emplace(model.gaussians, std::move(*others), model.render);
  }
  return MeasureTrust(model.gaussians, model.marks, views, model.render, uncertainty ? &*uncertainty : nullptr);
}

void UndoEvaluate(Run* run, const nlohmann::json&) {
  for (const char* part : {"test", "train"}) {
    const fs::path dir = run->workspace.renders(part);
    std::error_code error;
    fs::remove_all(dir, error);
    if (error) throw RunError("{}: cannot be removed: {}", dir.string(), SystemReason(error));
  }
}

std::optional<nlohmann::json> MakeEvaluate(Run* run, const std::string&) {
  const Workspace& workspace = run->workspace;
  const Stopwatch watch;
  const Model model = LoadModel(workspace.point_cloud(), run->options, run->plan.device, run->frame, run->listener);
  const bool held_out = !run->split.test.empty();
  std::vector<LoadedView> tests;
  if (held_out) {
    tests = LoadViews(run->scene, run->split.test, run->plan.image, run->listener);
  } else {
    run->listener(Note{"all photos train: no view is left to score the result on (--eval holds some out)"});
  }
  const std::vector<LoadedView>& views = held_out ? tests : ViewsOf(run).views;
  const fs::path renders = workspace.renders(held_out ? "test" : "train");
  EvaluateExtras extras(renders, LpipsScores(run->plan.lpips, model.gaussians.means.device(), run->listener));
  extras.expose = ExposureOfPlaces(*run, views);
  nlohmann::json scores = ToJson(Evaluate(model.gaussians, views, model.render, extras, run->listener));
  nlohmann::json record = {{"test", held_out ? scores : ScoreModel(model, {}, {}, {}, Silent())},
                           {"gaussians", model.gaussians.size()},
                           {"peak_memory_bytes", PeakMemoryBytes()},
                           {"files", {"metrics.json"}}};
  if (!held_out) record["train_views"] = std::move(scores);
  TrustQuality trust;
  if (held_out) {
    trust = TrustOf(*run, model, views);
    AddTrust(trust, &record);
  }
  if (const std::optional<ErrorBound> bound = BoundOf(run, model.render)) {
    const BoundCheck check = CheckBound(*bound, trust.errors_of_models);
    record["uncertainty"]["bound"] = ToJson(*bound, trust.of_models ? &check : nullptr);
  }
  record["seconds"] = watch.Seconds();
  WriteFileAtomically(workspace.metrics(), MetricsToJson(*run, record).dump(2) + "\n");
  return record;
}

/// True for a file that names no offset and lies by the scene's offset beside the scene: one that another program made
/// of files that were written without it.
bool LacksOffset(const GaussianPly& file, const SceneFrame& frame) {
  const int64_t n = file.gaussians.size();
  if (frame.offset.isZero(0) || n == 0 || !OffsetOf(file.comments).isZero(0)) return false;
  Eigen::Vector3d middle;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> values;
    for (int64_t i = 0; i < n; ++i) values.push_back(static_cast<double>(file.gaussians.means[3 * i + c]));
    middle[c] = Median(std::move(values));
  }
  return (middle + frame.offset - frame.center).norm() < (middle - frame.center).norm();
}

std::string ScoredText(const nlohmann::json& record) {
  const nlohmann::json test = record.value("test", nlohmann::json::object());
  const nlohmann::json psnr = test.value("psnr", nlohmann::json()), ssim = test.value("ssim", nlohmann::json());
  if (!psnr.is_number() || !ssim.is_number()) return "no test pixels";
  return fmt::format("PSNR {:.2f} dB, SSIM {:.4f}", psnr.get<double>(), ssim.get<double>());
}

}  // namespace

Model LoadModel(const fs::path& ply, const RunOptions& options, Device device, const SceneFrame& frame,
                const Listener& listener) {
  GaussianPly file = ReadGaussianPly(ply);
  for (const std::string& warning : file.warnings) listener(Warning{warning});
  if (file.antialiased && !options.train.antialiased) {
    listener(Note{fmt::format("{}: says that it was trained antialiased, and is rendered so", ply.string())});
  }
  std::optional<double> unit = UnitMetersOf(file.comments);
  Similarity scene_from_file;
  scene_from_file.translation = OffsetOf(file.comments);
  if (LacksOffset(file, frame)) {
    scene_from_file.translation = frame.offset;
    listener(Note{fmt::format("{}: its positions lie beside the scene, but for the offset {} {} {}, which is added",
                              ply.string(), frame.offset.x(), frame.offset.y(), frame.offset.z())});
  }
  if (unit && frame.unit_meters && *unit != *frame.unit_meters) {  // exported in meters
    scene_from_file.scale = *unit / *frame.unit_meters;
    scene_from_file.translation *= scene_from_file.scale;
    unit = frame.unit_meters;
  }
  const Similarity run_from_file = RunFromScene(frame) * scene_from_file;
  if (!run_from_file.IsIdentity()) file.gaussians = Transformed(file.gaussians, run_from_file);
  file.gaussians.ForEach([&](const char*, Buffer<float>& part) { part = part.To(device); });
  return {std::move(file.gaussians),
          {BackgroundColor(options.image.Settled().background), file.sh_degree,
           options.train.antialiased || file.antialiased},
          PartsInComments(file.comments),
          std::move(file.marks),
          unit};
}

std::optional<std::vector<Gaussians>> ModelsBeside(const WorkspacePaths& paths, const nlohmann::json& train_record,
                                                   Device device, const Listener& listener) {
  if (!train_record.is_object() || !train_record.contains("others")) return std::nullopt;
  std::vector<Gaussians> models;
  try {
    for (const nlohmann::json& file : train_record.at("others")) {
      models.push_back(ReadIntactGaussianPly(paths.root() / file.get<std::string>()).gaussians.To(device));
    }
  } catch (const InputError& error) {
    listener(Warning{fmt::format("{}; the uncertainty does not use the run's draft models", error.what())});
    return std::nullopt;
  }
  return models;
}

nlohmann::json ScoreModel(const Model& model, const std::vector<LoadedView>& views, const fs::path& renders,
                          const std::vector<fs::path>& lpips, const Listener& listener) {
  if (views.empty()) listener(Warning{"there are no test views: nothing is scored (see --eval)"});
  const ImageScores scores = LpipsScores(lpips, model.gaussians.means.device(), listener);
  return ToJson(Evaluate(model.gaussians, views, model.render, {renders, scores}, listener));
}

StageWork EvaluateStage() {
  return {.wanted = [](const Run&) { return true; },
          .own = AddEvaluateKey,
          .undo = UndoEvaluate,
          .make = MakeEvaluate,
          .check = [](const Run& run) { ReadMetrics(run.workspace.root()); },
          .file = "metrics.json",
          .summary = ScoredText,
          .seconds =
              [](const EstimateInput& input) {
                constexpr double kScore = 0.5;
                return kScore + SecondsOfScores(input, input.test_views > 0 ? input.test_views : input.scene.views);
              },
          .uses_network = [](const Run& run) { return !run.plan.lpips.empty(); }};
}

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
  render.background = BackgroundColor(run.plan.image.background);
  render.antialiased = run.options.train.antialiased;
  return {every, [=](const Gaussians& gaussians) { return MeanPsnr(gaussians, *views, render); }};
}

}  // namespace oraclegs
