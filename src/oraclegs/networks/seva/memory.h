#pragma once
// How much memory a generation needs, before it starts (docs/method.md#seva-cost-and-memory).

#include <cstdint>
#include <string>

#include "oraclegs/networks/seva/conditioning.h"
#include "oraclegs/networks/seva/image_fit.h"
#include "oraclegs/networks/seva/vae.h"
#include "oraclegs/networks/seva_options.h"

namespace oraclegs::seva {

/// Bytes.
struct Memory {
  int64_t weights = 0;      ///< of the UNet, and of the other networks where they stay
  int64_t skips = 0;        ///< what the way down keeps for the way up
  int64_t activations = 0;  ///< of the widest block
  int64_t attention = 0;    ///< scores and slices that are held at a time
  int64_t total() const { return weights + skips + activations + attention; }
};

struct MemoryRequest {
  int64_t frames = 21;
  Size size;  ///< of the images
  Halves halves = Halves::kBatched;
  torch::ScalarType type = torch::kFloat;
  int64_t other_weights = 0;  ///< bytes
  bool gpu = false;           ///< larger slices keep it busy
};
/// An upper estimate: attention is chunked or fused, wide layers go in slices.
Memory EstimateMemory(const UnetConfig& config, const MemoryRequest& request);

/// Batched where that fits into `available` bytes or --seva-halves asks for it, else in turn. Throws RunError with
/// what is needed, what is there, and what each option that lowers it would need.
Halves ChooseHalves(const UnetConfig& config, MemoryRequest request, const SevaOptions& options, int64_t available);

/// What the autoencoder takes, bytes; upper estimates.
struct AutoencoderMemory {
  int64_t weights = 0;  ///< that come beside those that stay
  int64_t encode = 0;   ///< for each pixel of a latent
  int64_t frame = 0;    ///< for each pixel of a latent that is decoded, even in tiles
  int64_t tile = 0;     ///< and for each that is decoded together
};
/// Without `weights`.
AutoencoderMemory EstimateAutoencoder(const VaeConfig& config, torch::ScalarType type);

/// The side of the tiles in which frames are decoded (vae_tiles.h), latent pixels: the frame's longer side, which is
/// one tile, where that fits into `available` bytes; else the largest that does. Throws RunError that says which option
/// lowers the need where tiles of 32 or the encoding of an input image do not fit.
struct TileRequest {
  Size size;                ///< of the images
  int64_t weights = 0;      ///< that stay, bytes
  AutoencoderMemory takes;  ///< beside them
};
int64_t ChooseTile(const TileRequest& request, int64_t available);

}  // namespace oraclegs::seva
