#include "oraclegs/pipeline/depth_stage.h"

#include <algorithm>
#include <string>

#include "oraclegs/depth/depth_files.h"
#include "oraclegs/depth/gains.h"
#include "oraclegs/depth/stereo.h"
#include "oraclegs/pipeline/fingerprint.h"

namespace oraclegs {
namespace {

constexpr double kStereoVersion = 4;     // raised when the same inputs give other maps
constexpr double kNextToNothing = 0.02;  // share of confident pixels

std::string Key(const Run& run, const std::vector<ScenePoint>& points) {
  Fingerprint print;
  print.Add(kStereoVersion);
  print.Add(ViewsFingerprint(run.scene, run.split.train, run.options.photo.downscale))
      .Add(OptionsToJson(run.options.photo).dump())
      .Add(OptionsToJson(run.options.stereo).dump());
  for (const ScenePoint& p : points) {
    print.Add(p.xyz.x()).Add(p.xyz.y()).Add(p.xyz.z());
    for (const int view : p.views) print.Add(static_cast<double>(view));
  }
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

std::vector<DepthMap> ReadBack(const Run& run, const std::vector<Photo>& photos) {
  std::vector<std::string> names;
  std::vector<Camera> cameras;
  for (const Photo& photo : photos) {
    names.push_back(photo.name);
    cameras.push_back(photo.camera);
  }
  return ReadDepthMaps(run.workspace.depth(), names, cameras);
}

void Fuse(const std::vector<Photo>& photos, Geometry* geometry) {
  geometry->gains = EstimateGains(geometry->maps, photos);
  geometry->points = FuseDepth(geometry->maps, photos, FusionOf(geometry->gains));
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

Geometry RunDepth(Run* run, const std::vector<Photo>& photos, const std::vector<ScenePoint>& points) {
  const std::string key = Key(*run, points);
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
  if (!cached) {
    std::error_code ignored;
    std::filesystem::remove(run->workspace.dense_ply(),
                            ignored);  // first: without it what stands there is not believed
    std::filesystem::remove_all(run->workspace.depth(), ignored);
    std::vector<std::string> files = WriteDepthMaps(
        run->workspace.depth(), EstimateDepth(photos, SeenByPhotos(*run, points), run->options.stereo, run->listener));
    for (std::string& file : files) file = "depth/" + file;
    // What a later run will read, so that a continued run has the same bits as one that was never stopped.
    geometry.maps = ReadBack(*run, photos);
    Fuse(photos, &geometry);
    WriteDensePly(run->workspace.dense_ply(), geometry.points);
    files.emplace_back("sfm/dense.ply");
    run->workspace.MarkDone("depth", {{"key", key},
                                      {"seconds", clock.Seconds()},
                                      {"points", geometry.points.size()},
                                      {"confident_share", MeanConfidentShare(geometry.maps)},
                                      {"files", std::move(files)}});
  } else {
    Fuse(photos, &geometry);
  }
  clock.Finish();
  Tell(*run, geometry);
  return geometry;
}

}  // namespace oraclegs
