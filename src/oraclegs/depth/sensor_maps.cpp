#include "oraclegs/depth/sensor_maps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/core/statistics.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr size_t kMinKnownDepths = 11;   // that fix the scale of a view
constexpr size_t kMinPointsOfView = 30;  // sparse points that do so without stereo's help
constexpr double kMinSoundShare = 0.1;   // of a view's pixels that are confident: fewer are chance
constexpr double kMinRightShare = 0.5;   // of the known depths

/// Ratio of the known to the sensor's depth where the view has both; each > 0.
std::vector<double> RatiosOf(const DepthMap& sensor, const std::vector<KnownDepth>& known) {
  std::vector<double> ratios;
  if (sensor.size() == 0) return ratios;
  const Camera& camera = sensor.camera;
  for (const KnownDepth& k : known) {
    if (!(k.inv_depth > 0 && k.x >= 0 && k.y >= 0 && k.x < camera.width && k.y < camera.height)) continue;
    const size_t i = static_cast<size_t>(k.y) * static_cast<size_t>(camera.width) + static_cast<size_t>(k.x);
    if (sensor.confidence[i] >= kConfident) ratios.push_back(static_cast<double>(sensor.inv_depth[i]) / k.inv_depth);
  }
  return ratios;
}

bool IsNear(double ratio) { return std::abs(ratio - 1) < kRightWithin; }

bool SeesAnything(const DepthMap& map) {
  return std::any_of(map.inv_depth.begin(), map.inv_depth.end(), [](float w) { return w > 0; });
}

/// Depths that are known without the sensor.
std::vector<std::vector<KnownDepth>> KnownBeside(const SensorScene& scene, const std::vector<DepthMap>& stereo) {
  std::vector<std::vector<KnownDepth>> known;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    known.push_back(KnownDepths(scene.points, static_cast<int>(v), scene.views[v].camera));
    const bool is_stereo_sound = ConfidentShare(stereo[v]) >= kMinSoundShare;
    if (known[v].size() < kMinPointsOfView && is_stereo_sound) known[v] = ConfidentDepths(stereo[v]);
  }
  return known;
}

}  // namespace

SensorFit FitSensor(const std::vector<DepthMap>& sensor, const std::vector<std::vector<KnownDepth>>& known) {
  SensorFit fit;
  fit.fits.assign(sensor.size(), true);
  std::vector<std::vector<double>> ratios;
  std::vector<double> scales;
  for (size_t v = 0; v < sensor.size(); ++v) {
    ratios.push_back(RatiosOf(sensor[v], known[v]));
    if (ratios[v].size() >= kMinKnownDepths) scales.push_back(Median(ratios[v]));
  }
  fit.checked = scales.size();
  if (scales.empty()) return fit;
  fit.scale = Median(scales);
  size_t fitting = 0, right = 0, all = 0;
  for (size_t v = 0; v < sensor.size(); ++v) {
    if (ratios[v].size() < kMinKnownDepths) continue;
    fit.fits[v] = IsNear(Median(ratios[v]) / fit.scale);
    if (!fit.fits[v]) continue;
    ++fitting;
    all += ratios[v].size();
    for (const double ratio : ratios[v]) right += IsNear(ratio / fit.scale) ? 1 : 0;
  }
  fit.right = all == 0 ? 0 : static_cast<double>(right) / static_cast<double>(all);
  fit.is_usable = 2 * fitting > fit.checked && fit.right >= kMinRightShare;
  return fit;
}

DepthMap WithSensorDepth(DepthMap stereo, const DepthMap& sensor, const SensorFit& fit, const AllowedPixels& allowed,
                         double* used) {
  *used = 0;
  if (sensor.size() == 0) return stereo;
  DepthMap map = std::move(stereo);
  if (map.size() == 0) {
    map.inv_depth.assign(sensor.size(), 0);
    map.confidence.assign(sensor.size(), 0);
    map.normals.assign(sensor.size(), Eigen::Vector3f::Zero());
  }
  const float per_scale = static_cast<float>(1 / fit.scale), right = static_cast<float>(fit.right);
  size_t taken = 0;
  for (size_t i = 0; i < sensor.size(); ++i) {
    const float measured = sensor.inv_depth[i] * per_scale, sure = sensor.confidence[i] * right;
    if (!(measured > 0 && sure > 0) || (!allowed.empty() && allowed[i] == 0)) continue;
    const float stereo_sure = map.confidence[i];
    const bool agree = IsNear(static_cast<double>(map.inv_depth[i] / measured));
    const bool is_inside = sensor.confidence[i] >= kConfident;  // and not beside an edge
    const bool keeps = stereo_sure >= kConfident ? agree || !is_inside : stereo_sure >= sure;
    if (!keeps) {
      map.inv_depth[i] = measured;
      map.normals[i] = sensor.normals[i];
      ++taken;
    }
    map.confidence[i] = agree ? 1 - (1 - stereo_sure) * (1 - sure) : keeps ? stereo_sure : sure;
  }
  *used = static_cast<double>(taken) / static_cast<double>(sensor.size());
  return map;
}

SensorMaps CombineWithSensor(const SensorScene& scene, const std::vector<DepthMap>& sensor,
                             std::vector<DepthMap> stereo, const Listener& listener) {
  SensorMaps out;
  out.fit = FitSensor(sensor, KnownBeside(scene, stereo));
  out.maps = std::move(stereo);
  std::vector<std::string> blind, unlike;
  for (size_t v = 0; v < sensor.size(); ++v) {
    if (sensor[v].size() == 0) continue;
    const bool sees = SeesAnything(sensor[v]), fits = out.fit.fits[v];
    if (!sees) blind.push_back(sensor[v].name);
    if (sees && !fits) unlike.push_back(sensor[v].name);
    if (!sees || !fits || !out.fit.is_usable) continue;
    double share = 0;
    const AllowedPixels allowed = PixelsWithDepth(scene.views[v], scene.silhouettes, v);
    out.maps[v] = WithSensorDepth(std::move(out.maps[v]), sensor[v], out.fit, allowed, &share);
    out.used += share / static_cast<double>(sensor.size());
    ++out.views;
  }
  if (!blind.empty()) {
    listener(Warning{fmt::format(
        "the sensor's depth of {} is all unknown, or of low confidence; only stereo is used there", SomeNames(blind))});
  }
  if (!out.fit.is_usable) {
    listener(Warning{fmt::format(
        "the sensor's depth is not used: it agrees with no scale of the scene (right to {:.0f} % on {:.0f} % of what "
        "it "
        "was tested on); check that its files belong to these photos, and their unit, or give --depth-prior stereo",
        100 * kRightWithin, 100 * out.fit.right)});
  } else if (!unlike.empty()) {
    listener(Warning{fmt::format(
        "the sensor's depth of {} has another scale than that of the other photos; only stereo is used there",
        SomeNames(unlike))});
  }
  return out;
}

}  // namespace oraclegs
