#pragma once
// The table that gpu_bench prints: the least time that each stage of an iteration could take beside what it took. Plain
// numbers, so that it is tested without a GPU.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace oraclegs {

/// How much work an iteration found.
struct GpuWork {
  double gaussians = 0, visible = 0;
  double tile_pairs = 0;                             ///< (tile, Gaussian)
  double pixel_pairs = 0, pixel_pairs_backward = 0;  ///< (pixel, Gaussian) evaluated
  double pixels = 0;
};

/// Milliseconds, each the median of several iterations.
struct GpuTimes {
  double factors = 0;  ///< opacity factors
  double project = 0, bin = 0, blend = 0;
  double loss = 0;
  double blend_backward = 0, gaussian_backward = 0;  ///< the latter with regularizers, Adam and noise
  double forward = 0;                                ///< the rasterizer's, as a whole
  double iteration = 0;                              ///< of many that were sent without a wait between
  double sending = 0;                                ///< what the host spent on it
  double refine = 0;                                 ///< relocation, which comes with each hundredth iteration
};

/// What the device can do at most, measured in the same run.
struct GpuCeilings {
  double bytes = 0;  ///< a second, copying, read and written
  double flops = 0;  ///< a second, fused multiply-adds from registers
};

struct GpuStage {
  std::string name;
  double ms = 0;
  double bytes = 0;  ///< that must be read and written at least; 0: no floor is known
  double flops = 0;  ///< 0: little beside the bytes
};

/// The stages of one iteration, then the whole forward pass and the whole iteration.
std::vector<GpuStage> GpuStages(const GpuWork& work, const GpuTimes& times);

/// Milliseconds that the stage would take at the ceilings, the larger of both; 0 where no floor is known.
double FloorMilliseconds(const GpuStage& stage, const GpuCeilings& ceilings);

struct GpuReport {
  GpuWork work;
  GpuTimes times;
  GpuCeilings ceilings;
  double scratch_bytes = 0;   ///< of the rasterizer, a Gaussian
  double training_bytes = 0;  ///< of everything that training took of the device's memory, a Gaussian
};

/// Lines of text, each ended.
std::string GpuTable(const GpuReport& report);

/// For bench/gsplat_bench.py and scripts/gpu_check.sh.
nlohmann::json GpuReportToJson(const GpuReport& report);

}  // namespace oraclegs
