#include "oraclegs/stages/stage_works.h"

#include <optional>
#include <utility>

#include "oraclegs/baselines/methods.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/text.h"
#include "oraclegs/evaluate/support.h"
#include "oraclegs/evaluate/uncertainty.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/gaussians/selection.h"
#include "oraclegs/gaussians/transform.h"
#include "oraclegs/scene/frame_comments.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/perceptual.h"
#include "oraclegs/stages/proposer_row.h"
#include "oraclegs/stages/stage_clock.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/stages/start_points.h"
#include "oraclegs/stages/train_inputs.h"
#include "oraclegs/train/checkpoint_folder.h"
#include "oraclegs/train/train_device.h"
#include "oraclegs/train/trainer.h"
#include "oraclegs/workspace/non_commercial.h"
#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kUncertainProposals = 24;  // enough to see each Gaussian

void AddStartFile(const Run& run, Fingerprint* key) {
  if (const fs::path& file = run.options.start.init_points; !file.empty()) key->AddFile(file);
}

void AddTrainKey(Run* run, Fingerprint* key) {
  AddStartFile(*run, key);
  key->Add(ShapingOptionsToJson(run->options).dump());
  key->Add(ViewsKey(run, run->split.train, run->plan.image));
  if (run->plan.has_proposals && run->options.train.proposal_lpips > 0) key->Add(run->files.OfAll(run->plan.lpips));
}

/// The key of the stage, but for --iterations.
std::string InputsOf(Run* run) {
  const Stage& stage = StageNamed(*run->stages, "train");
  Fingerprint print;
  print.Add(stage.version);
  for (const std::string& need : stage.needs) {
    const nlohmann::json record = run->workspace.Record(need);
    print.Add(record.is_object() ? record.value("key", "") : "");
  }
  nlohmann::json options = ShapingOptionsToJson(run->options);
  options.erase("iterations");
  print.Add(options.dump());
  AddStartFile(*run, &print);
  print.Add(ViewsKey(run, run->split.train, run->plan.image));
  if (run->plan.has_proposals && run->options.train.proposal_lpips > 0) print.Add(run->files.OfAll(run->plan.lpips));
  return print.Hex();
}

/// True for the options of a checkpoint from which these go on: the same, with at least as many iterations.
bool GoesOnFrom(nlohmann::json before, const nlohmann::json& now) {
  const auto iterations = [](const nlohmann::json& options) {
    const nlohmann::json value = options.is_object() ? options.value("iterations", nlohmann::json()) : nlohmann::json();
    return value.is_number() ? value.get<double>() : 0.;
  };
  if (iterations(before) > iterations(now)) return false;
  if (before.is_object()) before["iterations"] = now.at("iterations");
  return before == now;
}

/// Leaves the one that a finished run is continued from. Where there is no room for it, the run is none the worse.
void KeepLastCheckpoint(const Run& run, const Trainer& trainer) {
  const fs::path last = CheckpointPath(run.workspace.checkpoints(), trainer.iteration());
  try {
    WriteCheckpoint(last, trainer.MakeCheckpoint());
  } catch (const RunError& error) {
    run.listener(Warning{fmt::format("{}; this run cannot be continued with more --iterations", error.what())});
    return;
  }
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(run.workspace.checkpoints(), ignored)) {
    if (entry.path() != last) fs::remove(entry.path(), ignored);
  }
}

/// Removes metrics.json, which would be mistaken for the result of these inputs.
void UndoTrain(Run* run, const nlohmann::json&) {
  std::error_code ignored;
  fs::remove(run->workspace.metrics(), ignored);
}

struct FoundCheckpoint {
  fs::path path;
  Checkpoint checkpoint;
};

/// The newest checkpoint that can be read.
std::optional<FoundCheckpoint> NewestSound(const Run& run) {
  for (const fs::path& path : FindCheckpoints(run.workspace.checkpoints())) {
    try {
      return FoundCheckpoint{path, ReadCheckpoint(path)};
    } catch (const InputError& damage) {
      run.listener(Warning{fmt::format("{}; the checkpoint before it is used", damage.what())});
    }
  }
  return std::nullopt;
}

