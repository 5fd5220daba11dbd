#include "oraclegs/stages/train_inputs.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/depth/gains.h"
#include "oraclegs/image/color_error.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/propose/warp.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/stages/monocular_depth.h"

namespace oraclegs {
namespace {

constexpr double kLargestExposure = 1e6;  // of a number in a color map
constexpr float kBackdropNoise = 0.006f;  // ColorError of plain background: a proposal is rounded to bytes
constexpr double kMaskedShare = 0.9;      // of an object's surroundings

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

/// True where masks show the silhouette, and not a plain color whose photos are masked where the lens saw nothing.
bool AreSurroundingsMasked(const std::vector<uint8_t>& object, const std::vector<uint8_t>& mask) {
  size_t masked = 0, all = 0;
  for (size_t i = 0; i < mask.size(); ++i) {
    all += object[i] == 0;
    masked += object[i] == 0 && mask[i] == 0;
  }
  return masked > 0 && static_cast<double>(masked) >= kMaskedShare * static_cast<double>(all);
}

/// Shows nothing where the surroundings of an object are masked, so that no Gaussian there is free: what is masked of
/// any other photo is unknown.
void ShowNothingBeside(const std::vector<uint8_t>& object, const std::array<float, 3>& background, TrainView* view) {
  view->image = view->image.Clone();
  view->alpha = Buffer<float>::Empty({view->camera.height, view->camera.width});
  for (size_t i = 0; i < object.size(); ++i) {
    view->alpha.data()[i] = object[i];
    if (object[i] != 0 || view->pixel_weight.data()[i] > 0) continue;
    std::copy(background.begin(), background.end(), view->image.data() + 3 * i);
    view->pixel_weight.data()[i] = 1;
  }
}

ExposureMap Diagonal(const Eigen::Vector3f& gain) {
  ExposureMap map = kIdentityExposure;
  map[0] = gain[0], map[5] = gain[1], map[10] = gain[2];
  return map;
}

struct Known {
  const TrainingViews& training;
  const Geometry& geometry;
  ViewUse use;
};

/// The view with what is known of its depth and of its surroundings; `view` is its image alone.
TrainView WithKnown(TrainView view, const Known& known, size_t v) {
  const auto& [training, geometry, use] = known;
  const Silhouettes& silhouettes = training.silhouettes;
  const bool knows_emptiness = !silhouettes.empty() && use.depth_loss != DepthLoss::kPaper;
  if (knows_emptiness && !view.alpha.defined() &&
      AreSurroundingsMasked(silhouettes.Object(v), training.views[v].mask)) {
    ShowNothingBeside(silhouettes.Object(v), BackgroundColor(use.background), &view);
  }
  if (!geometry.maps.empty() && geometry.maps[v].size() > 0) {
    AddDepth(geometry.maps[v], &view);
    if (use.depth_loss == DepthLoss::kPaper) {
      TakeWhole(geometry.maps[v], PixelsWithDepth(training.views[v], silhouettes, v), &view);
    } else if (knows_emptiness) {
      AddEmptiness(silhouettes, v, &view);
    }
  }
  if (!geometry.gains.empty()) view.exposure = Diagonal(geometry.gains[v]);
  return view;
}

/// A warper with what it refers to.
struct OwnWarper {
  OwnWarper(std::vector<LoadedView> loaded, std::vector<DepthMap> of_views)
      : views(std::move(loaded)),
        maps(std::move(of_views)),
        silhouettes(views),
        warper(WarpSources{views, maps, {}, &silhouettes}) {}

  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  Silhouettes silhouettes;
  Warper warper;
};

}  // namespace

TrainEvidence EvidenceOf(const TrainingViews& training, const Geometry& geometry) {
  return {.is_object = !training.silhouettes.empty(),
          .exposure_spread = ExposureSpread(geometry.gains),
          .photos = training.views.size()};
}

std::optional<double> MeanSquaredConfidence(const std::vector<TrainView>& proposals,
                                            const std::optional<std::array<float, 3>>& backdrop) {
  double squares = 0, pixels = 0;
  for (const TrainView& view : proposals) {
    const Buffer<float> confidence = view.Weights(), image = backdrop ? view.Image() : Buffer<float>();
    for (int64_t p = 0; p < confidence.count(); ++p) {
      if (backdrop && ColorError(image.data() + 3 * p, backdrop->data()) < kBackdropNoise) continue;
      squares += static_cast<double>(confidence[p]) * static_cast<double>(confidence[p]);
      ++pixels;
    }
  }
  return pixels > 0 ? std::optional(squares / pixels) : std::nullopt;
}

ViewUse ViewUseOf(const Run& run) { return {run.options.train.depth_loss, run.plan.image.background}; }

std::vector<TrainView> MakeTrainViews(const TrainingViews& training, const Geometry& geometry, ViewUse use) {
  std::vector<TrainView> views;
  const std::shared_ptr<const void> owner(&training, [](const void*) {});  // the caller keeps it
  for (size_t v = 0; v < training.views.size(); ++v) {
    views.push_back(WithKnown(ToTrainView(training.views[v], owner), {training, geometry, use}, v));
  }
  return views;
}

std::vector<TrainView> TakeTrainViews(TrainingViews* training, Geometry* geometry, ViewUse use) {
  std::vector<TrainView> views;
  for (size_t v = 0; v < training->views.size(); ++v) {
    const auto own = std::make_shared<LoadedView>(std::exchange(training->views[v], {}));
    training->views[v].mask = own->mask;  // with the silhouettes all that WithKnown asks for
    views.push_back(WithKnown(ToTrainView(*own, own), {*training, *geometry, use}, v));
    if (!geometry->maps.empty()) geometry->maps[v] = {};
  }
  return views;
}

nlohmann::json ExposuresToJson(const std::vector<std::string>& names, const std::vector<ExposureMap>& exposures) {
  nlohmann::json json = nlohmann::json::object();
  for (size_t v = 0; v < names.size(); ++v) json[names[v]] = exposures[v];
  return json;
}

std::vector<ExposureMap> ReadExposures(const std::filesystem::path& file, const std::vector<std::string>& names) {
  const nlohmann::json json = ParseJsonOrDiscard(ReadFile(file));
  std::vector<ExposureMap> maps;
  for (const std::string& name : names) {
    const auto found = json.is_object() ? json.find(name) : json.end();
    const bool fits = json.is_object() && found != json.end() && found->is_array() &&
                      found->size() == kIdentityExposure.size() &&
                      std::all_of(found->begin(), found->end(), [](const auto& value) {
                        return value.is_number() && std::abs(value.template get<double>()) < kLargestExposure;
                      });
    if (!fits) {
      throw InputError("{}: holds no color map of {}; delete it and run `oraclegs reconstruct` again", file.string(),
                       name);
    }
    maps.push_back(found->get<ExposureMap>());
  }
  return maps;
}

PseudoDepth NetworkPseudoDepth(const std::filesystem::path& weights, Device device, const Listener& listener) {
  const Networks& networks = GetNetworks();
  const std::shared_ptr<const DepthNetwork> network =
      networks.LoadDepth(weights, DeviceOfNetworks(networks, device, listener));
  return [network](const Camera&, const Buffer<float>& image, const CompareDepth& compare) {
    return network->ImageGradient(image, [&](const Buffer<float>& inv_depth) { return compare({inv_depth, {}}); });
  };
}

PseudoDepth StereoPseudoDepth(std::vector<LoadedView> views, std::vector<DepthMap> maps) {
  const auto own = std::make_shared<const OwnWarper>(std::move(views), std::move(maps));
  return [own](const Camera& camera, const Buffer<float>&, const CompareDepth& compare) {
    const WarpDepth seen = own->warper.Surfaces(camera);
    const Shape shape{camera.height, camera.width};
    DepthTarget target{Buffer<float>::From(shape, std::span<const float>(seen.inv_depth)), Buffer<float>::Zeros(shape)};
    for (int64_t i = 0; i < target.mask.count(); ++i) {
      const auto pixel = static_cast<size_t>(i);
      if (seen.inv_depth[pixel] > 0 || seen.beside[pixel] != 0) target.mask[i] = 1;
    }
    compare(target);
    return Buffer<float>();
  };
}

}  // namespace oraclegs
