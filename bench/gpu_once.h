#pragma once
// GPU work that a run does only a few times before it trains, compared with the CPU.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/depth/plane_search.h"

namespace oraclegs {

/// Times in milliseconds: the median of several runs on the GPU, one run on the CPU.
struct OnBoth {
  double gpu = 0, cpu = 0;
};

/// Times the mean squared distance to the three nearest neighbors of random points.
OnBoth MeasureNeighbors(int64_t points, int passes);

/// Size of a warp from `images` others of the view's size, with holes filled (on the CPU).
struct WarpSize {
  int images = 12;
  int width = 0, height = 0;  ///< pixels
};
OnBoth MeasureWarp(const WarpSize& size, int passes);

/// Depth with the search on the GPU, seconds per image.
struct GpuStereo {
  double seconds = 0;         ///< whole stage, the CPU's part included
  double search_seconds = 0;  ///< search alone, with copies to and from the GPU
};

/// Times stereo of images of a slanted, textured plane, each compared with five others, with the default options; the
/// second of two runs, when memory has its size.
GpuStereo MeasureStereo(int width, int height, PlaneSearch* search);

/// A line of text, ended: "WHAT: 1.0 ms, on the CPU 20 ms".
std::string OnBothText(const std::string& what, const OnBoth& times);
std::string StereoText(const GpuStereo& times);

/// {"NAME_ms": ..., "NAME_cpu_ms": ...}
nlohmann::json OnBothToJson(const std::string& name, const OnBoth& times);
nlohmann::json StereoToJson(const GpuStereo& times);

}  // namespace oraclegs