/// The newest checkpoint, when it belongs to these inputs; those of others are removed, with the model.
std::optional<Checkpoint> FindCheckpoint(const Run& run, const nlohmann::json& saved_options) {
  std::error_code ignored;
  if (std::optional<FoundCheckpoint> found = NewestSound(run)) {
    const fs::path& path = found->path;
    Checkpoint& checkpoint = found->checkpoint;
    if (GoesOnFrom(checkpoint.options, saved_options)) {
      checkpoint.options = saved_options;
      run.listener(Note{fmt::format("continuing from iteration {} ({})", checkpoint.iteration, path.string())});
      return std::move(checkpoint);
    }
    nlohmann::json before = checkpoint.options;  // what --iterations may be was asked when the workspace was claimed
    if (before.is_object()) before["iterations"] = saved_options.at("iterations");
    const std::string difference = DescribeDifference(before, run.options);
    if (!difference.empty()) {
      throw InputError(
          "{}: was saved with other options ({}); give the same options to continue, or start anew with --overwrite",
          path.string(), difference);
    }
    run.listener(Warning{
        "the photos, poses, depth, proposals, weights, the oracle or the program have changed since the last run: "
        "training starts anew"});
    std::error_code error;
    fs::remove_all(run.workspace.checkpoints(), error);
    if (error) throw RunError("{}: cannot be removed: {}", run.workspace.checkpoints().string(), SystemReason(error));
  }
  if (!UnfinishedSplat(run.workspace.root()).empty()) return std::nullopt;  // that of the new training replaces it
  fs::remove(run.workspace.point_cloud(), ignored);
  fs::remove(run.workspace.exposures(), ignored);
  return std::nullopt;
}

TrainOptions SettledOptions(const Run& run, const TrainingViews& training) {
  TrainEvidence found = EvidenceOf(training, run.results->geometry);
  found.proposals = run.results->proposals.size();
  if (ProxiesAlonePropose(run)) {
    const auto backdrop = found.is_object ? std::optional(BackgroundColor(run.plan.image.background)) : std::nullopt;
    found.proxy_trust = MeanSquaredConfidence(run.results->proposals, backdrop);
  }
  return SettleTraining(run.options.train, found, run.listener);
}

Gaussians StartGaussians(Run* run) {
  const StageResults& known = *run->results;
  const StartPoints start = ChooseStart(run, {ViewsOf(run).views, known.points, known.geometry});
  const StartOptions& asked = run->options.start;
  const bool is_dense = start.source.rfind("dense", 0) == 0;
  return InitializeGaussians(start.cloud, {SettleStartScale(asked, is_dense), asked.init_opacity}, run->plan.device);
}

nlohmann::json TimingsToJson(const TrainResult& result) {
  if (result.steps == 0) return nullptr;  // there was nothing left to do, which is not the same as no time
  const TrainTimings& t = result.timings;
  return {{"project", t.render.project},
          {"bin", t.render.bin},
          {"blend", t.render.blend},
          {"blend_backward", t.render.blend_backward},
          {"gaussian_backward", t.render.gaussian_backward},
          {"parts", t.parts},
          {"loss", t.loss},
          {"refine", t.refine},
          {"total", t.total}};
}

/// Empty where nothing asks for it, or no depth is known.
PseudoDepth PseudoDepthOf(const Run& run, const TrainingViews& training) {
  if (!(run.options.method.Settings().pseudo_depth_weight > 0)) return {};
  const DepthSource& source = run.plan.depth;
  if (!source.weights.empty()) return NetworkPseudoDepth(source.weights, run.plan.device, run.listener);
  const std::vector<DepthMap>& maps = run.results->geometry.maps;
  return maps.empty() ? PseudoDepth() : StereoPseudoDepth(training.views, maps);
}

/// A trainer of the run's views and proposals, from the start or from a checkpoint, and how it uses LPIPS.
struct ReadyTrainer {
  std::unique_ptr<Trainer> trainer;
  std::vector<std::string> names;  ///< names of the training views
  std::vector<SupportView> views;  ///< views that support the Gaussians
  std::string lpips;               ///< convention; "" = not used
  nlohmann::json chosen;           ///< for the training options that were automatic
};

