#include "bench/gpu_fma.h"

#include <vector>

#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr int kChains = 8, kRounds = 2048, kThreads = 256, kBlocks = 1024;

/// Iterates x -> x / 2 + 1, which tends to 2: never denormal. The store, which never happens, prevents elimination of
/// the work.
__global__ void FmaKernel(float* out) {
  float x[kChains];
#pragma unroll
  for (int k = 0; k < kChains; ++k) x[k] = static_cast<float>(threadIdx.x + k);
#pragma unroll 16
  for (int round = 0; round < kRounds; ++round) {
#pragma unroll
    for (int k = 0; k < kChains; ++k) x[k] = fmaf(x[k], 0.5f, 1.f);
  }
  float sum = 0;
#pragma unroll
  for (int k = 0; k < kChains; ++k) sum += x[k];
  if (sum < 0) *out = sum;
}

}  // namespace

double MeasureFmaRate() {
  cuda::DeviceArray<float> out("a number");
  out.ReserveExactly(1);
  cuda::Event begin, end;
  std::vector<double> rates;
  for (int i = 0; i < 8; ++i) {
    begin.Record(nullptr);
    cuda::Launch("multiply-adds", FmaKernel, {kBlocks, kThreads}, nullptr, out.data());
    end.Record(nullptr);
    end.Wait();
    const double seconds = end.MillisecondsSince(begin) * 1e-3;
    rates.push_back(seconds > 0 ? 2.0 * kChains * kRounds * kThreads * kBlocks / seconds : 0);
  }
  return UpperMedian(rates);
}

}  // namespace oraclegs
