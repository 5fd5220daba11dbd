#include "oraclegs/networks/vggt/attention_network.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "oraclegs/networks/common/tensor.h"
#include "oraclegs/networks/vggt/input.h"
#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs::vggt {
namespace {

/// Image scaled into `width` x `height` pixels, white around it. The reference is fitted so: only its own patches are
/// then partly white, and no map is made of these.
Image8 Fitted(const Image8& image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  const double scale = std::min(static_cast<double>(width) / image.width, static_cast<double>(height) / image.height);
  const int w = std::clamp(static_cast<int>(scale * image.width), 1, width);
  const int h = std::clamp(static_cast<int>(scale * image.height), 1, height);
  const Image8 small = ResizeLikePillow(image, w, h);
  Image8 out{width, height, 3, std::vector<uint8_t>(size_t{3} * width * height, 255)};
  for (int y = 0; y < h; ++y) {
    const auto row = small.data.begin() + static_cast<int64_t>(y) * w * 3;
    std::copy(row, row + int64_t{3} * w,
              out.data.begin() + (static_cast<int64_t>(y + (height - h) / 2) * width + (width - w) / 2) * 3);
  }
  return out;
}

/// Throws ShapeError for views that cannot be asked for.
void RequireViews(const std::vector<Image8>& views, const std::vector<size_t>& asked, bool official) {
  if (views.empty() || asked.empty()) throw ShapeError("AttentionOn: {} of {} views", asked.size(), views.size());
  for (const size_t view : asked) {
    if (view >= views.size() || (view == 0 && !official)) {
      throw ShapeError("AttentionOn: view {} of {} has no map", view, views.size());
    }
    if (!official && (views[view].width != views[asked[0]].width || views[view].height != views[asked[0]].height)) {
      throw ShapeError("AttentionOn: views of different sizes");
    }
  }
}

class AttentionOfFile : public AttentionNetwork {
 public:
  AttentionOfFile(const std::filesystem::path& path, const AttentionOptions& options, torch::Device device)
      : path_(path), placement_(PlaceOn(device, options.precision)), file_(ReadWeightsFile(path)) {
    settings_ = {options.mode, file_.side, file_.oracle_layers, file_.oracle_weights};
    if (!options.layers.empty()) TakeLayers(options.layers);
  }

  int64_t PassBytes(const std::vector<Camera>& cameras, int64_t views) const override {
    const int64_t patch = file_.network.aggregator.backbone.patch, side = file_.side;
    Pass pass{views, patch, side, {}};
    if (settings_.mode == AttentionMode::kOfficial) pass.height = side;
    for (const Camera& camera : cameras) {
      const int64_t a = camera.width, b = camera.height;
      const int64_t shorter = (side * std::min(a, b) / std::max(a, b) / patch + 1) * patch;
      pass.height = std::max(pass.height, std::min(shorter, side));
    }
    return WeightBytes(file_.network, {}) + vggt::PassBytes(file_.network, pass);
  }

  void Load() override {
    if (!aggregator_) aggregator_ = LoadVggt({path_}, {}, placement_, file_.network).aggregator;
  }

  std::vector<Buffer<float>> Confidence(const std::vector<Image8>& views, const std::vector<size_t>& asked) override {
    Load();
    std::vector<Buffer<float>> maps;
    for (const Tensor& map : AttentionOn(*aggregator_, settings_, views, asked)) maps.push_back(BufferOf(map));
    return maps;
  }

 private:
  void TakeLayers(const std::vector<LayerWeight>& layers) {
    const int64_t depth = file_.network.aggregator.depth;
    double sum = 0;
    for (const LayerWeight& l : layers) {
      if (l.layer < 0 || l.layer >= depth) {
        throw InputError("{}: has no attention layer {}, only 0 to {}; name others with --set vggt-layers",
                         path_.string(), l.layer, depth - 1);
      }
      if (!(l.weight >= 0)) throw ShapeError("OpenAttention: layer {} has weight {}", l.layer, l.weight);
      sum += l.weight;
    }
    if (!(sum > 0)) throw ShapeError("OpenAttention: the weights of the layers sum to {}", sum);
    settings_.layers.clear(), settings_.weights.clear();
    for (const LayerWeight& l : layers) {
      settings_.layers.push_back(l.layer);
      settings_.weights.push_back(l.weight / sum);
    }
  }

  std::filesystem::path path_;
  Placement placement_;
  WeightsFile file_;
  AttentionSettings settings_;
  std::optional<Aggregator> aggregator_;
};

}  // namespace

std::vector<Tensor> AttentionOn(const Aggregator& aggregator, const AttentionSettings& settings,
                                const std::vector<Image8>& views, const std::vector<size_t>& asked) {
  if (settings.layers.empty() || settings.layers.size() != settings.weights.size()) {
    throw ShapeError("AttentionOn: {} layers, {} weights", settings.layers.size(), settings.weights.size());
  }
  const bool official = settings.mode == AttentionMode::kOfficial;
  RequireViews(views, asked, official);
  std::vector<Image8> fitted = views;
  if (!official) fitted[0] = Fitted(views[0], views[asked[0]].width, views[asked[0]].height);
  const int64_t patch = aggregator.config.backbone.patch;
  const Input input = PrepareInput(fitted, official ? Fit::kPad : Fit::kWhole, settings.side, patch);
  const AggregatorResult result = Aggregate(aggregator, input.images.to(aggregator.camera_token.device()),
                                            {{}, settings.layers, QueriesOf(settings.mode)});
  const auto on_cpu = [](const Tensor& t) { return t.defined() ? t.to(torch::kCPU) : t; };
  std::vector<WeightedAttention> layers;
  for (size_t l = 0; l < settings.layers.size(); ++l) {
    const GlobalAttention& on_device = result.attention.at(settings.layers[l]);
    layers.push_back({{on_cpu(on_device.from_patches), on_cpu(on_device.from_camera)}, settings.weights[l]});
  }
  const int64_t rows = input.images.size(2), cols = input.images.size(3);
  const Tensor of_patches = PatchConfidence(layers, settings.mode, {rows / patch, cols / patch});
  std::vector<Tensor> maps;
  for (const size_t view : asked) {
    const auto v = static_cast<int64_t>(view);
    const InputPlace& place = input.places[view];
    const Tensor shown = UpsampleConfidence(of_patches.slice(0, v, v + 1), rows, cols)
                             .slice(1, place.top, place.top + place.height)
                             .slice(2, place.left, place.left + place.width)
                             .contiguous();
    maps.push_back(UpsampleConfidence(shown, views[view].height, views[view].width)[0].clamp_(0, 1).contiguous());
  }
  return maps;
}

std::unique_ptr<AttentionNetwork> OpenAttention(const std::filesystem::path& weights, const AttentionOptions& options,
                                                torch::Device device) {
  return std::make_unique<AttentionOfFile>(weights, options, device);
}

}  // namespace oraclegs::vggt