/// The images and the proposals, with what each of their pixels counts.
std::vector<SupportView> SupportViewsOf(const std::vector<TrainView>& images, const std::vector<TrainView>& proposals) {
  std::vector<SupportView> views;
  for (const TrainView& view : images) views.push_back({view.camera, view.pixel_weight, false, view.weight_bytes});
  for (const TrainView& view : proposals) views.push_back({view.camera, view.pixel_weight, true, view.weight_bytes});
  return views;
}

/// Gives up the run's views and geometry, so that they do not lie in memory beside the trainer's copy.
ReadyTrainer MakeTrainer(Run* run, const std::optional<Checkpoint>& checkpoint) {
  StageResults& known = *run->results;
  const TrainingViews& training = ViewsOf(run);
  ReadyTrainer ready;
  for (const LoadedView& view : training.views) ready.names.push_back(view.name);
  Gaussians start = checkpoint ? checkpoint->gaussians : StartGaussians(run);
  ReportDevice(run->plan.device, run->plan.support, run->listener);
  const TrainOptions settled = SettledOptions(*run, training);
  TrainingLpips network = LpipsOfProposals(settled, run->plan, known.proposals, run->listener);
  ready.lpips = network.convention;
  PseudoDepth pseudo_depth = PseudoDepthOf(*run, training);
  std::vector<TrainView> images = TakeTrainViews(known.views.get(), &known.geometry, ViewUseOf(*run));
  ready.views = SupportViewsOf(images, known.proposals);
  ready.chosen = ChosenOptions(run->options.train, settled);
  BaselineSetup setup{{settled,
                       run->options.start.seed,
                       BackgroundColor(run->plan.image.background),
                       {std::move(images), std::move(known.proposals), std::move(network.distance)},
                       std::move(start)},
                      run->options.method.Settings()};
  setup.make_device = [device = run->plan.device](const TrainDeviceSetup& of_device) {
    return MakeTrainDevice(device, of_device);
  };
  setup.pseudo_depth = std::move(pseudo_depth);
  AddBaseline(&setup);
  const TrainDeviceMaker make_device = setup.make_device;
  ready.trainer = std::make_unique<Trainer>(std::move(setup), make_device);
  if (checkpoint) ready.trainer->Restore(*checkpoint);
  run->results = std::make_unique<StageResults>();
  return ready;
}

/// Files of the proxy models that the run has, as they were when they had seen all views.
std::vector<std::string> ProxyFiles(const Run& run) {
  std::vector<std::string> files;
  const nlohmann::json record = run.workspace.Record("proxies");
  if (!run.plan.Uses(run.options, kProxiesWord) || !record.is_object()) return files;
  for (const nlohmann::json& file : record.at("files")) {
    if (file.get<std::string>().find("_before") == std::string::npos) files.push_back(file.get<std::string>());
  }
  return files;
}

/// Cameras of the images, and of at most kUncertainProposals proposals, evenly.
std::vector<Camera> CamerasOfUncertainty(const std::vector<SupportView>& views) {
  std::vector<Camera> images, proposals;
  for (const SupportView& view : views) (view.is_proposal ? proposals : images).push_back(view.camera);
  const size_t count = std::min(proposals.size(), kUncertainProposals);
  for (size_t i = 0; i < count; ++i) images.push_back(proposals[i * proposals.size() / count]);
  return images;
}

/// Empty, after a warning, where memory does not suffice. The trained model is not lost when the user stops it here.
GaussianMarks MarksOfModel(const Run& run, const ReadyTrainer& ready) {
  const Trainer& trainer = *ready.trainer;
  RenderOptions render;
  render.background = BackgroundColor(run.plan.image.background);
  render.antialiased = run.options.train.antialiased;
  try {
    auto others = ModelsBeside(run.workspace, {{"others", ProxyFiles(run)}}, run.plan.device, run.listener);
    Uncertainty uncertainty(trainer.gaussians(), others ? std::move(*others) : std::vector<Gaussians>(), render);
    return {Support(trainer.gaussians(), ready.views, render),
            uncertainty.OfGaussians(CamerasOfUncertainty(ready.views))};
  } catch (const Interrupted&) {
    WriteCheckpoint(CheckpointPath(run.workspace.checkpoints(), trainer.iteration()), trainer.MakeCheckpoint());
    throw;
  } catch (const OutOfMemory& error) {
    run.listener(Warning{
        fmt::format("{}; the splat does not say what supports its Gaussians, nor how sure they are", error.what())});
    return {};
  }
}

