#include "bench/stage_meter.h"

#include <chrono>

#include "oraclegs/core/statistics.h"
#include "oraclegs/render/cpu/kernels.h"

namespace oraclegs {
namespace {

constexpr double kFlopsPerPair = 34, kFlopsPerPairBackward = 64;  // of a pixel-Gaussian pair that is evaluated

// Bytes. A Gaussian has 3 + 3 + 4 + 1 geometry parameters and 48 of color.
constexpr double kGeometry = 11 * sizeof(float), kColor = 48 * sizeof(float), kAll = kGeometry + kColor;
constexpr double kSplat = sizeof(cpu::LineSplat), kRect = sizeof(TileRect), kEntry = sizeof(cpu::TileEntry);
constexpr double kGradRecord = cpu::kGradStride * sizeof(float);
constexpr double kDepthKey = 8;                             // depth and index
constexpr double kPairTile = 4, kPairMask = 4, kRange = 8;  // of a pair; a Gaussian's pairs
constexpr double kRgb = 3 * sizeof(float);

/// The fields that are medians or differences, in any order.
template <class F>
void ForEachNumber(IterationSample* sample, F&& f) {
  for (double& stage : sample->milliseconds) f(stage);
  f(sample->visible), f(sample->tile_pairs), f(sample->pixel_pairs), f(sample->pixel_pairs_backward), f(sample->total);
}

std::vector<double> Numbers(IterationSample sample) {
  std::vector<double> numbers;
  ForEachNumber(&sample, [&](double& x) { numbers.push_back(x); });
  return numbers;
}

}  // namespace

const char* StageName(IterationStage stage) {
  switch (stage) {
    case IterationStage::kProject:
      return "project";
    case IterationStage::kBin:
      return "bin";
    case IterationStage::kBlend:
      return "blend";
    case IterationStage::kLoss:
      return "loss";
    case IterationStage::kBlendBackward:
      return "blend_backward";
    case IterationStage::kUpdate:
      return "update";
  }
  return "";
}

bool IsComputeBound(IterationStage stage) {
  return stage == IterationStage::kBlend || stage == IterationStage::kBlendBackward;
}

IterationSample TimedStep(Trainer* trainer) {
  const auto start = std::chrono::steady_clock::now();
  trainer->Step();
  const double total = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const TrainTimings t = trainer->LastTimings();
  const RenderStats s = trainer->LastStats();
  return {{t.render.project, t.render.bin, t.render.blend, t.loss, t.render.blend_backward, t.render.gaussian_backward},
          static_cast<double>(s.visible),
          static_cast<double>(s.tile_pairs),
          static_cast<double>(s.pixel_pairs),
          static_cast<double>(s.pixel_pairs_backward),
          total};
}

IterationSample MedianOf(const std::vector<IterationSample>& samples) {
  std::vector<std::vector<double>> rows;
  for (const IterationSample& sample : samples) rows.push_back(Numbers(sample));
  IterationSample median;
  size_t field = 0;
  ForEachNumber(&median, [&](double& x) {
    std::vector<double> values;
    for (const auto& row : rows) values.push_back(row[field]);
    x = UpperMedian(std::move(values));
    ++field;
  });
  return median;
}

double LeastWork(IterationStage stage, const IterationShape& shape, const IterationSample& found) {
  const double n = shape.gaussians, visible = found.visible, pairs = found.tile_pairs;
  switch (stage) {
    case IterationStage::kProject:
      // Reads every Gaussian's geometry and writes its rectangle; of the visible reads the color, writes the splat.
      return n * (kGeometry + kRect) + visible * (kColor + kSplat);
    case IterationStage::kBin:
      // Reads rectangles and the visible ones' splats, writes and reads their depth keys once (a sort of one pass);
      // writes each Gaussian's range of pairs, and each pair's tile, blocks and entry.
      return n * (kRect + kRange) + visible * (kSplat + 2 * kDepthKey) + pairs * (kPairTile + kPairMask + kEntry);
    case IterationStage::kLoss:
      // Reads render and image, writes the gradient; SSIM's windows stay in the caches.
      return 3 * kRgb * shape.pixels;
    case IterationStage::kUpdate:
      // Reads each pair's gradient record and tile, the visible ones' splats; reads and writes parameters and both
      // moments. Gradients need not exist in memory.
      return pairs * (kGradRecord + kPairTile) + visible * kSplat + n * (kRange + 2 * 3 * kAll);
    case IterationStage::kBlend:
      return kFlopsPerPair * found.pixel_pairs;
    case IterationStage::kBlendBackward:
      return kFlopsPerPairBackward * found.pixel_pairs_backward;
  }
  return 0;
}

double ShareOfCeiling(IterationStage stage, const IterationShape& shape, const IterationSample& found,
                      const Ceilings& ceilings) {
  const double per_second = LeastWork(stage, shape, found) / (found.Milliseconds(stage) / 1000);
  return per_second / (IsComputeBound(stage) ? ceilings.flops : ceilings.bytes);
}

}  // namespace oraclegs
