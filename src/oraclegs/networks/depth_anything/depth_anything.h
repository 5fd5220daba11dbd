#pragma once
// Depth Anything V2: one image becomes a map of relative inverse depth (docs/method.md#depth-anything). Larger is
// nearer; unit and zero point are unknown.

#include <array>
#include <memory>
#include <string>

#include "oraclegs/networks/common/dpt.h"
#include "oraclegs/networks/common/vit.h"
#include "oraclegs/networks/networks.h"

namespace oraclegs {

struct DepthAnythingConfig {
  VitConfig backbone;
  std::array<int64_t, 4> layers = {2, 5, 8, 11};  ///< layers of the backbone that the head reads, 0-based
  DptConfig head;
  int64_t input_side = 518;  ///< smallest side of the network's input, pixels
};

enum class DepthAnythingSize { kSmall, kBase, kLarge };
/// Published networks: vits, vitb, vitl.
DepthAnythingConfig DepthAnythingV2(DepthAnythingSize size);

struct DepthAnything {
  DepthAnythingConfig config;
  Vit backbone;
  DptHead head;
};
DepthAnything LoadDepthAnything(ParameterSource& source, const DepthAnythingConfig& config);
/// Reads a safetensors file with the official names. Throws InputError that lists all that does not fit.
DepthAnything LoadDepthAnything(const std::filesystem::path& path, DepthAnythingSize size,
                                torch::Device device = torch::kCPU);

/// Configuration of a weights file: S, B, L, or another size by their rules. Those are: heads of 64; the head reads
/// after each quarter of the blocks (with 24 blocks after 4, 11, 17 and 23); the input has the size that positions are
/// stored for. Throws InputError for a file of another network.
DepthAnythingConfig RecognizeDepthAnything(const std::filesystem::path& path);
/// Loads what RecognizeDepthAnything finds. Throws InputError that lists all that does not fit.
DepthAnything LoadRecognizedDepthAnything(const std::filesystem::path& path, torch::Device device = torch::kCPU);
/// Loads such a network behind the program's interface. Throws InputError.
std::unique_ptr<DepthNetwork> LoadDepthNetwork(const std::filesystem::path& path, torch::Device device = torch::kCPU);

/// rgb [h, w, 3] float32 in [0, 1] -> [1, 3, H, W]: the smaller side becomes `side`, both multiples of `patch`; bicubic
/// without antialiasing, not clamped, not yet normalized. Throws ShapeError.
Tensor ResizeForDepthAnything(const Tensor& rgb, int64_t side, int64_t patch);

/// Tokens of the patches [B, P, width] after each of the layers that the head reads.
std::array<Tensor, 4> HeadLayers(const DepthAnything& model, const Tensor& normalized);

/// normalized [B, 3, H, W] float32 (NormalizeRgb), sides multiples of the patch -> inverse depth [B, H, W] float32 >=
/// 0.
Tensor Forward(const DepthAnything& model, const Tensor& normalized);

/// rgb [h, w, 3] float32 in [0, 1], on the CPU -> relative inverse depth [h, w] float32 >= 0, on the CPU wherever the
/// network is. Throws ShapeError.
Tensor RelativeInverseDepth(const DepthAnything& model, const Tensor& rgb);

}  // namespace oraclegs
