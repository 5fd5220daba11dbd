#pragma once
// Layers that all networks share: structs of tensors under their checkpoint names, and their forward passes. Forward
// passes work in the type and on the device of the weights, and record nothing for autograd.

#include "oraclegs/networks/common/parameters.h"

namespace oraclegs {

struct Linear {
  Tensor weight, bias;  ///< [out, in], [out]
};
Linear LoadLinear(const ParameterScope& at, int64_t in, int64_t out);
/// x [..., in] -> [..., out]
Tensor Forward(const Linear& layer, const Tensor& x);

/// Norm over the last axis, with biased variance.
struct LayerNorm {
  Tensor weight, bias;  ///< [width]
  double eps = 1e-5;
};
LayerNorm LoadLayerNorm(const ParameterScope& at, int64_t width, double eps);
Tensor Forward(const LayerNorm& layer, const Tensor& x);

enum class ConvBias { kNone, kLearned };

struct ConvShape {
  int64_t in = 0, out = 0;
  int64_t kernel = 3, stride = 1, padding = 1;
  ConvBias bias = ConvBias::kLearned;
};

struct Conv {
  Tensor weight, bias;  ///< [out, in, kernel, kernel], [out] or undefined
  int64_t stride = 1, padding = 1;
  bool channels_last = false;  ///< takes maps that lie in memory with their channels last, and gives such maps
};
Conv LoadConv(const ParameterScope& at, const ConvShape& shape);
/// x [B, in, H, W]
Tensor Forward(const Conv& layer, const Tensor& x);

/// A transposed convolution whose stride is its kernel: every input pixel becomes kernel x kernel pixels.
struct Upconv {
  Tensor weight, bias;  ///< [in, out, kernel, kernel], [out]
};
Upconv LoadUpconv(const ParameterScope& at, int64_t channels, int64_t kernel);
Tensor Forward(const Upconv& layer, const Tensor& x);

/// Two linear layers with the exact GELU, x * 0.5 * (1 + erf(x / sqrt 2)), between: names fc1, fc2.
struct Mlp {
  Linear fc1, fc2;
};
struct MlpShape {
  int64_t in = 0, hidden = 0, out = 0;
};
Mlp LoadMlp(const ParameterScope& at, const MlpShape& shape);
Tensor Forward(const Mlp& layer, const Tensor& x);

/// x [B, C, H, W] to `height` x `width`. With corners aligned output i of m reads coordinate i (n - 1) / (m - 1), else
/// (i + 0.5) n / m - 0.5 clamped to the map.
enum class Corners { kAligned, kHalfPixel };
Tensor ResizeBilinear(const Tensor& x, int64_t height, int64_t width, Corners corners);

/// (x - mean) / deviation with ImageNet's per-channel constants; x [B, 3, H, W], RGB in [0, 1].
Tensor NormalizeRgb(const Tensor& x);

/// Throws ShapeError "WHO: ..." unless images is float32 [B >= 1, 3, H, W] with sides that are multiples of `patch`.
void RequireImages(const char* who, const Tensor& images, int64_t patch);

}  // namespace oraclegs
