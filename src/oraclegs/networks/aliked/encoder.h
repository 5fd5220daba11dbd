#pragma once
// The convolutional part of ALIKED [Zhao 2023]: four maps of features of an image, each of a lower resolution, and the
// score of each pixel as a keypoint (docs/method.md#aliked).

#include <array>

#include "oraclegs/networks/common/layers.h"

namespace oraclegs::aliked {

struct AlikedConfig {
  std::array<int64_t, 4> widths = {16, 32, 64, 128};  ///< channels behind each block; the last is the descriptor's size
  int64_t samples = 16;                               ///< places around a keypoint that its descriptor reads

  int64_t descriptor_size() const { return widths[3]; }
};

/// Pixels of the image that each pixel of the four maps stands for, along each axis.
inline constexpr std::array<int64_t, 4> kStrides = {1, 2, 8, 32};

/// A 3x3 convolution of a block, the batch norm that follows it included. With `offsets` it is deformable [Dai 2017]:
/// each of its nine taps is read, bilinearly, at a place of its own, and is zero outside of the map.
struct BlockConv {
  Conv conv;
  Conv offsets;  ///< [18, in, 3, 3]: (y, x) of each tap; undefined = the taps stay where they are
};
/// x [1, in, H, W] -> [1, out, H, W]
Tensor Forward(const BlockConv& layer, const Tensor& x);

struct Block {
  BlockConv conv1, conv2;
  Conv shortcut;  ///< 1x1, added to the block's result; undefined = nothing is added
};

struct Encoder {
  AlikedConfig config;
  std::array<Block, 4> blocks;
  std::array<Conv, 4> reductions;  ///< 1x1, to a quarter of the descriptor's size
  std::array<Conv, 4> score_head;  ///< 1x1, then 3x3
};
Encoder LoadEncoder(const ParameterScope& at, const AlikedConfig& config);

/// Results of the encoder for an image of height x width pixels. It works on the image with a margin, so that its sides
/// are multiples of 32; the maps are of that, the scores of the image alone.
struct FeatureMaps {
  std::array<Tensor, 4> maps;  ///< [1, descriptor_size / 4, ...]
  Tensor scores;               ///< [height, width] in (0, 1)
  int64_t left = 0, top = 0;   ///< where the image begins in the largest map
};
/// rgb [height, width, 3] float32 in [0, 1]. The last bits depend on the number of threads. Throws ShapeError.
FeatureMaps Forward(const Encoder& encoder, const Tensor& rgb);

}  // namespace oraclegs::aliked
