#pragma once
// Building blocks of the autoencoder's encoder and decoder (docs/method.md#seva-autoencoder). All tensors are [B,
// channels, h, w].

#include <optional>
#include <vector>

#include "oraclegs/networks/seva/norms.h"

namespace oraclegs::seva {

/// Shape of all norms of an autoencoder.
struct VaeNormShape {
  int64_t groups = 32;
  double eps = 1e-6;
};

/// Two convolutions, each after norm and SiLU, added to the input.
struct VaeResnet {
  GroupNorm norm1, norm2;
  Conv conv1, conv2;
  std::optional<Conv> shortcut;  ///< 1x1, where the number of channels changes
};
VaeResnet LoadVaeResnet(const ParameterScope& at, int64_t in, int64_t out, const VaeNormShape& norm);
Tensor Forward(const VaeResnet& block, const Tensor& x);

/// Attention of every place to every place, with one head as wide as the channels; added to the input.
struct VaeAttention {
  GroupNorm norm;
  Linear q, k, v, out;
};
VaeAttention LoadVaeAttention(const ParameterScope& at, int64_t channels, const VaeNormShape& norm);
Tensor Forward(const VaeAttention& attention, const Tensor& x);

/// Block at latent resolution.
struct VaeMiddle {
  VaeResnet first;
  VaeAttention attention;
  VaeResnet last;
};
VaeMiddle LoadVaeMiddle(const ParameterScope& at, int64_t channels, const VaeNormShape& norm);
Tensor Forward(const VaeMiddle& middle, const Tensor& x);

enum class VaeResample { kKeep, kHalve, kDouble };

/// Residual blocks at one resolution, the first of which changes the channels; then a change of resolution.
struct VaeLevelShape {
  int64_t in = 0, out = 0;
  int64_t resnets = 0;
  VaeResample resample = VaeResample::kKeep;
};
struct VaeLevel {
  std::vector<VaeResnet> resnets;
  VaeResample resample = VaeResample::kKeep;
  std::optional<Conv> conv;  ///< strided, behind one column and row of zeros at the right and the bottom; or after
                             ///< every pixel became 2 x 2
};
VaeLevel LoadVaeLevel(const ParameterScope& at, const VaeLevelShape& shape, const VaeNormShape& norm);
Tensor Forward(const VaeLevel& level, Tensor x);

}  // namespace oraclegs::seva
