#pragma once
// SEVA's multi-view UNet (docs/method.md#seva-unet): predicts the noise in the latents of all frames of a sequence from
// their cameras and the content of the input images. The defaults are Stable Virtual Camera 1.1.

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "oraclegs/networks/seva/multi_view.h"
#include "oraclegs/networks/seva/res_block.h"

namespace oraclegs::seva {

struct UnetConfig {
  int64_t in_channels = 11;  ///< latent 4, mask 1, rays 6
  int64_t out_channels = 4;
  int64_t channels = 320;  ///< channels of the first level
  std::vector<int64_t> channel_mult = {1, 2, 4, 4};
  int64_t res_blocks = 2;                                 ///< blocks of a level on the way down; one more on the way up
  std::vector<int64_t> attention_downscales = {4, 2, 1};  ///< levels with multi-view transformers
  int64_t head_width = 64;
  std::vector<int64_t> transformer_depth = {1, 1, 1, 1};  ///< one entry a level
  int64_t context_width = 1024;
  int64_t dense_channels = 6;
  int64_t groups = 32;
  /// Transformers in which all frames of a sequence attend to each other: "input_ds1", "middle_ds8", "output_ds4" ...
  std::vector<std::string> joint = {"middle_ds8", "output_ds4", "output_ds2"};

  int64_t embedding_width() const { return 4 * channels; }
  /// Latent sides must be multiples of this factor.
  int64_t downscale() const { return int64_t{1} << (channel_mult.size() - 1); }
};

/// Resizes to twice the size by nearest neighbors, then convolves.
struct Up {
  Conv conv;
};
using UnetLayer = std::variant<Conv, Up, ResBlock, MultiView>;
using UnetBlock = std::vector<UnetLayer>;

struct Unet {
  UnetConfig config;
  Linear time1, time2;
  std::vector<UnetBlock> input_blocks, output_blocks;
  UnetBlock middle;
  GroupNorm norm_out;
  Conv conv_out;
  std::optional<torch::ScalarType>
      products;                ///< type of the products in Prepare and Forward; unset = the weights' (Autocast)
  bool channels_last = false;  ///< memory layout of feature maps (KeepChannelsLast)

  const Tensor& any_weight() const { return time1.weight; }  ///< a weight of the network's type, on its device
};
/// Keeps feature maps and the weights of convolutions with their channels last in memory from here on. The matrix units
/// of a GPU take them so, and the tokens of a transformer are then the map itself. Results differ by rounding only.
void KeepChannelsLast(Unet* unet);
/// Uses channels last where kernels take its maps (kernels.h). Throws ShapeError for a configuration without levels, or
/// whose groups or heads do not divide a level's channels.
Unet LoadUnet(ParameterSource& source, const UnetConfig& config);

struct Placement {
  torch::Device device = torch::kCPU;
  torch::ScalarType type = torch::kFloat;          ///< type of the weights
  std::optional<torch::ScalarType> products = {};  ///< type of matrix products; unset = `type`
};
/// Reads safetensors files with the official names, with or without "module." in front. Throws InputError that lists
/// all that does not fit.
Unet LoadUnet(const std::vector<std::filesystem::path>& paths, const UnetConfig& config = {},
              const Placement& placement = {});

/// Conditioning that stays constant from step to step: the rays at each level's size, and the inputs of cross
/// attention. In the type and on the device of the weights.
struct Conditioning {
  int64_t frames = 0;
  std::vector<Tensor> dense;  ///< [N, 6, h / 2^level, w / 2^level]
  std::vector<MultiViewContext> contexts;
};
struct Conditions {
  Tensor context;                 ///< [N, L, context_width]
  Tensor dense;                   ///< [N, dense_channels, any, any]; resized to each level with corners aligned
  int64_t frames = 0;             ///< frames of a sequence; adjacent rows
  int64_t height = 0, width = 0;  ///< size of the latents
};
/// Throws ShapeError when the rows are no whole sequences or the sides no multiples of downscale().
Conditioning Prepare(const Unet& unet, const Conditions& conditions);

/// steps [N] int64 in 0 .. 999 -> [N, embedding_width].
Tensor TimeEmbedding(const Unet& unet, const Tensor& steps);

/// x [N, in_channels, h, w], steps [N] int64 -> [N, out_channels, h, w] float32. Throws ShapeError.
Tensor Forward(const Unet& unet, const Tensor& x, const Tensor& steps, const Conditioning& conditioning);

/// One block, for the tests: `embedding` is SiLU(TimeEmbedding).
Tensor Forward(const UnetBlock& block, const Tensor& x, const Tensor& embedding, const Conditioning& conditioning);

}  // namespace oraclegs::seva
