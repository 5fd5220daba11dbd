#pragma once
// Tiled decoding of frames whose activations do not fit into memory at once.

#include "oraclegs/networks/seva/vae.h"

namespace oraclegs::seva {

/// Square tiles of the latent that are decoded one after the other.
struct VaeTiles {
  int64_t side = 96;     ///< latent pixels (8 image pixels each)
  int64_t overlap = 32;  ///< latent pixels that neighbors share, at least; at most half of `side`
};

/// DecodeLatents with the memory of one tile (and of the image) instead of the frame's. The middle block, with all
/// attention, sees the whole latent, so its result is exact. After it each tile differs from the plain decode in two
/// ways. Zeros lie beyond its border; they reach about 13 latent pixels deep and fade quickly: a quarter of the overlap
/// is not used at either side, and between the quarters one tile passes linearly into the next. Its norms take mean and
/// variance over the tile, not over the frame; this dominates and depends on the image: with random weights 0.03 of the
/// decode (L2) where tiles have the frame's statistics, 0.46 where the frame is one slow wave. So tiles should be as
/// large as memory allows; a frame of one tile is the plain decode, bit for bit. Throws ShapeError, also for an overlap
/// out of its range.
Tensor DecodeTiled(const Vae& vae, const Tensor& latents, const VaeTiles& tiles);

/// Weight of each tile at each pixel of an axis: one row a tile, columns sum to 1. For the tests.
struct TiledAxis {
  int64_t side = 0;             ///< side of a tile, latent pixels; a shorter axis is one tile
  std::vector<int64_t> starts;  ///< latent pixels
  Tensor weights;               ///< [tiles, pixels of a tile] float32, in image pixels
};
TiledAxis TileAxis(int64_t length, const VaeTiles& tiles, int64_t pixels_per_latent);

}  // namespace oraclegs::seva
