#pragma once
// Inputs of the network for one joint problem (docs/method.md#seva-data-flow), and the network as the sampler calls it.

#include <vector>

#include "oraclegs/networks/seva/cameras.h"
#include "oraclegs/networks/seva/sampler.h"
#include "oraclegs/networks/seva/unet.h"
#include "oraclegs/networks/seva_options.h"

namespace oraclegs::seva {

/// Frames of a joint problem. Latents and embeddings are read where `given`.
struct Frames {
  std::vector<View> views;  ///< normalized
  std::vector<bool> given;
  std::vector<Tensor> latents;     ///< [1, 4, h, w] each, scaled
  std::vector<Tensor> embeddings;  ///< [1, context width] each
  int64_t height = 0, width = 0;   ///< size of the latents
};

/// Conditional inputs; the unconditional ones have zeros for all but the rays.
struct NetworkInputs {
  Tensor given;    ///< [T, 5, h, w]: latents and 1 where a frame is given, else 0
  Tensor mask;     ///< [T, 1, h, w]: 1 where a frame is given
  Tensor rays;     ///< [T, 6, h, w] Pluecker maps
  Tensor context;  ///< [T, 1, context width]: the mean embedding of the given frames
};
/// float32 on `device`. Throws ShapeError for lists of unequal length and when no frame is given.
NetworkInputs MakeInputs(const Frames& frames, torch::Device device);

/// Network for Denoiser. Everything that does not change from step to step is computed here, once. `unet` must outlive
/// it.
Network MakeNetwork(const Unet& unet, const NetworkInputs& inputs, Halves halves);

}  // namespace oraclegs::seva
