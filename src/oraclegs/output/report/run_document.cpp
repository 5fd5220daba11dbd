#include "oraclegs/output/report/run_document.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/evaluate/uncertainty.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/spatial_order.h"
#include "oraclegs/formats/values.h"
#include "oraclegs/gaussians/selection.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/output/live/curves.h"
#include "oraclegs/output/live/run_state.h"
#include "oraclegs/output/report/report_files.h"
#include "oraclegs/output/report/report_views.h"
#include "oraclegs/render/recolor.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/settings/named_options.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/stages/run_observer.h"
#include "oraclegs/workspace/non_commercial.h"
#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int64_t kPlanPoints = 20000;  // points of the map from above
constexpr float kSolid = 0.5f;          // opacity from which the map shows a Gaussian

std::string ValueText(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const json& part : value) {
    if (!text.empty()) text += ',';
    text += ValueText(part);
  }
  return text;
}

/// Record of a stage, or an empty object.
json RecordOf(const Run& run, const std::string& stage) {
  const json record = run.workspace.Record(stage);
  return record.is_object() ? record : json::object();
}

/// JSON file of the workspace; null when it is missing or damaged, which only leaves out a part of the page.
json ReadOptional(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return nullptr;
  const json read = ParseJsonOrDiscard(ReadFile(path));
  return read.is_discarded() ? json() : read;
}

json OptionRows(const RunOptions& options) {
  const json now = RunOptionsToJson(options), usual = RunOptionsToJson(RunOptions{});
  json rows = json::array();
  for (const auto& [name, value] : now.items()) {
    rows.push_back({{"name", name}, {"value", ValueText(value)}, {"changed", value != usual.value(name, json())}});
  }
  return rows;
}

json StageRows(const Run& run) {
  json rows = json::array();
  for (const Stage& stage : *run.stages) {
    const json record = RecordOf(run, stage.name);
    if (record.contains("seconds")) rows.push_back({{"name", stage.name}, {"seconds", record.at("seconds")}});
  }
  return rows;
}

