#pragma once
// Decoding of frames whose activations do not fit into memory at once.

#include "oraclegs/networks/seva/vae.h"

namespace oraclegs::seva {

/// Squares of the latent that are decoded one after the other.
struct VaeTiles {
  int64_t side = 96;     ///< latent pixels (8 image pixels each)
  int64_t overlap = 32;  ///< latent pixels that neighbors share at least; at most half of `side`
};

/// DecodeLatents with the memory of one tile (and of the image) in place of that of the frame. The middle block, with
/// all attention, sees the whole latent, so what it computes is exact. Behind it each tile differs from the plain
/// decode in two ways: its norms take mean and variance over the tile, not over the frame; and zeros stand beyond its
/// border. The second reaches about 13 latent pixels deep and fades quickly: a quarter of the overlap is not used at
/// either side, and between the quarters one tile passes linearly into the next. The first is what counts, and it
/// depends on the image: with random weights 0.03 of the decode (L2) where tiles hold what the frame holds, 0.46
/// where the frame is one slow wave. So tiles should be as large as memory allows; a frame of one tile is the plain
/// decode, bit for bit. Throws ShapeError, also for an overlap that is out of its range.
Tensor DecodeTiled(const Vae& vae, const Tensor& latents, const VaeTiles& tiles);

/// How much each tile counts at each pixel of an axis: one row for a tile, columns sum to 1. For the tests.
struct TiledAxis {
  int64_t side = 0;             ///< of a tile, latent pixels; the axis itself where that is shorter
  std::vector<int64_t> starts;  ///< latent pixels
  Tensor weights;               ///< [tiles, pixels of a tile] float32, by image pixel
};
TiledAxis TileAxis(int64_t length, const VaeTiles& tiles, int64_t pixels_per_latent);

}  // namespace oraclegs::seva
