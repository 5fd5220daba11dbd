#include "oraclegs/pipeline/stages/depth_stage.h"

#include <algorithm>
#include <memory>
#include <string>

#include "oraclegs/depth/depth_files.h"
#include "oraclegs/depth/gains.h"
#include "oraclegs/depth/plane_search.h"
#include "oraclegs/depth/prior_points.h"
#include "oraclegs/depth/stereo.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/pipeline/workspace/fingerprint.h"
#include "oraclegs/pipeline/stages/monocular_stage.h"
#include "oraclegs/pipeline/workspace/non_commercial.h"

namespace oraclegs {
namespace {

constexpr double kStereoVersion = 4;     // raised when the same inputs give other maps
constexpr double kMonocularVersion = 1;  // likewise, of maps in which a network has a part
constexpr double kNextToNothing = 0.02;  // share of confident pixels

/// What finds planes there; throws UsageError as ChooseDevice.
std::unique_ptr<PlaneSearch> SearchOn(Device device) {
  return device.is_cuda() ? MakeGpuPlaneSearch(device.index()) : MakeCpuPlaneSearch();
}

bool HasNetwork(const DepthSource& source) { return !source.weights.empty(); }

/// The device is no part of it, as of no stage's: it may differ when a run is continued, and depth that another device
/// found is right in the same measure, if not in the same bits. The stage's record says which one it was.
std::string Key(const Run& run, const std::vector<ScenePoint>& points, const DepthSource& source) {
  Fingerprint print;
  print.Add(kStereoVersion);
  print.Add(ViewsFingerprint(run.scene, run.split.train, run.options.photo.downscale))
      .Add(OptionsToJson(run.options.photo).dump())
      .Add(OptionsToJson(run.options.stereo).dump());
  for (const ScenePoint& p : points) {
    print.Add(p.xyz.x()).Add(p.xyz.y()).Add(p.xyz.z());
    for (const int view : p.views) print.Add(static_cast<double>(view));
  }
  if (HasNetwork(source)) print.Add(kMonocularVersion).Add(source.Name()).AddFile(source.weights);
  return print.Hex();
}

/// Points whose views are indices of the training photographs.
std::vector<ScenePoint> SeenByPhotos(const Run& run, std::vector<ScenePoint> points) {
  for (ScenePoint& point : points) {
    std::vector<int> photos;
    for (const int view : point.views) {
      const auto found = std::find(run.split.train.begin(), run.split.train.end(), view);
      if (found != run.split.train.end()) photos.push_back(static_cast<int>(found - run.split.train.begin()));
    }
    point.views = std::move(photos);
  }
  return points;
}

std::vector<DepthMap> ReadBack(const Run& run, const std::vector<LoadedView>& photos) {
  std::vector<std::string> names;
  std::vector<Camera> cameras;
  for (const LoadedView& photo : photos) {
    names.push_back(photo.name);
    cameras.push_back(photo.camera);
  }
  return ReadDepthMaps(run.workspace.depth(), names, cameras);
}

void Fuse(const std::vector<LoadedView>& photos, Geometry* geometry) {
  geometry->gains = EstimateGains(geometry->maps, photos);
  const FusionOptions options = FusionOf(geometry->gains);
  geometry->points = FuseDepth(geometry->maps, photos, options);
  if (geometry->points.size() >= kFewDensePoints) return;
  const std::vector<DensePoint> more = PriorPoints(geometry->maps, photos, geometry->points, options);
  geometry->points.insert(geometry->points.end(), more.begin(), more.end());
}

/// The maps as they will be written, and how often the network was right.
MonocularMaps FindDepth(const Run& run, const std::vector<LoadedView>& photos, const std::vector<ScenePoint>& points,
                        const DepthSource& source, Device device) {
  const std::vector<ScenePoint> seen = SeenByPhotos(run, points);
  std::vector<RelativeDepth> guesses;  // first: a damaged file is told at once
  if (HasNetwork(source)) guesses = GuessDepth(source.weights, photos, run.listener, device);
  std::vector<DepthMap> maps;
  if (source.prior != DepthPrior::kMonocular) {
    maps = EstimateDepth(photos, seen, run.options.stereo, SearchOn(device).get(), run.listener);
  }
  if (!HasNetwork(source)) return {std::move(maps), 0};
  return WithMonocularDepth(guesses, photos, std::move(maps), seen, run.listener);
}

nlohmann::json NetworkName(const DepthSource& source) {
  return HasNetwork(source) ? nlohmann::json(DepthNetworkName(source.weights)) : nlohmann::json();
}

/// Said where --depth-prior auto leaves out what the user could have.
void TellMissingNetwork(const Run& run, const DepthSource& source) {
  if (run.options.depth.depth_prior != "auto" || HasNetwork(source)) return;
  run.listener(Note{fmt::format("depth is from stereo alone: there are no weights of Depth Anything V2; {}",
                                HowToFetch(kDepthModel))});
}

double MeanConfidentShare(const std::vector<DepthMap>& maps) {
  double sum = 0;
  for (const DepthMap& map : maps) sum += ConfidentShare(map);
  return maps.empty() ? 0 : sum / static_cast<double>(maps.size());
}

void Tell(const Run& run, const Geometry& geometry) {
  std::vector<std::string> poor;
  for (const DepthMap& map : geometry.maps) {
    if (ConfidentShare(map) < kNextToNothing) poor.push_back(map.name);
  }
  run.listener(Note{fmt::format("depth is confident on {:.0f} % of the pixels; {} dense points",
                                100 * MeanConfidentShare(geometry.maps), geometry.points.size())});
  if (poor.empty()) return;
  run.listener(Warning{fmt::format(
      "hardly any depth was found in {}: no other photograph shows the same surfaces from near by, or they have no "
      "texture; take more photographs between them",
      fmt::join(poor, ", "))});
}

}  // namespace

FusionOptions FusionOf(const std::vector<Eigen::Vector3f>& gains) {
  FusionOptions options;
  if (ExposureSpread(gains) > kVariedExposure) options.gains = gains;
  return options;
}

Geometry RunDepth(Run* run, const std::vector<LoadedView>& photos, const std::vector<ScenePoint>& points) {
  const DepthSource source = ChooseDepthSource(run->options);
  if (source.prior == DepthPrior::kNone) throw UsageError("--depth-prior none leaves no depth to find; leave it out");
  const std::string key = Key(*run, points, source);
  Geometry geometry;
  geometry.key = key;
  if (run->workspace.IsDone("depth", key)) {
    try {
      geometry.maps = ReadBack(*run, photos);
    } catch (const InputError& damage) {
      run->listener(Warning{fmt::format("{}; the depth is found again", damage.what())});
    }
  }
  const bool cached = !geometry.maps.empty();
  const StageClock clock("depth", run->listener);
  TellMissingNetwork(*run, source);
  double right = cached ? run->workspace.Record("depth").value("right", 0.0) : 0;
  if (!cached) {
    const Device device = ChooseDevice(run->options.device.device, ProbeDevices());
    std::error_code ignored;
    std::filesystem::remove(run->workspace.dense_ply(),
                            ignored);  // first: without it what stands there is not believed
    std::filesystem::remove_all(run->workspace.depth(), ignored);
    MonocularMaps found = FindDepth(*run, photos, points, source, device);
    right = found.right;
    std::vector<std::string> files = WriteDepthMaps(run->workspace.depth(), found.maps);
    found.maps = {};  // they are read back
    for (std::string& file : files) file = "depth/" + file;
    // What a later run will read, so that a continued run has the same bits as one that was never stopped.
    geometry.maps = ReadBack(*run, photos);
    Fuse(photos, &geometry);
    WriteDensePly(run->workspace.dense_ply(), geometry.points);
    files.emplace_back("sfm/dense.ply");
    nlohmann::json record = {{"key", key},
                             {"seconds", clock.Seconds()},
                             {"points", geometry.points.size()},
                             {"confident_share", MeanConfidentShare(geometry.maps)},
                             {"prior", source.Name()},
                             {"right", right},
                             {"device", device.str()},
                             {"network", NetworkName(source)},
                             {"files", std::move(files)}};
    if (HasNetwork(source) && IsNonCommercialDepthNetwork(record["network"])) {
      NoteNonCommercial(record["network"], &record);
    }
    run->workspace.MarkDone("depth", std::move(record));
  } else {
    Fuse(photos, &geometry);
  }
  clock.Finish();
  if (HasNetwork(source)) {
    run->listener(Note{fmt::format("{} ({}) is right to {:.0f} % on {:.0f} % of what it was tested on",
                                   DepthNetworkName(source.weights), source.Name(), 100 * kRightWithin, 100 * right)});
  }
  Tell(*run, geometry);
  return geometry;
}

}  // namespace oraclegs
