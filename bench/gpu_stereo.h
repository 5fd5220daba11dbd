#pragma once
// Depth of synthetic photographs, as the program finds it with the search on a GPU: what gpu_bench times.

#include "bench/gpu_table.h"
#include "oraclegs/depth/plane_search.h"

namespace oraclegs {

/// Photographs of a slanted, textured plane, each compared with five others, with the default options; the second of
/// two runs, when memory has its size.
GpuStereo MeasureStereo(int width, int height, PlaneSearch* search);

}  // namespace oraclegs
