#include "oraclegs/networks/common/dpt.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace oraclegs {
namespace {

constexpr int64_t kLastWidth = 32;       // channels before the last convolution
constexpr int64_t kViewsOnGpu = 8;       // views that go through the head together
constexpr double kEmbeddingScale = 0.1;  // factor on the grid embeddings

ResidualUnit LoadUnit(const ParameterScope& at, int64_t features) {
  return {LoadConv(at / "conv1", {features, features}), LoadConv(at / "conv2", {features, features})};
}

Fusion LoadFusion(const ParameterScope& at, const DptConfig& config, bool joins) {
  Fusion fusion;
  if (joins) {
    fusion.side = LoadUnit(at / "resConfUnit1", config.features);
  } else if (config.style == DptStyle::kDepthAnything) {
    for (const char* conv : {"conv1", "conv2"}) {
      const ParameterScope unused = at / "resConfUnit1" / conv;
      unused.Unused("weight", {config.features, config.features, 3, 3});
      unused.Unused("bias", {config.features});
    }
  }
  fusion.main = LoadUnit(at / "resConfUnit2", config.features);
  fusion.out = LoadConv(at / "out_conv", {config.features, config.features, 1, 1, 0});
  return fusion;
}

Tensor Residual(const ResidualUnit& unit, const Tensor& x, DptStyle style) {
  const Tensor rectified = at::relu(x);
  Tensor inner = Forward(unit.conv1, rectified);
  at::relu_(inner);
  return Forward(unit.conv2, inner).add_(style == DptStyle::kVggt ? rectified : x);
}

void Embed(Tensor& map, const DptHead& head, const PatchGrid& grid) {
  if (head.config.style != DptStyle::kVggt) return;
  const double aspect = static_cast<double>(grid.cols) / static_cast<double>(grid.rows);
  const Tensor embedding = GridEmbedding(map.size(1), map.size(2), map.size(3), aspect);
  map.add_(embedding.to(map.options()), kEmbeddingScale);
}

/// Feature map made from the tokens of layer i.
Tensor LayerMap(const DptHead& head, const Tensor& tokens, int64_t i, const PatchGrid& grid) {
  const size_t layer = static_cast<size_t>(i);
  Tensor x = tokens.to(head.projects[0].weight.options());
  if (head.norm) x = Forward(*head.norm, x);
  x = x.transpose(1, 2).reshape({x.size(0), head.config.width, grid.rows, grid.cols});
  x = Forward(head.projects[layer], x);
  Embed(x, head, grid);
  if (i == 0) x = Forward(head.up4, x);
  if (i == 1) x = Forward(head.up2, x);
  if (i == 3) x = Forward(head.down, x);
  return Forward(head.to_features[layer], x);
}

Tensor Output(const DptHead& head, const Tensor& fused, const PatchGrid& grid) {
  Tensor x = ResizeBilinear(Forward(head.out1, fused), head.config.patch * grid.rows, head.config.patch * grid.cols,
                            Corners::kAligned);
  Embed(x, head, grid);
  x = Forward(head.out2, x);
  return Forward(head.out3, at::relu_(x));
}

/// Sines and cosines, [quarter, n] each, of n places between -extent and extent.
std::pair<Tensor, Tensor> Waves(double extent, int64_t n, const Tensor& frequencies) {
  const double last = extent * static_cast<double>(n - 1) / static_cast<double>(n);
  const Tensor places = torch::linspace(-last, last, n, torch::kFloat).to(torch::kDouble);
  const Tensor angles = frequencies.unsqueeze(1) * places;
  return {angles.sin().to(torch::kFloat), angles.cos().to(torch::kFloat)};
}

}  // namespace

