#pragma once
// LPIPS v0.1, a learned distance of images: value and gradient (docs/method.md#lpips).

#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "oraclegs/networks/common/feature_stack.h"
#include "oraclegs/networks/networks.h"

namespace oraclegs {

struct Lpips {
  FeatureStack features;
  std::array<Tensor, 5> weights;  ///< weights of the channels at each tap, [1, C, 1, 1]
};
/// Tensor names: features.N as in torchvision, lin0.model.1.weight ... lin4.model.1.weight as in LPIPS v0.1.
Lpips LoadLpips(ParameterSource& source, const FeatureStackConfig& config);
/// Reads safetensors files that together hold the published features and linear weights; torchvision's `classifier.` is
/// not read. Throws InputError that lists all that does not fit.
Lpips LoadLpips(const std::vector<std::filesystem::path>& paths, FeatureNetwork network,
                torch::Device device = torch::kCPU);

/// Configuration of the LPIPS in these files: VGG16 or AlexNet, of any widths. Throws InputError.
FeatureStackConfig RecognizeLpips(const std::vector<std::filesystem::path>& paths);
Lpips LoadRecognizedLpips(const std::vector<std::filesystem::path>& paths, torch::Device device = torch::kCPU);

/// Everything that a distance needs of the target: computed once, compared with many renders.
struct LpipsTarget {
  LpipsRange range = LpipsRange::kZeroOne;
  int64_t height = 0, width = 0;
  std::array<Tensor, 5> features;  ///< unit length in each pixel
};
/// image [H, W, 3] float32 in [0, 1]. Throws ShapeError when it is too small for the network.
LpipsTarget PrepareTarget(const Lpips& lpips, const Tensor& image, LpipsRange range);

struct LpipsValue {
  double value = 0;
  std::array<double, 5> layers = {};  ///< one summand a tap
};

/// image [H, W, 3] float32 in [0, 1], of the target's size. grad [H, W, 3] receives d(value)/d(image); null or
/// undefined = value only. Where all channels of a tap are zero the length has no derivative; zero is taken. Throws
/// ShapeError.
LpipsValue Distance(const Lpips& lpips, const Tensor& image, const LpipsTarget& target, Tensor* grad = nullptr);

// LPIPS behind the program's interface, with a cache of the features of targets.

/// cache_bytes: memory that the features of targets may take; features that do not fit are computed each time.
std::unique_ptr<PerceptualNetwork> MakePerceptualNetwork(Lpips lpips, int64_t cache_bytes);

}  // namespace oraclegs