json Triple(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Position and size of the scene, which need no splat.
json PlaceOf(const Run& run) {
  const std::vector<Camera> cameras = WorkingCameras(run.scene, run.split.train, run.plan.image);
  const Ball ball = LookedAt(cameras);
  return {{"up", Triple(MeanUp(cameras))}, {"center", Triple(ball.center)}, {"radius", ball.radius}};
}

json SplatOf(const Model& model, const ReportFiles& files) {
  const std::vector<int64_t> order = SpatialOrder(model.gaussians.To(kCpu));  // compresses better
  const std::string spz = EncodeSpz(Picked(model.gaussians, order), model.render.sh_degree);
  json splat = files.Bytes("splat.spz", spz);
  splat["format"] = "spz";
  splat["gaussians"] = model.gaussians.size();
  splat["bytes"] = spz.size();
  splat["sh_degree"] = model.render.sh_degree;
  const GaussianMarks marks = Picked(model.marks, order);
  if (!marks.support.empty()) splat["support"] = files.Bytes("support.bin", MarkBytes(marks.support, 1));
  if (!marks.uncertainty.empty()) {
    splat["uncertainty"] = files.Bytes("uncertainty.bin", MarkBytes(marks.uncertainty, kLargestShownError));
  }
  return splat;
}

/// Positions and colors of some solid Gaussians, evenly spaced in their list.
json PlanOf(const Model& model, const ReportFiles& files) {
  const Gaussians host = model.gaussians.To(kCpu);
  std::vector<int64_t> solid;
  for (int64_t i = 0; i < host.size(); ++i) {
    if (Sigmoid(host.opacity_logits[i]) >= kSolid) solid.push_back(i);
  }
  const auto n = std::min<int64_t>(kPlanPoints, static_cast<int64_t>(solid.size()));
  std::string bytes;
  for (int64_t k = 0; k < n; ++k) {
    const GaussianRows row = host.Rows().From(solid[static_cast<size_t>(k * static_cast<int64_t>(solid.size()) / n)]);
    bytes.append(reinterpret_cast<const char*>(row.means), 3 * sizeof(float));
    for (int c = 0; c < 3; ++c) {
      const double value = 0.5 + kConstantSh * static_cast<double>(row.sh[c]);
      bytes += static_cast<char>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
    }
  }
  json points = files.Bytes("points.bin", bytes);
  points["count"] = n;
  return points;
}

/// Shares of the Gaussians, added to those of the pixels.
json SupportOf(const Model& model, const json& metrics) {
  if (model.marks.support.empty()) return nullptr;
  json support = metrics.value("support", json::object());
  std::array<double, kSupportClasses> shares{};
  for (const float value : model.marks.support)
    shares[static_cast<size_t>(SupportClassOf(value))] += 1.0 / static_cast<double>(model.marks.support.size());
  if (!support.contains("classes")) {
    for (int c = 0; c < kSupportClasses; ++c)
      support["classes"].push_back({{"name", NameOf(static_cast<SupportClass>(c))}});
  }
  for (size_t c = 0; c < kSupportClasses; ++c) support["classes"][c]["gaussians"] = shares[c];
  return support;
}

json RegistrationOf(const Run& run, const json& advice) {
  json registration = ReadOptional(run.workspace.sfm() / "registration.json");
  if (!registration.is_object()) {
    if (advice.empty()) return nullptr;
    registration = json::object();
  }
  registration["advice"] = advice;
  if (!registration.contains("views")) return registration;
  for (json& view : registration["views"]) {
    view["registered"] = view.value("status", "") == "registered";
    view.erase("neighbors");
  }
  return registration;
}

/// Confidence against truth in plain words, where `evaluate --check-oracle` has measured it; else null.
json CalibrationOf(const Run& run) {
  const json oracle = ReadOptional(run.workspace.root() / "oracle.json");
  if (!oracle.is_object() || !oracle.contains("oracle")) return nullptr;
  return {{"title", "Trust in the invented views against photos from the same poses"},
          {"x_name", "trust"},
          {"y_name", "similarity"},
          {"bins", oracle["oracle"].value("reliability", json::array())}};
}

json LicensesOf(const std::vector<std::string>& non_commercial) {
  json rows = {{{"name", "OracleGS"}, {"license", "Apache-2.0"}, {"note", "made this splat"}},
               {{"name", "Spark"}, {"license", "MIT"}, {"note", "draws it in this page"}},
               {{"name", "three.js"}, {"license", "MIT"}, {"note", "draws it in this page"}}};
  for (const std::string& name : non_commercial) {
    rows.push_back({{"name", name},
                    {"license", "non-commercial"},
                    {"note", "took part in this run: its result may not be used commercially"}});
  }
  return rows;
}

/// Adds the scores of each test view to its row.
void AddScores(const json& metrics, json* views) {
  for (const json& scored : metrics.at("test").value("views", json::array())) {
    for (json& row : *views) {
      if (row["role"] != "test" || row["name"] != scored["name"]) continue;
      for (const char* score : {"psnr", "ssim", "lpips", "psnr_color_corrected", "psnr_mean_exposure"}) {
        if (scored.contains(score) && scored[score].is_number())
          row[score] = scored[score];  // an infinite score is null
      }
    }
  }
}

/// Render of the best test view; without test views, of the first training view.
json HeroOf(const json& views) {
  const json* best = nullptr;
  for (const json& view : views) {
    if (!view.contains("render") || view["role"] == "proposal") continue;
    if (best == nullptr || view.value("psnr", -1.0) > best->value("psnr", -1.0)) best = &view;
  }
  if (best == nullptr) return nullptr;
  json hero = best->at("render");
  hero["caption"] = fmt::format("{}, {}", best->at("name").get<std::string>(),
                                best->at("role") == "test" ? "a view that was not trained on" : "a training view");
  return hero;
}

/// The name of the workspace, which the user chose; that of the scene is often "images".
std::string TitleOf(const Run& run) {
  const fs::path root = fs::absolute(run.workspace.root()).lexically_normal();
  return (root.has_filename() ? root : root.parent_path()).filename().string();
}

json BeginDocument(const Run& run) {
  return {{"format", 1},
          {"kind", "run"},
          {"title", TitleOf(run)},
          {"program", "oraclegs " + run.version},
          {"created", UtcNow()},
          {"finished", false},
          {"device", run.plan.device.Name()},
          {"options", OptionRows(run.options)},
          {"command", CommandOf(run)},
          {"stages", StageRows(run)}};
}

void Write(const Run& run, const json& document) {
  WriteFileAtomically(run.workspace.report() / "run.json",
                      document.dump(-1, ' ', false, json::error_handler_t::replace) + "\n");
}

void WriteStartDocument(Run* run) {
  try {
    std::error_code ignored;
    run->workspace.MarkUndone("report");  // the record there is of an older training
    fs::remove_all(run->workspace.report(), ignored);
    fs::remove(run->workspace.report_page(), ignored);
    const ReportFiles files(run->workspace.root());
    const std::vector<LoadedView>& training = ViewsOf(run).views;
    json document = BeginDocument(*run);
    document["splat"] = nullptr;
    document["place"] = PlaceOf(*run);
    ReportViews views(*run, files, nullptr);
    for (const LoadedView& view : training) views.AddTraining(view);
    views.AddProposals();
    document["views"] = views.Rows();
    Write(*run, document);
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {  // a run does not fail for its report
    run->listener(Warning{fmt::format("{}; the viewer has no images of this run", error.what())});
  }
}

/// Writes the document twice, so that the first photo is there at once. A photo that cannot be read is passed over.
void WritePhotosDocument(const Run& run) {
  constexpr size_t kShownPhotos = 12;  // each takes up to half a second to read
  const ReportFiles files(run.workspace.root());
  ReportViews views(run, files, nullptr);
  json document = BeginDocument(run);
  document["splat"] = nullptr;
  for (const SceneView& view : Evenly(run.scene.views, kShownPhotos)) {
    try {
      views.AddPhoto(view.name, ReadImage(view.image_path));
    } catch (const InputError&) {
      continue;  // is said when it is needed
    }
    document["views"] = views.Rows();
    if (views.Rows().size() == 1) Write(run, document);
  }
  if (views.Rows().size() > 1) Write(run, document);
}

}  // namespace

std::string CommandOf(const Run& run) {
  const json now = RunOptionsToJson(run.options), usual = RunOptionsToJson(RunOptions{});
  std::string command = fmt::format("oraclegs reconstruct {} -o {}",
                                    ShellQuoted(fs::absolute(run.scene.root).lexically_normal().string()),
                                    ShellQuoted(fs::absolute(run.workspace.root()).lexically_normal().string()));
  for (const auto& [name, value] : now.items()) {
    if (value == usual.value(name, json())) continue;
    for (const std::string& word : RunOptionWords(name, value)) command.append(" ").append(ShellQuoted(word));
  }
  return command;
}

void ShowDocument(Run* run, const std::string& stage) {
  if (!run->options.report.report) return;
  const json shown = ReadOptional(run->workspace.report() / "run.json");
  // A finished report whose document is lost is made again, and not covered up.
  if (stage == kPhotosRead && shown.is_null() && run->workspace.Record("report").is_null()) WritePhotosDocument(*run);
  const bool is_finished = shown.is_object() && shown.value("finished", false);
  if (stage == "train" || (stage == "register" && !is_finished)) WriteStartDocument(run);
}

json WriteRunDocument(Run* run, const Model& model, const fs::path& video) {
  std::error_code ignored;
  fs::remove_all(run->workspace.report(), ignored);
  const ReportFiles files(run->workspace.root());
  const std::string unfinished = UnfinishedSplat(run->workspace.root());
  const json metrics = unfinished.empty() ? ReadMetrics(run->workspace.root()) : json{{"test", json::object()}};
  json document = BeginDocument(*run);
  document["finished"] = true;
  if (!unfinished.empty()) document["unfinished"] = unfinished;
  document["place"] = PlaceOf(*run);
  document["splat"] = SplatOf(model, files);
  document["splat"].update(document["place"]);
  ReportViews views(*run, files, &model);
  const auto load = [&](int view) {  // one at a time, since all may not fit into memory
    return std::move(LoadViews(run->scene, {view}, run->plan.image, Silent()).front());
  };
  const TrainingViews* training = run->results->views.get();
  for (const int view : Evenly(run->split.train, kReportedViews)) {
    const auto at = std::find(run->split.train.begin(), run->split.train.end(), view) - run->split.train.begin();
    views.AddTraining(training != nullptr ? training->views[static_cast<size_t>(at)] : load(view));
  }
  views.AddProposals();
  for (const int view : Evenly(run->split.test, kReportedViews)) views.AddTest(load(view));
  views.AddSpares();
  const json advice = views.Advice();
  document["views"] = views.Rows();
  AddScores(metrics, &document["views"]);
  document["hero"] = HeroOf(document["views"]);
  if (!video.empty()) document["video"] = {{"url", video.lexically_relative(run->workspace.root()).generic_string()}};
  document["points"] = PlanOf(model, files);
  document["scores"] = metrics.at("test");
  document["scores"].erase("views");
  document["mean_exposure"] = fs::exists(run->workspace.exposures(), ignored);
  const std::vector<CurveRow> curve = ReadCurves(run->workspace.curves());
  document["curves"] = curve.empty() ? json::array() : CurvesToJson(curve);
  document["support"] = SupportOf(model, metrics);
  document["uncertainty"] = metrics.value("uncertainty", json());
  document["registration"] = RegistrationOf(*run, advice);
  document["poses"] = metrics.value("poses", json());
  document["calibration"] = CalibrationOf(*run);
  document["warnings"] = metrics.value("warnings", json::array());
  document["non_commercial"] = NonCommercialParts(run->workspace);
  document["licenses"] = LicensesOf(NonCommercialParts(run->workspace));
  document["memory_bytes"] = metrics.value("peak_memory_bytes", int64_t{0});
  Write(*run, document);
  return document;
}

}  // namespace oraclegs
