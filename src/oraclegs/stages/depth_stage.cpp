#include "oraclegs/stages/stage_works.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "oraclegs/core/text.h"
#include "oraclegs/depth/depth_files.h"
#include "oraclegs/depth/fusion.h"
#include "oraclegs/depth/gains.h"
#include "oraclegs/depth/given_depth.h"
#include "oraclegs/depth/overlap.h"
#include "oraclegs/depth/sensor_depth.h"
#include "oraclegs/depth/sensor_maps.h"
#include "oraclegs/networks/networks.h"
#include "oraclegs/scene/frame_comments.h"
#include "oraclegs/scene/sensor_files.h"
#include "oraclegs/stages/monocular_depth.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/stages/stereo_of_run.h"
#include "oraclegs/workspace/non_commercial.h"

namespace oraclegs {
namespace {

constexpr int kMonocularVersion = 2;         // likewise, of maps in which a network takes part
constexpr int kSensorVersion = 1;            // likewise, of maps in which a sensor takes part
constexpr int kDepthNetworkSide = 518;       // that Depth Anything reads of the shorter side
constexpr size_t kMinDensePoints = 1000;     // fewer are joined by a network's, where there is one
constexpr double kMinConfidentShare = 0.02;  // of a view's pixels, below which next to nothing is known
constexpr double kMinPromised = .3;          // of the pixels: where fewer are seen twice, little depth is no wonder
constexpr double kMinKept = .35;             // of these: textureless rooms keep more (docs/method.md#depth-confidence)

/// The paper's depth loss takes the network's maps whole.
bool IsWhole(const Run& run) {
  return run.plan.depth.prior == DepthPrior::kMonocular && run.options.train.depth_loss == DepthLoss::kPaper;
}

std::vector<std::string> NamesOf(const Run& run) {
  std::vector<std::string> names;
  for (const int view : run.split.train) names.push_back(run.scene.views[static_cast<size_t>(view)].name);
  return names;
}

void AddSensorKey(const Run& run, Fingerprint* key) {
  key->Add(kSensorVersion);
  for (const int v : run.split.train) {
    const SceneView& view = run.scene.views[static_cast<size_t>(v)];
    key->Add(view.depth_unit);
    for (const std::filesystem::path& file : {view.depth_path, view.confidence_path}) {
      if (file.empty()) {
        key->Add("none");
      } else {
        key->AddFile(file);
      }
    }
  }
}

/// The device is no part of it, as of no stage's: it may differ when a run is continued, and depth that another device
/// found is right in the same measure, if not in the same bits. The stage's record says which one it was.
void AddDepthKey(Run* run, Fingerprint* key) {
  const DepthSource& source = run->plan.depth;
  key->Add(ViewsKey(run, run->split.train, run->plan.image));
  key->Add(OptionsToJson(run->options.image).dump()).Add(OptionsToJson(run->options.stereo).dump());
  if (const std::filesystem::path& folder = run->options.depth.depth_folder; !folder.empty()) {
    for (const std::filesystem::path& file : GivenDepthFiles(folder, NamesOf(*run))) key->AddFile(file);
  }
  if (source.HasNetwork()) {
    key->Add(kMonocularVersion).Add(Word(source.prior)).Add(run->files.Of(source.weights));
    if (IsWhole(*run)) key->Add("whole");
  }
  if (source.prior == DepthPrior::kSensor) AddSensorKey(*run, key);
}

std::vector<DepthMap> ReadBack(const Run& run, const std::vector<LoadedView>& views) {
  std::vector<std::string> names;
  for (const LoadedView& view : views) names.push_back(view.name);
  return ReadDepthMaps(run.workspace.depth(), names, CamerasOf(views), WrittenFromRun(run.frame).scale);
}

/// Reads the written maps and fuses them, as a later run will, so that a continued run has the same bits as one that
/// was never stopped.
Geometry ReadGeometry(const Run& run, const std::vector<LoadedView>& views) {
  Geometry geometry;
  geometry.maps = ReadBack(run, views);
  geometry.gains = EstimateGains(geometry.maps, views);
  if (ExposureSpread(geometry.gains) <= kVariedExposure) {
    for (Eigen::Vector3f& gain : geometry.gains) gain.setOnes();
  }
  FusionOptions options = FusionOf(geometry.gains);
  options.min_confidence = ConfidenceOfPoints(geometry.maps);
  geometry.points = FuseDepth(geometry.maps, views, options);
  if (geometry.points.size() >= kMinDensePoints) return geometry;
  const std::vector<DensePoint> more = PriorPoints(geometry.maps, views, geometry.points, options);
  geometry.points.insert(geometry.points.end(), more.begin(), more.end());
  return geometry;
}

/// Brings what was predicted for larger images to the views' size.
void FitToViews(const std::vector<LoadedView>& views, std::vector<RelativeDepth>* predicted) {
  for (size_t v = 0; v < views.size(); ++v) {
    RelativeDepth& map = (*predicted)[v];
    ImageF small =
        ResizeArea({map.width, map.height, 1, std::move(map.values)}, views[v].rgb.width, views[v].rgb.height);
    map = {small.width, small.height, std::move(small.data)};
  }
}

/// The maps as they will be written.
struct FoundDepth {
  std::vector<DepthMap> maps;
  double right = 0;            ///< how often the network was right
  nlohmann::json sensor = {};  ///< what is known of the sensor's depth; null where none is used
};

nlohmann::json SensorRecord(const SensorMaps& combined, size_t of) {
  const SensorFit& fit = combined.fit;
  return {{"views", combined.views}, {"of", of},           {"checked", fit.checked},
          {"scale", fit.scale},      {"right", fit.right}, {"used", combined.used}};
}

/// Says in a line what is recorded of a sensor.
std::string DescribeSensor(const nlohmann::json& record) {
  const int64_t views = CountIn(record, "views"), of = CountIn(record, "of");
  if (views == 0) return fmt::format("depth of a sensor is used for none of {}", Counted(of, "photo"));
  const std::string scale = CountIn(record, "checked") > 0 ? fmt::format("scale {:.4g}", record.value("scale", 1.0))
                                                           : "its scale could not be checked";
  return fmt::format("depth of a sensor for {} of {}; {}; used on {:.0f} % of the pixels", views, Counted(of, "photo"),
                     scale, 100 * record.value("used", 0.0));
}

FoundDepth FindDepth(Run* run_, const TrainingViews& training) {
  const Run& run = *run_;
  const DepthSource& source = run.plan.depth;
  const std::vector<LoadedView>& views = training.views;
  if (const std::filesystem::path& folder = run.options.depth.depth_folder; !folder.empty()) {
    return {ReadGivenDepth(folder, NamesOf(run), WorkingCameras(run.scene, run.split.train, run.plan.image),
                           WrittenFromRun(run.frame).scale),
            0};
  }
  // First what is read: a damaged file is reported at once.
  const bool has_sensor = source.prior == DepthPrior::kSensor;
  std::vector<DepthMap> sensor;
  if (has_sensor) {
    sensor = ReadSensorMaps(run.scene, run.split.train, CamerasOf(views), WrittenFromRun(run.frame).scale);
  }
  std::vector<RelativeDepth> predicted;
  if (source.HasNetwork()) {
    const auto larger = LargerViews(run, kDepthNetworkSide);
    predicted = PredictRelativeDepth(source.weights, larger ? *larger : views, run.listener, run.plan.device);
    if (larger) FitToViews(views, &predicted);
  }
  std::vector<DepthMap> maps = std::exchange(run_->results->stereo, {});
  if (source.prior != DepthPrior::kMonocular && maps.empty()) maps = StereoOf(run, views, "depth");
  if (has_sensor) {
    SensorMaps combined = CombineWithSensor({views, training.silhouettes, SeenByTrainingViews(run)}, sensor,
                                            std::move(maps), run.listener);
    return {std::move(combined.maps), 0, SensorRecord(combined, views.size())};
  }
  if (!source.HasNetwork()) return {std::move(maps), 0};
  MonocularMaps of_network =
      WithMonocularDepth({predicted, IsWhole(run)}, views, std::move(maps), SeenByTrainingViews(run), run.listener);
  return {std::move(of_network.maps), of_network.right};
}

/// Mean over the views whose depth was looked for.
double MeanConfidentShare(const std::vector<DepthMap>& maps) {
  double sum = 0, searched = 0;
  for (const DepthMap& map : maps) sum += ConfidentShare(map), searched += map.size() > 0 ? 1 : 0;
  return searched > 0 ? sum / searched : 0;
}

/// Why far less depth was found than the views' overlap promises; "" where it was not.
std::string DescribeLack(const Run& run, const Overlap& overlap) {
  if (overlap.seen < kMinPromised || overlap.confident >= kMinKept) return "";
  const nlohmann::json sfm = run.workspace.Record("sfm");
  const nlohmann::json poses = sfm.is_object() ? sfm.value("poses", nlohmann::json()) : nlohmann::json();
  const bool are_off = !run.given && poses.is_object() && !poses.value("warning", "").empty();
  return fmt::format(
      "depth is confident on {:.0f} % of what another photo shows, too, which is far less than such an overlap usually "
      "gives: {}",
      100 * overlap.confident,
      are_off
          ? "the given poses do not fit the photos; see what was said of them"
          : "surfaces have no texture, shine or move, the light or the focus changes, or the poses are off; look at "
            "depth/preview");
}

void UndoDepth(Run* run, const nlohmann::json&) {
  std::error_code ignored;
  std::filesystem::remove(run->workspace.dense_ply(), ignored);  // first: without it what stands there is not believed
  std::filesystem::remove_all(run->workspace.depth(), ignored);
}

std::optional<nlohmann::json> MakeDepth(Run* run, const std::string&) {
  const DepthSource& source = run->plan.depth;
  const TrainingViews& training = ViewsOf(run);
  FoundDepth found = FindDepth(run, training);
  std::vector<std::string> files = WriteDepthMaps(run->workspace.depth(), found.maps, WrittenFromRun(run->frame).scale);
  for (std::string& file : files) file = "depth/" + file;
  found.maps = {};  // they are read back
  Geometry& geometry = run->results->geometry;
  geometry = ReadGeometry(*run, training.views);
  WriteDensePly(run->workspace.dense_ply(), geometry.points, WrittenFromRun(run->frame),
                WithOffset({}, run->frame.offset));
  files.emplace_back("sfm/dense.ply");
  const Overlap overlap = MeasureOverlap(geometry.maps, training.views, training.silhouettes);
  nlohmann::json record = {{"overlap", {{"seen", overlap.seen}, {"confident", overlap.confident}}},
                           {"warning", DescribeLack(*run, overlap)},
                           {"points", geometry.points.size()},
                           {"confident_share", MeanConfidentShare(geometry.maps)},
                           {"prior", Word(source.prior)},
                           {"right", found.right},
                           {"device", run->plan.device.Name()},
                           {"network", nlohmann::json()},
                           {"files", std::move(files)}};
  if (!found.sensor.is_null()) record["sensor"] = std::move(found.sensor);
  if (source.HasNetwork()) {
    record["network"] = DepthNetworkName(source.weights);
    if (IsNonCommercialDepthNetwork(record["network"])) NoteNonCommercial(record["network"], &record);
  }
  return record;
}

bool LoadDepth(Run* run) {
  run->results->geometry = ReadGeometry(*run, ViewsOf(run).views);
  return !run->results->geometry.maps.empty();
}

void ReportSource(const Run& run) {
  const DepthSource& source = run.plan.depth;
  if (source.HasNetwork()) {
    const double right = run.workspace.Record("depth").value("right", 0.0);
    run.listener(
        Note{fmt::format("{} ({}) is right to {:.0f} % on {:.0f} % of what it was tested on",
                         DepthNetworkName(source.weights), Word(source.prior), 100 * kRightWithin, 100 * right)});
  } else if (source.prior == DepthPrior::kSensor) {
    run.listener(Note{DescribeSensor(run.workspace.Record("depth").value("sensor", nlohmann::json::object()))});
  } else if (!run.options.depth.depth_folder.empty()) {
    run.listener(Note{fmt::format("depth is that of {}", run.options.depth.depth_folder.string())});
  } else if (run.options.depth.depth_prior.is_auto() && SensorDepthOf(run.scene) == SensorDepth::kSome) {
    run.listener(Note{fmt::format("{} of {} have a depth of a sensor, which is not used; --depth-prior sensor uses it",
                                  CountSensorDepth(run.scene), Counted(run.scene.views.size(), "photo"))});
  }
}

void ReportDepth(Run* run) {
  ReportSource(*run);
  const Geometry& geometry = run->results->geometry;
  std::vector<std::string> poor;
  for (const DepthMap& map : geometry.maps) {
    if (map.size() > 0 && ConfidentShare(map) < kMinConfidentShare) poor.push_back(map.name);
  }
  run->listener(
      Note{fmt::format("depth: confident on {:.0f} % of the pixels; {}", 100 * MeanConfidentShare(geometry.maps),
                       Counted(geometry.points.size(), "dense point"))});
  const std::string lack = run->workspace.Record("depth").value("warning", "");
  if (!lack.empty()) run->listener(Warning{lack});
  if (poor.empty()) return;
  run->listener(Warning{fmt::format(
      "hardly any depth was found in {}: no other photo shows the same surfaces from near by, or they have no texture; "
      "take more photos between them",
      fmt::join(poor, ", "))});
}

}  // namespace

StageWork DepthStage() {
  return {.wanted = [](const Run& run) { return run.plan.needs_depth; },
          .own = AddDepthKey,
          .undo = UndoDepth,
          .make = MakeDepth,
          .load = LoadDepth,
          .report = ReportDepth,
          .summary =
              [](const nlohmann::json& r) {
                return fmt::format("confident on {:.0f} % of the pixels, {}", 100 * r.value("confident_share", 0.0),
                                   Counted(CountIn(r, "points"), "dense point"));
              },
          .seconds =
              [](const EstimateInput& input) {
                constexpr double kFusion = 0.5;  // with the maps' files
                return kFusion + (input.refines_poses ? 0 : SecondsOfStereo(input));
              },
          .uses_network = [](const Run& run) { return run.plan.needs_depth && run.plan.depth.HasNetwork(); }};
}

void RequireDepth(Run* run) {
  if (run->options.depth.depth_prior == DepthPrior::kNone) {
    throw UsageError("--depth-prior none leaves no depth to find; leave it out");
  }
  if (run->plan.needs_depth) return;
  run->plan.needs_depth = true;
  run->plan.depth = ChooseDepthSource(run->options, SensorDepthOf(run->scene));
  run->plan.refines_poses = RefinesPoses(run->options, run->plan);
}

}  // namespace oraclegs
