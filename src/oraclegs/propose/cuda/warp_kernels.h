#pragma once
// Stages of a forward warp on a GPU, one thread per depth or pixel. All memory is the device's. Samples of a pixel are
// counted, given their places by running sums, and listed. A list may hold any number of samples and is sorted by all
// members of a sample, so that its order does not depend on the threads. Pixels are listed in bands, one after another,
// so that the lists need not fit into memory at once.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/propose/warp_math.h"

namespace oraclegs::cuda {

/// Consecutive pixels whose samples, fewer than 2^32, are listed together.
struct PixelBand {
  int64_t begin = 0, end = 0;  ///< pixels
  uint32_t first = 0;          ///< number of samples of the pixels before it, modulo 2^32
  int64_t samples = 0;
};

/// Adds to counts [pixels] how many depths of source `k` fall on each pixel. All sources together have fewer than 2^32
/// pixels.
void RunCountSamples(const WarpScene& scene, const WarpSource& source, int k, uint32_t* counts, cudaStream_t stream);

/// The lists of a band's pixels, in order.
struct SampleLists {
  PixelBand band;
  uint32_t* ends;       ///< [pixels], end of each pixel's list; begins at the number of samples before it, and
                        ///< RunListSamples moves it on
  WarpSample* samples;  ///< [band.samples]
};
/// Appends the samples of source `k`.
void RunListSamples(const WarpScene& scene, const WarpSource& source, int k, const SampleLists& lists,
                    cudaStream_t stream);

/// Input and output of RunFindSurfaces for the pixels of a band, after all sources were listed.
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
