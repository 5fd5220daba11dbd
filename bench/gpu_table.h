#pragma once
// The table of gpu_bench: for each stage of an iteration its time and the least possible time. Plain numbers, so that
// it is tested without a GPU.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace oraclegs {

/// Amount of work of an iteration.
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
  double forward = 0;                                ///< the rasterizer's whole forward pass
  double iteration = 0;                              ///< whole iteration, queued without waits in between
  double sending = 0;                                ///< time of the host per iteration
  double refine = 0;                                 ///< relocation, in each hundredth iteration
};

/// Limits of the device, measured in the same run.
struct GpuCeilings {
  double bytes = 0;  ///< per second, copied: read plus written
  double flops = 0;  ///< per second, fused multiply-adds from registers
};

struct GpuStage {
  std::string name;
  double ms = 0;
  double bytes = 0;  ///< least bytes read and written; 0 = no floor known
  double flops = 0;  ///< 0 = negligible beside the bytes
};

/// The stages of one iteration, then the whole forward pass and the whole iteration.
std::vector<GpuStage> GpuStages(const GpuWork& work, const GpuTimes& times);

/// Least milliseconds of the stage at the ceilings, the larger of memory and arithmetic; 0 where no floor is known.
double FloorMilliseconds(const GpuStage& stage, const GpuCeilings& ceilings);

struct GpuReport {
  GpuWork work;
  GpuTimes times;
  GpuCeilings ceilings;
  double scratch_bytes = 0;   ///< rasterizer memory per Gaussian
  double training_bytes = 0;  ///< all device memory of training per Gaussian
};

/// Lines of text, each ended.
std::string GpuTable(const GpuReport& report);

/// JSON for bench/gsplat_bench.py and scripts/gpu_check.sh.
nlohmann::json GpuReportToJson(const GpuReport& report);

}  // namespace oraclegs
