#include "bench/gpu_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace oraclegs {
namespace {

// Bytes of one item (render/cuda/splats.h, gaussians/gaussian_rows.h).
constexpr double kSmall = 44, kSh = 192;  // a Gaussian's parameters: without SH, SH
constexpr double kSplat = 48, kRect = 8, kRecord = 40;
constexpr double kImage = 20;               // a pixel of the render: color, alpha, inverse depth
constexpr double kEnds = 4;                 // what backward reads of a pixel beside it
constexpr double kTarget = 3, kColor = 12;  // a pixel as bytes, as floats
// Arithmetic of a pixel in a Gaussian, where it counts (render/cuda/blend_forward.cu, blend_backward.cu).
constexpr double kBlendFlops = 21, kBlendBackwardFlops = 45;

}  // namespace

std::vector<GpuStage> GpuStages(const GpuWork& w, const GpuTimes& t) {
  const double model = kSmall + kSh;
  std::vector<GpuStage> stages = {
      {"opacity factors", t.factors, w.gaussians * 4, 0},
      {"project", t.project, w.gaussians * (kSmall + kRect) + w.visible * (kSh + kSplat), 0},
      // Counts, a sort by depth of 32 bits; then pairs listed, sorted by two bytes of tile, and ranges found.
      {"bin + sort", t.bin, w.gaussians * (kRect + 4 * 16) + w.tile_pairs * (12 + 2 * 16 + 16), 0},
      {"blend", t.blend, w.tile_pairs * (4 + kSplat) + w.pixels * (kImage + kEnds), w.pixel_pairs * kBlendFlops},
      {"loss", t.loss, w.pixels * (kColor + kTarget + kColor), 0},
      {"blend backward", t.blend_backward, w.tile_pairs * (4 + kSplat + kRecord) + w.pixels * (kColor + kImage + kEnds),
       w.pixel_pairs_backward * kBlendBackwardFlops},
      // Parameters and both moments, read and written.
      {"Gaussians, Adam, noise", t.gaussian_backward, w.gaussians * 2 * 3 * model + w.tile_pairs * kRecord, 0}};
  GpuStage forward{"forward", t.forward, 0, 0}, iteration{"iteration", t.iteration, 0, 0};
  for (size_t i = 0; i < stages.size(); ++i) {
    if (i >= 1 && i <= 3) forward.bytes += stages[i].bytes, forward.flops += stages[i].flops;
    iteration.bytes += stages[i].bytes, iteration.flops += stages[i].flops;
  }
  stages.push_back(forward);
  stages.push_back(iteration);
  return stages;
}

double FloorMilliseconds(const GpuStage& stage, const GpuCeilings& ceilings) {
  const auto milliseconds = [](double work, double rate) { return rate > 0 ? 1e3 * work / rate : 0; };
  return std::max(milliseconds(stage.bytes, ceilings.bytes), milliseconds(stage.flops, ceilings.flops));
}

std::string GpuTable(const GpuReport& report) {
  const GpuWork& w = report.work;
  std::string text = fmt::format(
      "{:.0f} Gaussians, {:.0f} visible, {:.0f} pairs, {:.0f} pixels; {:.0f} GB/s, {:.1f} TFLOP/s\n", w.gaussians,
      w.visible, w.tile_pairs, w.pixels, report.ceilings.bytes * 1e-9, report.ceilings.flops * 1e-12);
  text += fmt::format("{:.0f} bytes a Gaussian in training, {:.0f} of them the rasterizer's\n", report.training_bytes,
                      report.scratch_bytes);
  text += fmt::format("{:<24} {:>9} {:>9} {:>9} {:>7}\n", "stage", "ms", "memory ms", "arith. ms", "share");
  for (const GpuStage& stage : GpuStages(w, report.times)) {
    const GpuStage memory{"", 0, stage.bytes, 0}, arithmetic{"", 0, 0, stage.flops};
    const double floor = FloorMilliseconds(stage, report.ceilings);
    text += fmt::format("{:<24} {:>9.3f} {:>9.3f} {:>9.3f} {:>6.0f}%\n", stage.name, stage.ms,
                        FloorMilliseconds(memory, report.ceilings), FloorMilliseconds(arithmetic, report.ceilings),
                        stage.ms > 0 ? 100 * floor / stage.ms : 0);
  }
  text += fmt::format("the host sends an iteration in {:.3f} ms; relocation takes {:.3f} ms, once in 100 iterations\n",
                      report.times.sending, report.times.refine);
  return text;
}

nlohmann::json GpuReportToJson(const GpuReport& report) {
  nlohmann::json stages = nlohmann::json::object();
  for (const GpuStage& stage : GpuStages(report.work, report.times)) {
    stages[stage.name] = {{"ms", stage.ms}, {"floor_ms", FloorMilliseconds(stage, report.ceilings)}};
  }
  return {{"gaussians", report.work.gaussians},
          {"pixels", report.work.pixels},
          {"forward_ms", report.times.forward},
          {"iteration_ms", report.times.iteration},
          {"training_bytes_per_gaussian", report.training_bytes},
          {"bytes_per_second", report.ceilings.bytes},
          {"stages", stages}};
}

}  // namespace oraclegs