/// Returns the number of Gaussians of the splat.
int64_t WriteModel(const Run& run, const ReadyTrainer& ready) {
  const WorkspacePaths& paths = run.workspace;
  const Trainer& trainer = *ready.trainer;
  const int64_t written = WriteSplat(run, trainer.gaussians(), MarksOfModel(run, ready));
  std::error_code ignored;
  fs::remove(paths.exposures(), ignored);
  if (!trainer.exposures().empty()) {
    WriteFileAtomically(paths.exposures(), ExposuresToJson(ready.names, trainer.exposures()).dump(1) + "\n");
  }
  return written;
}

std::optional<nlohmann::json> MakeTrain(Run* run, const std::string&) {
  const Stopwatch watch;
  nlohmann::json saved_options = ShapingOptionsToJson(run->options);
  saved_options["inputs"] = InputsOf(run);
  const std::optional<Checkpoint> checkpoint = FindCheckpoint(*run, saved_options);
  if (run->observer) run->observer->Show(run, "train");
  const ReadyTrainer ready = MakeTrainer(run, checkpoint);
  const double loading = watch.Seconds();
  const TrainResult result = ready.trainer->Run(
      {run->workspace.checkpoints(), run->options.checkpoints.checkpoint_every, std::move(saved_options)},
      run->listener, run->observer ? run->observer->OfTraining(TestScoreOf(*run)) : TrainObserver());
  const int64_t written = WriteModel(*run, ready);
  run->workspace.MarkUndone(kBestSoFar);
  KeepLastCheckpoint(*run, *ready.trainer);
  nlohmann::json record{{"seconds", loading + result.seconds},
                        {"training_seconds", result.seconds},
                        {"iterations", result.iterations},
                        {"device", run->plan.device.Name()},
                        {"milliseconds_per_iteration", TimingsToJson(result)},
                        {"gaussians", written},
                        {"chosen", ready.chosen},
                        {"others", ProxyFiles(*run)},
                        {"lpips", ready.lpips.empty() ? nlohmann::json() : nlohmann::json(ready.lpips)},
                        {"peak_memory_bytes", PeakMemoryBytes()},
                        {"files", {"point_cloud.ply"}}};
  if (!ready.trainer->exposures().empty()) record["files"].push_back("exposures.json");
  if (checkpoint) record["cpu_seconds"] = nullptr;  // that of the processes before is not known
  return record;
}

}  // namespace

int64_t WriteSplat(const Run& run, const Gaussians& gaussians, const GaussianMarks& marks) {
  std::vector<std::string> comments = FrameComments(run.frame);
  for (std::string& comment : LicenseComments(NonCommercialParts(run.workspace)))
    comments.push_back(std::move(comment));
  if (run.options.train.antialiased) comments.emplace_back(kAntialiasedComment);
  const Similarity written_from_run = WrittenFromRun(run.frame);
  const std::vector<int64_t> rows = WithoutFarDust(gaussians);
  const Gaussians model = Picked(gaussians, rows);
  WriteGaussianPly(run.workspace.point_cloud(),
                   written_from_run.IsIdentity() ? model : Transformed(model, written_from_run),
                   run.options.train.sh_degree, comments, Picked(marks, rows));
  return model.size();
}

StageWork TrainStage() {
  return {
      .wanted = [](const Run&) { return true; },
      .own = AddTrainKey,
      .undo = UndoTrain,
      .make = MakeTrain,
      .check = [](const Run& run) { ReadIntactGaussianPly(run.workspace.point_cloud()); },
      .file = "point_cloud.ply",
      .summary =
          [](const nlohmann::json& r) {
            return Counted(CountIn(r, "gaussians"), "Gaussian") + ", " + Counted(CountIn(r, "iterations"), "iteration");
          },
      .seconds =
          [](const EstimateInput& input) { return input.options.train.iterations.value() * SecondsOfIteration(input); },
      .uses_network =
          [](const Run& run) {
            return run.plan.has_proposals && run.options.train.proposal_lpips > 0 && !run.plan.lpips.empty();
          }};
}

}  // namespace oraclegs
