#include "oraclegs/pipeline/stages/train_stage.h"

#include <optional>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/pipeline/workspace/fingerprint.h"
#include "oraclegs/pipeline/workspace/metrics.h"
#include "oraclegs/pipeline/workspace/non_commercial.h"
#include "oraclegs/pipeline/settings/oracle_choice.h"
#include "oraclegs/pipeline/stages/perceptual.h"
#include "oraclegs/pipeline/stages/prepare.h"
#include "oraclegs/pipeline/stages/start_points.h"
#include "oraclegs/pipeline/stages/train_inputs.h"
#include "oraclegs/pipeline/stages/validate_stage.h"
#include "oraclegs/pipeline/settings/weights.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {
namespace {

/// Photographs, poses and the model's points.
std::string InputsFingerprint(const Run& run) {
  Fingerprint print;
  print.Add(ViewsFingerprint(run.scene, run.split.train, run.options.photo.downscale));
  for (const ScenePoint& p : run.scene.points) print.Add(p.xyz.x()).Add(p.xyz.y()).Add(p.xyz.z());
  return print.Hex();
}

/// Which oracle judges the proposals: `auto` depends on the weights that are there. "" without proposals.
std::string OracleKey(const Run& run) { return ProposalInputs(run).empty() ? "" : ChooseOracle(run.options).Key(); }

/// The weights that training or what it learns from may ask.
std::string NetworksFingerprint(const Run& run) {
  const DepthSource depth = ChooseDepthSource(run.options);
  std::vector<std::filesystem::path> files;
  if (!depth.weights.empty() && NeedsDepth(run.options)) files.push_back(depth.weights);
  const bool proposals = ProposesViews(run.options) || !run.options.propose.proposal_folder.empty();
  if (proposals && run.options.train.proposal_lpips > 0) {
    const std::vector<std::filesystem::path> lpips = FindLpips(run.options.weights);
    files.insert(files.end(), lpips.begin(), lpips.end());
  }
  return WeightsFingerprint(files);
}

std::string TrainKey(const Run& run) {
  return Fingerprint()
      .Add(NetworksFingerprint(run))
      .Add(ShapingOptionsToJson(run.options).dump())
      .Add(InputsFingerprint(run))
      .Add(ProposalInputs(run))
      .Add(OracleKey(run))
      .Hex();
}

/// The newest checkpoint, when it belongs to these inputs; those of other photographs are removed.
std::optional<Checkpoint> FindCheckpoint(const Run& run, const nlohmann::json& saved_options) {
  const auto path = NewestCheckpoint(run.workspace.checkpoints());
  if (!path) return std::nullopt;
  Checkpoint checkpoint = ReadCheckpoint(*path);
  if (checkpoint.options == saved_options) {
    run.listener(Note{fmt::format("continuing from iteration {} ({})", checkpoint.iteration, path->string())});
    return checkpoint;
  }
  const std::string difference = DescribeDifference(checkpoint.options, run.options);
  if (!difference.empty()) {
    throw InputError(
        "{}: was saved with other options ({}); give the same options to continue, or start anew with "
        "--overwrite",
        path->string(), difference);
  }
  if (checkpoint.options.value("inputs", "") == saved_options.at("inputs") &&
      checkpoint.options.value("depth", "") == saved_options.at("depth") &&
      checkpoint.options.value("networks", "") == saved_options.at("networks") &&
      checkpoint.options.value("proposal_plan", "") == saved_options.at("proposal_plan") &&
      checkpoint.options.value("oracle_used", "") == saved_options.at("oracle_used")) {
    throw InputError(
        "{}: was saved by another version of the program, which had other options; start anew with "
        "--overwrite",
        path->string());
  }
  run.listener(Warning{
      "the photographs, poses, depth, proposals, weights or what judges the proposals have changed since the last "
      "run: training starts anew"});
  std::error_code error;
  std::filesystem::remove_all(run.workspace.checkpoints(), error);
  if (error) throw RunError("{}: cannot be removed: {}", run.workspace.checkpoints().string(), error.message());
  return std::nullopt;
}

Gaussians StartGaussians(Run* run, const Preparation& prepared, Device device) {
  const StartPoints start = ChooseStart(run, prepared.photos, prepared.sfm, prepared.geometry);
  const StartOptions& options = run->options.start;
  const double usual = start.source.rfind("dense", 0) == 0 ? kDenseScale : kSparseScale;
  return InitializeGaussians(
      start.cloud, {options.init_scale > 0 ? options.init_scale : usual, options.init_opacity, options.init_flatness},
      device);
}

nlohmann::json TimingsToJson(const TrainResult& result) {
  if (result.steps == 0) return nullptr;  // there was nothing left to do, which is not the same as no time
  const TrainTimings& t = result.timings;
  return {{"project", t.render.project},
          {"bin", t.render.bin},
          {"blend", t.render.blend},
          {"blend_backward", t.render.blend_backward},
          {"gaussian_backward", t.render.gaussian_backward},
          {"loss", t.loss},
          {"refine", t.refine},
          {"total", t.total}};
}

}  // namespace

