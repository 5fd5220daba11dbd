#pragma once
// Memory that a generation needs, known before it starts (docs/method.md#seva-cost-and-memory).

#include <cstdint>
#include <string>

#include "oraclegs/networks/seva/conditioning.h"
#include "oraclegs/networks/seva/image_fit.h"
#include "oraclegs/networks/seva/vae.h"
#include "oraclegs/networks/seva_options.h"

namespace oraclegs::seva {

/// Need in bytes.
struct Memory {
  int64_t weights = 0;      ///< UNet, and the other networks where they stay on the device
  int64_t skips = 0;        ///< maps that the way down keeps for the way up
  int64_t activations = 0;  ///< widest block
  int64_t attention = 0;    ///< scores and slices that are held at a time
  int64_t total() const { return weights + skips + activations + attention; }
};

struct MemoryRequest {
  int64_t frames = 21;
  Size size;  ///< size of the images
  Halves halves = Halves::kBatched;
  torch::ScalarType type = torch::kFloat;
  int64_t other_weights = 0;  ///< bytes
  bool gpu = false;           ///< larger slices keep it busy
};
/// Upper estimate; attention is chunked or fused, wide layers go in slices.
Memory EstimateMemory(const UnetConfig& config, const MemoryRequest& request);

/// kBatched where that fits into `available` bytes or --set seva-halves asks for it, else kInTurn. Throws RunError with
/// the need, the available memory, and what each option that lowers the need would take.
Halves ChooseHalves(const UnetConfig& config, MemoryRequest request, const SevaOptions& options, int64_t available);

/// Memory of the autoencoder in bytes; upper estimates.
struct AutoencoderMemory {
  int64_t weights = 0;  ///< weights that are loaded beside those that stay
  int64_t encode = 0;   ///< for each pixel of a latent
  int64_t frame = 0;    ///< for each pixel of a latent that is decoded, even in tiles
  int64_t tile = 0;     ///< for each latent pixel that is decoded together
};
/// Leaves `weights` 0.
AutoencoderMemory EstimateAutoencoder(const VaeConfig& config, torch::ScalarType type);

/// Side of the tiles in which frames are decoded (vae_tiles.h), latent pixels: the frame's longer side, which is one
/// tile, where that fits into `available` bytes; else the largest that does. Throws RunError that names the options
/// that lower the need when tiles of 32 or the encoding of an input image do not fit.
struct TileRequest {
  Size size;                ///< size of the images
  int64_t weights = 0;      ///< weights that stay, bytes
  AutoencoderMemory takes;  ///< need beside them
};
int64_t ChooseTile(const TileRequest& request, int64_t available);

}  // namespace oraclegs::seva
