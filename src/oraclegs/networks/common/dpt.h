#pragma once
// The dense prediction head: tokens of four layers become one map of the image's size
// (docs/method.md#dpt-head).

#include <array>
#include <optional>

#include "oraclegs/networks/common/layers.h"
#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

/// Differences between the two networks that have this head.
enum class DptStyle {
  kDepthAnything,  ///< a residual unit adds its input; the last fusion's side unit is in the file but never used
  kVggt,           ///< one norm for the tokens, grid embeddings; a residual unit adds its *rectified* input
};

struct DptConfig {
  DptStyle style = DptStyle::kDepthAnything;
  int64_t width = 384;  ///< width of a token
  int64_t features = 64;
  std::array<int64_t, 4> channels = {48, 96, 192, 384};
  int64_t outputs = 1;
  int64_t patch = 14;      ///< side of a patch in pixels
  double norm_eps = 1e-5;  ///< used by kVggt only
};

struct ResidualUnit {
  Conv conv1, conv2;
};

/// One step from coarse to fine.
struct Fusion {
  std::optional<ResidualUnit> side;  ///< for the map that joins here
  ResidualUnit main;
  Conv out;
};

struct DptHead {
  DptConfig config;
  std::optional<LayerNorm> norm;
  std::array<Conv, 4> projects;
  Upconv up4, up2;  ///< resize_layers 0 and 1; 2 is the identity
  Conv down;        ///< resize_layers 3
  std::array<Conv, 4> to_features;
  std::array<Fusion, 4> fusions;
  Conv out1, out2, out3;  ///< output_conv1, output_conv2.0, output_conv2.2
};
DptHead LoadDptHead(const ParameterScope& at, const DptConfig& config);

/// Rows and columns of the patches of one view.
struct PatchGrid {
  int64_t rows = 0, cols = 0;
};

/// Results of the four fusions; entry [k - 1] is that of refinenet k. layers: patch tokens alone, from shallow to deep,
/// each [B, rows * cols, width] (ShapeError otherwise).
std::array<Tensor, 4> FuseLayers(const DptHead& head, const std::array<Tensor, 4>& layers, const PatchGrid& grid);

/// Raw outputs [B, outputs, patch * rows, patch * cols]. On a CPU views go through one at a time, since their maps are
/// large and nothing is shared. Throws ShapeError.
Tensor Forward(const DptHead& head, const std::array<Tensor, 4>& layers, const PatchGrid& grid);

/// The sinusoidal embedding that VGGT's dense heads add to their maps (docs/method.md#grid-embedding), [channels, rows,
/// cols] float32. Coordinates depend on `aspect`, width over height of the image, not of the map.
/// Quarters of the channels: sin and cos of x, sin and cos of y. Throws ShapeError unless 4 divides the channels.
Tensor GridEmbedding(int64_t channels, int64_t rows, int64_t cols, double aspect);

}  // namespace oraclegs