bool IsTrained(const Run& run) { return run.workspace.IsDone("train", TrainKey(run)); }

void RunTrain(Run* run) {
  if (IsTrained(*run)) {
    run->listener(Note{"train: nothing has changed, point_cloud.ply is kept"});
    return;
  }
  const Device device = ChooseDevice(run->options.device.device, ProbeDevices());
  const std::string key = TrainKey(*run);
  std::error_code ignored;
  std::filesystem::remove(run->workspace.metrics(), ignored);  // would be mistaken for the results of these inputs
  std::vector<std::string> names;
  double loading = 0;
  std::string lpips;
  std::optional<Trainer> trainer;
  nlohmann::json saved_options = ShapingOptionsToJson(run->options);
  {  // What is known of the photographs is not kept beside the trainer's copy.
    const Preparation prepared = Prepare(run);
    const std::vector<LoadedView>& photos = prepared.photos;
    const Geometry& geometry = prepared.geometry;
    saved_options["inputs"] = InputsFingerprint(*run);
    saved_options["networks"] = NetworksFingerprint(*run);
    saved_options["depth"] = geometry.key;
    const ProposalPlan plan = RunPropose(run, photos, geometry, prepared.decided);
    saved_options["proposal_plan"] = plan.key;
    saved_options["oracle_used"] = OracleKey(*run);
    std::vector<TrainView> proposals = RunValidate(run, photos, geometry, plan);
    const std::optional<Checkpoint> checkpoint = FindCheckpoint(*run, saved_options);
    if (!checkpoint) {
      std::filesystem::remove(run->workspace.point_cloud(), ignored);
      std::filesystem::remove(run->workspace.exposures(), ignored);
    }
    Gaussians start = checkpoint ? checkpoint->gaussians : StartGaussians(run, prepared, device);
    const StageClock clock("train", run->listener);
    TellDevice(device, ProbeDevices(), run->listener);
    TrainingLpips network = LpipsOfProposals(run->options, proposals, run->listener);
    lpips = network.convention;
    trainer.emplace(TrainSetup{prepared.decided,
                               run->options.start.seed,
                               BackgroundColor(run->options.photo.background),
                               {TrainViews(photos, geometry), std::move(proposals), std::move(network.distance)},
                               std::move(start)},
                    [device](const TrainDeviceSetup& setup) { return MakeTrainDevice(device, setup); });
    if (checkpoint) trainer->Restore(*checkpoint);
    for (const LoadedView& photo : photos) names.push_back(photo.name);
    loading = clock.Seconds();
  }
  const RunOptions& options = run->options;
  const TrainResult result = trainer->Run(
      {run->workspace.checkpoints(), options.checkpoints.checkpoint_every, std::move(saved_options)}, run->listener);
  WriteGaussianPly(run->workspace.point_cloud(), trainer->gaussians(), options.train.sh_degree,
                   LicenceComments(NonCommercialParts(run->workspace)));
  std::filesystem::remove(run->workspace.exposures(), ignored);
  if (trainer->exposures().defined()) {
    WriteFileAtomically(run->workspace.exposures(), ExposuresToJson(names, trainer->exposures()).dump(1) + "\n");
  }
  run->listener(StageFinished{"train", loading + result.seconds});
  run->workspace.MarkDone("train", {{"key", key},
                                    {"seconds", loading + result.seconds},
                                    {"training_seconds", result.seconds},
                                    {"iterations", result.iterations},
                                    {"device", device.str()},
                                    {"milliseconds_per_iteration", TimingsToJson(result)},
                                    {"gaussians", trainer->gaussians().size()},
                                    {"lpips", lpips.empty() ? nlohmann::json() : nlohmann::json(lpips)},
                                    {"peak_memory_bytes", PeakMemoryBytes()},
                                    {"files", {"point_cloud.ply"}}});
  run->listener(FileWritten{run->workspace.point_cloud()});
}

}  // namespace oraclegs