DptHead LoadDptHead(const ParameterScope& at, const DptConfig& config) {
  DptHead head;
  head.config = config;
  const auto& o = config.channels;
  if (config.style == DptStyle::kVggt) head.norm = LoadLayerNorm(at / "norm", config.width, config.norm_eps);
  const ParameterScope scratch = at / "scratch";
  for (size_t i = 0; i < 4; ++i) {
    const int64_t n = static_cast<int64_t>(i);
    head.projects[i] = LoadConv(at / "projects" / n, {config.width, o[i], 1, 1, 0});
    head.to_features[i] = LoadConv(scratch / ("layer" + std::to_string(n + 1) + "_rn"),
                                   {o[i], config.features, 3, 1, 1, ConvBias::kNone});
    head.fusions[i] = LoadFusion(scratch / ("refinenet" + std::to_string(n + 1)), config, i < 3);
  }
  head.up4 = LoadUpconv(at / "resize_layers" / 0, o[0], 4);
  head.up2 = LoadUpconv(at / "resize_layers" / 1, o[1], 2);
  head.down = LoadConv(at / "resize_layers" / 3, {o[3], o[3], 3, 2, 1});
  head.out1 = LoadConv(scratch / "output_conv1", {config.features, config.features / 2});
  head.out2 = LoadConv(scratch / "output_conv2" / 0, {config.features / 2, kLastWidth});
  head.out3 = LoadConv(scratch / "output_conv2" / 2, {kLastWidth, config.outputs, 1, 1, 0});
  return head;
}

std::array<Tensor, 4> FuseLayers(const DptHead& head, const std::array<Tensor, 4>& layers, const PatchGrid& grid) {
  std::array<Tensor, 4> maps;
  for (size_t i = 0; i < 4; ++i) {
    const Tensor& t = layers[i];
    if (t.dim() != 3 || t.size(1) != grid.rows * grid.cols || t.size(2) != head.config.width) {
      throw ShapeError("FuseLayers: tokens of layer {} are [{}], expected [any, {}, {}]", i, fmt::join(t.sizes(), ", "),
                       grid.rows * grid.cols, head.config.width);
    }
    maps[i] = LayerMap(head, t, static_cast<int64_t>(i), grid);
  }
  std::array<Tensor, 4> fused;
  Tensor y;
  for (size_t i = 4; i-- > 0;) {
    const Fusion& fusion = head.fusions[i];
    y = i == 3 ? maps[i] : y + Residual(*fusion.side, maps[i], head.config.style);
    y = Residual(fusion.main, y, head.config.style);
    const int64_t height = i == 0 ? 2 * y.size(2) : maps[i - 1].size(2);
    const int64_t width = i == 0 ? 2 * y.size(3) : maps[i - 1].size(3);
    fused[i] = Forward(fusion.out, ResizeBilinear(y, height, width, Corners::kAligned));
    y = fused[i];
  }
  return fused;
}

Tensor Forward(const DptHead& head, const std::array<Tensor, 4>& layers, const PatchGrid& grid) {
  const int64_t views = layers[0].size(0), together = layers[0].is_cuda() ? kViewsOnGpu : 1;
  std::vector<Tensor> out;
  for (int64_t begin = 0; begin < views; begin += together) {
    std::array<Tensor, 4> some;
    for (size_t i = 0; i < 4; ++i) some[i] = layers[i].slice(0, begin, std::min(begin + together, views));
    out.push_back(Output(head, FuseLayers(head, some, grid)[0], grid));
  }
  return at::cat(out, 0);
}

Tensor GridEmbedding(int64_t channels, int64_t rows, int64_t cols, double aspect) {
  if (channels <= 0 || channels % 4 != 0 || rows <= 0 || cols <= 0) {
    throw ShapeError("GridEmbedding: {} channels on {} x {}, expected a multiple of 4 and a map", channels, rows, cols);
  }
  const int64_t quarter = channels / 4;
  const Tensor exponents = torch::arange(quarter, torch::kDouble) / static_cast<double>(quarter);
  const Tensor frequencies = at::pow(torch::scalar_tensor(100.0, torch::kDouble), -exponents);
  const double diagonal = std::sqrt(aspect * aspect + 1);
  const auto [sin_x, cos_x] = Waves(aspect / diagonal, cols, frequencies);
  const auto [sin_y, cos_y] = Waves(1 / diagonal, rows, frequencies);
  const auto along_x = [&](const Tensor& t) { return t.unsqueeze(1).expand({quarter, rows, cols}); };
  const auto along_y = [&](const Tensor& t) { return t.unsqueeze(2).expand({quarter, rows, cols}); };
  return at::cat({along_x(sin_x), along_x(cos_x), along_y(sin_y), along_y(cos_y)}, 0);
}

}  // namespace oraclegs
