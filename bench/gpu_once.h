#pragma once
// What a run asks a GPU for a few times only, before it trains, beside the same on the CPU.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/depth/plane_search.h"

namespace oraclegs {

/// Milliseconds; the GPU's the median of several, the CPU's of one.
struct OnBoth {
  double gpu = 0, cpu = 0;
};

/// The mean squared distance to the three nearest neighbors of random points.
OnBoth MeasureNeighbors(int64_t points, int passes);

/// A view warped from `images` others of its size, holes filled (on the CPU) and all.
struct WarpSize {
  int images = 12;
  int width = 0, height = 0;  ///< pixels
};
OnBoth MeasureWarp(const WarpSize& size, int passes);

/// Depth with the search on the GPU, seconds an image.
struct GpuStereo {
  double seconds = 0;         ///< with what the CPU does
  double search_seconds = 0;  ///< of these, with the copies to and fro
};

/// Of images of a slanted, textured plane, each compared with five others, with the default options; the second of two
/// runs, when memory has its size.
GpuStereo MeasureStereo(int width, int height, PlaneSearch* search);

/// A line of text, ended: "WHAT: 1.0 ms, on the CPU 20 ms".
std::string OnBothText(const std::string& what, const OnBoth& times);
std::string StereoText(const GpuStereo& times);

/// {"NAME_ms": ..., "NAME_cpu_ms": ...}
nlohmann::json OnBothToJson(const std::string& name, const OnBoth& times);
nlohmann::json StereoToJson(const GpuStereo& times);

}  // namespace oraclegs
