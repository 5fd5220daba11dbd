#include "oraclegs/stages/train_inputs.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "oraclegs/depth/gains.h"
#include "oraclegs/stages/monocular_depth.h"

namespace oraclegs {
namespace {

constexpr double kOpacityNoise = 0.5, kObjectOpacityNoise = 0.3, kLastRates = 0.1;
// An object is seen from all around, every part of it in few views: overfitting costs more there than dropout blurs.
// Views that overlap much lose by it.
constexpr double kObjectDropout = 0.2;

// Proxy models that are trained nearly to the end err as the model itself does, but each in its own way, so that their
// mean is nearer to the truth than the model would come alone: it may be seen often, as far as it is right.
constexpr double kProxyDose = 0.5;

// 3DGS's learning rates are made for so many iterations. A run of fewer ends before its Gaussians have arrived: with
// rates times the root of the ratio, 1000 iterations come as far as 5000 did, and 5000 half a decibel further.
constexpr double kIterationsOfRates = 30000, kMaxRateScale = 6;

/// Settles what depends on the length of the run.
void SettleCourse(TrainOptions* options) {
  const int iterations = options->iterations.ValueOr(kUsualIterations);
  const double course = std::max<double>(iterations, options->horizon);
  const double rates = std::clamp(std::sqrt(kIterationsOfRates / course), 1., kMaxRateScale);
  options->rate_scale = options->rate_scale.ValueOr(rates);
  options->refine_start = options->refine_start.ValueOr(std::min(iterations / 10, kUsualRefineStart));
  options->refine_every = options->refine_every.ValueOr(std::clamp(iterations / 50, 10, kUsualRefineEvery));
  options->sh_degree_interval =
      options->sh_degree_interval.ValueOr(std::clamp(iterations / 5, 1, kUsualShDegreeInterval));
}

Buffer<float> ToMap(const std::vector<float>& values, const Camera& camera) {
  return Buffer<float>::From({camera.height, camera.width}, std::span<const float>(values));
}

/// The depth map as a target; what stereo is not confident of is ignored, what a network predicted in its place counts
/// as much as its confidence.
void AddDepth(const DepthMap& map, TrainView* view) {
  view->inv_depth = ToMap(map.inv_depth, map.camera);
  view->depth_mask = ToMap(map.confidence, map.camera);
  const float least = map.monocular ? 0.f : kConfident;
  for (float& confidence : view->depth_mask.span()) {
    if (confidence < least) confidence = 0;
  }
}

/// The mask of equation 5: 0 or 1. A network's map that was aligned is taken wherever the view's own mask allows; what
/// it puts behind infinity, where the map has no depth, is to be there.
void TakeWhole(const DepthMap& map, const AllowedPixels& allowed, TrainView* view) {
  const std::span<float> mask = view->depth_mask.span();
  const bool is_aligned = map.monocular && std::any_of(mask.begin(), mask.end(), [](float c) { return c > 0; });
  for (size_t i = 0; i < mask.size(); ++i) {
    const bool counts = is_aligned ? allowed.empty() || allowed[i] != 0 : mask[i] > 0;
    mask[i] = counts ? 1 : 0;
  }
}

/// Beside an object's silhouette there is nothing, at any distance.
void AddEmptiness(const Silhouettes& silhouettes, size_t v, TrainView* view) {
  const int64_t height = view->camera.height, width = view->camera.width;
  float* inv_depth = view->inv_depth.data();
  float* mask = view->depth_mask.data();
  for (int64_t i = 0; i < height * width; ++i) {
    if (silhouettes.MayContain(v, static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f)) continue;
    inv_depth[i] = 0;
    mask[i] = 1;
  }
}

ExposureMap Diagonal(const Eigen::Vector3f& gain) {
  ExposureMap map = kIdentityExposure;
  map[0] = gain[0], map[5] = gain[1], map[10] = gain[2];
  return map;
}

}  // namespace

TrainOptions SettleTrainOptions(TrainOptions options, const TrainingViews& training, const Geometry& geometry,
                                const Listener& listener) {
  const bool is_object = !training.silhouettes.empty();
  if (is_object) listener(Note{"an object before a plain background: its silhouettes bound the reconstruction"});
  SettleCourse(&options);
  options.opacity_noise = options.opacity_noise.ValueOr(is_object ? kObjectOpacityNoise : kOpacityNoise);
  options.last_rates = options.last_rates.ValueOr(kLastRates);
  options.dropout = options.dropout.ValueOr(is_object ? kObjectDropout : 0);
  if (!options.exposure.is_auto()) return options;
  options.exposure = geometry.HasVariedExposure() ? ExposureMode::kOn : ExposureMode::kOff;
  if (options.exposure == ExposureMode::kOn) {
    listener(Note{fmt::format("the images' exposures differ by {:.0f} %: a color map is learned for each (--exposure)",
                              100 * ExposureSpread(geometry.gains))});
  }
  return options;
}

TrainOptions SettleProxyDose(TrainOptions options, const std::vector<TrainView>& proposals, const Listener& listener) {
  if (proposals.empty() || !options.schedule.is_auto() || !options.synthetic_floor.is_auto()) return options;
  double squares = 0, pixels = 0;
  for (const TrainView& view : proposals) {
    for (const float u : view.pixel_weight.span()) squares += static_cast<double>(u) * static_cast<double>(u);
    pixels += static_cast<double>(view.pixel_weight.count());
  }
  options.schedule = ScheduleKind::kConstant;
  options.synthetic_floor = kProxyDose * squares / pixels;
  listener(Note{fmt::format("{:.0f} % of the iterations take a proposal (--set synthetic-floor)",
                            100 * options.synthetic_floor.value())});
  return options;
}

TrainOptions SettleUnion(TrainOptions options, size_t photos, size_t proposals) {
  if (options.schedule != ScheduleKind::kUnion) return options;
  options.schedule = ScheduleKind::kConstant;
  options.synthetic_floor = static_cast<double>(proposals) / static_cast<double>(photos + proposals);
  return options;
}

nlohmann::json ChosenOptions(const TrainOptions& asked, const TrainOptions& settled) {
  const nlohmann::json before = OptionsToJson(asked), after = OptionsToJson(settled);
  nlohmann::json chosen = nlohmann::json::object();
  for (const auto& [name, value] : before.items()) {
    if (value == "auto" && after.at(name) != "auto") chosen[name] = after.at(name);
  }
  return chosen;
}

std::vector<TrainView> MakeTrainViews(const TrainingViews& training, const Geometry& geometry, DepthLoss depth_loss) {
  const Silhouettes& silhouettes = training.silhouettes;
  std::vector<TrainView> views;
  for (size_t v = 0; v < training.views.size(); ++v) {
    views.push_back(ToTrainView(training.views[v]));
    if (!geometry.maps.empty()) {
      AddDepth(geometry.maps[v], &views.back());
      if (depth_loss == DepthLoss::kPaper) {
        TakeWhole(geometry.maps[v], PixelsWithDepth(training.views[v], silhouettes, v), &views.back());
      } else if (!silhouettes.empty()) {
        AddEmptiness(silhouettes, v, &views.back());
      }
    }
    if (!geometry.gains.empty()) views.back().exposure = Diagonal(geometry.gains[v]);
  }
  return views;
}

nlohmann::json ExposuresToJson(const std::vector<std::string>& names, const std::vector<ExposureMap>& exposures) {
  nlohmann::json json = nlohmann::json::object();
  for (size_t v = 0; v < names.size(); ++v) json[names[v]] = exposures[v];
  return json;
}

}  // namespace oraclegs
