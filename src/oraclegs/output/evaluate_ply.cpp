#include "oraclegs/output/evaluate_ply.h"

#include <nlohmann/json.hpp>

#include "oraclegs/core/files.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/stage_clock.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Throws InputError when `dir` holds a metrics.json that this program has not written.
void RefuseForeignMetrics(const fs::path& dir) {
  const fs::path path = WorkspacePaths(dir).metrics();
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return;
  const nlohmann::json json = ParseJsonOrDiscard(ReadFile(path));
  // Early versions did not name the program.
  const bool ours = json.is_object() && (json.value("program", nlohmann::json()) == "oraclegs" ||
                                         (json.contains("test") && json.contains("gaussians")));
  if (!ours) throw InputError("{}: was not written by oraclegs; choose another -o", path.string());
}

/// Folder of the renders; empty without `out`.
fs::path PrepareFolder(const fs::path& out, const Scene& scene, const RunOptions& options) {
  if (out.empty()) return {};
  RequireOutsideScene(out, scene, options.input.images);
  if (IsWorkspace(out)) {
    throw InputError("{}: holds a run with its own metrics.json; choose another -o", out.string());
  }
  RefuseForeignMetrics(out);
  RequireWritableFolder(out);
  return WorkspacePaths(out).renders("test");
}

}  // namespace

nlohmann::json EvaluatePly(const EvaluateRequest& request, const PosedScene& posed, const Listener& listener) {
  const RunOptions& options = request.options;
  CheckRunOptions(options);
  const Plan plan = MakePlanToEvaluate(options);
  const Model model = LoadModel(request.ply, options, plan.device, posed.frame, listener);
  const fs::path renders = PrepareFolder(request.out, posed.scene, options);
  const StageClock clock("evaluate", listener);
  const nlohmann::json test =
      ScoreModel(model, LoadViews(posed.scene, posed.split.test, options.image.Settled(), listener), renders,
                 plan.lpips, listener);
  nlohmann::json metrics = {{"program", "oraclegs"},
                            {"version", request.version},
                            {"test", test},
                            {"stages", {{"evaluate", {{"seconds", clock.Finish()}}}}},
                            {"gaussians", model.gaussians.size()},
                            {"non_commercial", model.non_commercial},
                            {"peak_memory_bytes", PeakMemoryBytes()},
                            {"ply", request.ply.string()},
                            {"scene", posed.scene.root.string()},
                            {"views", {{"test", posed.split.test.size()}}},
                            {"options", RunOptionsToJson(options)},
                            {"seed", options.start.seed}};
  if (!request.out.empty()) {
    const fs::path path = WorkspacePaths(request.out).metrics();
    WriteFileAtomically(path, metrics.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    listener(FileWritten{path});
  }
  return metrics;
}

}  // namespace oraclegs
