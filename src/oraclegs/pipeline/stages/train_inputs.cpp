#include "oraclegs/pipeline/stages/train_inputs.h"

#include "oraclegs/depth/gains.h"
#include "oraclegs/depth/silhouettes.h"

namespace oraclegs {
namespace {

constexpr double kOpacityNoise = 0.5, kObjectOpacityNoise = 0.3, kLastRates = 0.1;
// An object is photographed from all around, every part of it by few: what is learnt by heart there costs more than
// what dropout blurs. Photographs that overlap much lose by it.
constexpr double kObjectDropout = 0.2;

Buffer<float> Picture(const std::vector<float>& values, const Camera& camera) {
  return torch::from_blob(const_cast<float*>(values.data()), {camera.height, camera.width}, torch::kFloat).Clone();
}

/// The depth map as a target; what stereo is not confident of counts nothing, what a network guessed in its place as
/// much as it is believed.
void AddDepth(const DepthMap& map, TrainView* view) {
  view->inv_depth = Picture(map.inv_depth, map.camera);
  view->depth_mask = Picture(map.confidence, map.camera);
  if (!map.monocular) view->depth_mask.masked_fill_(view->depth_mask < kConfident, 0);
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

TrainOptions DecideOptions(TrainOptions options, const std::vector<LoadedView>& photos, const Geometry& geometry,
                           const Listener& listener) {
  const bool is_object = !Silhouettes(photos).empty();
  if (is_object) listener(Note{"an object before a plain background: its silhouettes bound the reconstruction"});
  if (options.opacity_noise < 0) options.opacity_noise = is_object ? kObjectOpacityNoise : kOpacityNoise;
  if (options.last_rates == 0) options.last_rates = kLastRates;
  if (options.dropout < 0) options.dropout = is_object ? kObjectDropout : 0;
  if (options.exposure == "auto") {
    const double spread = ExposureSpread(geometry.gains);
    options.exposure = spread > kVariedExposure ? "on" : "off";
    if (options.exposure == "on") {
      listener(Note{
          fmt::format("the photographs' exposures differ by {:.0f} %: a colour map is learnt for each (--exposure)",
                      100 * spread)});
    }
  }
  return options;
}

std::vector<TrainView> TrainViews(const std::vector<LoadedView>& photos, const Geometry& geometry) {
  const Silhouettes silhouettes(photos);
  std::vector<TrainView> views;
  for (size_t v = 0; v < photos.size(); ++v) {
    views.push_back(ToTrainView(photos[v]));
    if (!geometry.maps.empty()) {
      AddDepth(geometry.maps[v], &views.back());
      if (!silhouettes.empty()) AddEmptiness(silhouettes, v, &views.back());
    }
    if (!geometry.gains.empty()) views.back().exposure = Diagonal(geometry.gains[v]);
  }
  return views;
}

nlohmann::json ExposuresToJson(const std::vector<std::string>& names, const Buffer<float>& exposures) {
  nlohmann::json json = nlohmann::json::object();
  const Buffer<float> rows = exposures.reshape({-1, 12}).To(kCpu);
  for (size_t v = 0; v < names.size(); ++v) {
    const float* row = rows.data() + 12 * v;
    json[names[v]] = std::vector<float>(row, row + 12);
  }
  return json;
}

}  // namespace oraclegs
