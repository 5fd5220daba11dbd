#pragma once
// The stages of a forward warp on a GPU, one thread a depth or a pixel. All memory is the device's. What falls on a
// pixel is counted, given its place by running sums, and listed; the lists may hold any number of samples, and are
// sorted by all that a sample has, so that their order does not depend on that of the threads. Pixels are listed in
// bands, one after another, so that the lists need not fit into memory at once.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/propose/warp_math.h"

namespace oraclegs::cuda {

/// A run of pixels whose samples, fewer than 2^32, are listed together.
struct PixelBand {
  int64_t begin = 0, end = 0;  ///< pixels
  uint32_t first = 0;          ///< samples of the pixels before it, modulo 2^32
  int64_t samples = 0;
};

/// counts [pixels] += how many of the depths of source `k` fall on each pixel. All sources together have fewer than
/// 2^32 pixels.
void RunCountSamples(const WarpScene& scene, const WarpSource& source, int k, uint32_t* counts, cudaStream_t stream);

/// The lists of a band's pixels, one after another.
struct SampleLists {
  PixelBand band;
  uint32_t* ends;       ///< [pixels], samples of the pixels before each; RunListSamples moves them behind what it adds
  WarpSample* samples;  ///< [band.samples]
};
/// Adds the samples of source `k`.
void RunListSamples(const WarpScene& scene, const WarpSource& source, int k, const SampleLists& lists,
                    cudaStream_t stream);

/// What FindSurfaces writes, of the band's pixels; counts and ends after all sources were listed.
struct SurfacesInput {
  WarpScene scene;
  PixelBand band;
  const uint32_t *counts, *ends;  ///< [pixels]
  WarpSample* samples;            ///< [band.samples], overwritten
  float* inv_depth;               ///< [pixels]
  uint8_t* beside;                ///< [pixels]
};
void RunFindSurfaces(const SurfacesInput& in, cudaStream_t stream);

struct ShadeInput {
  WarpScene scene;
  const float* inv_depth;  ///< [pixels]
  const uint8_t* beside;   ///< [pixels]
  float *rgb, *known;      ///< [pixels,3], [pixels]
  PixelEvidence* evidence;
  uint16_t* provenance;
};
void RunShade(const ShadeInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
