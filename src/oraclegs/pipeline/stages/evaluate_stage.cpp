#include "oraclegs/pipeline/stages/evaluate_stage.h"

#include "oraclegs/core/files.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/pipeline/workspace/fingerprint.h"
#include "oraclegs/pipeline/workspace/metrics.h"
#include "oraclegs/pipeline/workspace/non_commercial.h"
#include "oraclegs/pipeline/stages/perceptual.h"
#include "oraclegs/pipeline/settings/weights.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

struct Scores {
  nlohmann::json test;
  int64_t gaussians = 0;
};

Scores Score(const Model& model, const std::vector<LoadedView>& photos, const EvaluateExtras& extras,
             const Listener& listener) {
  Scores scores;
  scores.gaussians = model.gaussians.size();
  if (photos.empty()) {
    listener(Warning{"there are no test views: nothing is scored (see --test-every)"});
  }
  scores.test = ToJson(Evaluate(model.gaussians, photos, model.render, extras, listener));
  return scores;
}

/// Throws when a metrics.json stands in `dir` that this program has not written.
void RefuseForeignMetrics(const fs::path& dir) {
  const fs::path path = WorkspacePaths(dir).metrics();
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(path), nullptr, false);
  // The first versions did not name the program.
  const bool ours = json.is_object() && (json.value("program", nlohmann::json()) == "oraclegs" ||
                                         (json.contains("test") && json.contains("gaussians")));
  if (!ours) throw InputError("{}: was not written by oraclegs; choose another -o", path.string());
}

void RemoveOldRenders(const fs::path& dir) {
  std::error_code error;
  fs::remove_all(dir, error);
  if (error) throw RunError("{}: cannot be removed: {}", dir.string(), error.message());
}

}  // namespace

Model LoadModel(const fs::path& ply, const RunOptions& options) {
  const Device device = ChooseDevice(options.device.device, ProbeDevices());
  GaussianPly file = ReadGaussianPly(ply);
  file.gaussians.ForEach([&](const char*, Buffer<float>& t) { t = t.To(device); });
  return {std::move(file.gaussians),
          {BackgroundColor(options.photo.background), file.sh_degree, options.train.antialiased},
          PartsInComments(file.comments)};
}

void RunEvaluate(Run* run) {
  const Workspace& workspace = run->workspace;
  std::error_code ignored;
  if (!fs::exists(workspace.point_cloud(), ignored)) {
    throw InputError("{}: does not exist; run `oraclegs train` first, or name a point cloud with --ply",
                     workspace.point_cloud().string());
  }
  const std::vector<fs::path> lpips = FindLpips(run->options.weights);
  const std::string key = Fingerprint()
                              .Add(WeightsFingerprint(lpips))
                              .Add(ShapingOptionsToJson(run->options).dump())
                              .Add(ViewsFingerprint(run->scene, run->split.test, run->options.photo.downscale))
                              .AddFile(workspace.point_cloud())
                              .Hex();
  if (workspace.IsDone("evaluate", key)) {
    run->listener(Note{"evaluate: nothing has changed, metrics.json is kept"});
    return;
  }
  const StageClock clock("evaluate", run->listener);
  RemoveOldRenders(workspace.renders("test"));
  const Scores scores = Score(LoadModel(workspace.point_cloud(), run->options),
                              LoadViews(run->scene, run->split.test, run->options.photo, run->listener),
                              {workspace.renders("test"), LpipsScores(lpips)}, run->listener);
  const double seconds = clock.Finish();
  nlohmann::json record = {{"key", key},
                           {"seconds", seconds},
                           {"test", scores.test},
                           {"gaussians", scores.gaussians},
                           {"peak_memory_bytes", PeakMemoryBytes()},
                           {"files", {"metrics.json"}}};
  WriteFileAtomically(workspace.metrics(), MetricsToJson(*run, record).dump(2) + "\n");
  run->workspace.MarkDone("evaluate", record);
  run->listener(FileWritten{workspace.metrics()});
}

nlohmann::json EvaluatePly(const EvaluateRequest& request, const PosedScene& posed, const Listener& listener) {
  CheckRunOptions(request.options);
  const Model model = LoadModel(request.ply, request.options);
  const std::vector<fs::path> lpips = FindLpips(request.options.weights);
  fs::path renders;
  if (!request.out.empty()) {
    RequireOutsideScene(request.out, posed.scene, request.options.input.images);
    if (IsWorkspace(request.out)) {
      throw InputError("{}: holds a run with its own metrics.json; choose another -o", request.out.string());
    }
    RefuseForeignMetrics(request.out);
    RequireWritableFolder(request.out);
    renders = WorkspacePaths(request.out).renders("test");
  }
  const StageClock clock("evaluate", listener);
  const Scores scores = Score(model, LoadViews(posed.scene, posed.split.test, request.options.photo, listener),
                              {renders, LpipsScores(lpips)}, listener);
  nlohmann::json metrics = {{"program", "oraclegs"},
                            {"version", request.version},
                            {"test", scores.test},
                            {"stages", {{"evaluate", {{"seconds", clock.Finish()}}}}},
                            {"gaussians", scores.gaussians},
                            {"non_commercial", model.non_commercial},
                            {"peak_memory_bytes", PeakMemoryBytes()},
                            {"ply", request.ply.string()},
                            {"scene", posed.scene.root.string()},
                            {"views", {{"test", posed.split.test.size()}}},
                            {"options", RunOptionsToJson(request.options)},
                            {"seed", request.options.start.seed}};
  if (!request.out.empty()) {
    const fs::path path = WorkspacePaths(request.out).metrics();
    WriteFileAtomically(path, metrics.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    listener(FileWritten{path});
  }
  return metrics;
}

}  // namespace oraclegs
