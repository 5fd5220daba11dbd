#include "oraclegs/networks/vggt/poses.h"

#include "oraclegs/networks/common/tensor.h"
#include "oraclegs/networks/vggt/point_cloud.h"
#include "oraclegs/networks/vggt/vggt.h"
#include "oraclegs/networks/vggt/weights_file.h"

namespace oraclegs::vggt {
namespace {

constexpr size_t kMaxLatticePoints = 40000;  // before selection; the half of higher depth confidence becomes points
constexpr double kGiB = 1024.0 * 1024 * 1024;
constexpr Heads kHeads{.camera = true, .depth = true};

}  // namespace

void RequirePoseMemory(size_t images, int64_t needed, uint64_t available) {
  if (available == 0 || static_cast<uint64_t>(needed) <= available) return;
  throw RunError(
      "VGGT needs about {:.1f} GiB of memory to look at {} photos at once, {:.1f} GiB are free; give fewer photos, or "
      "use --poses colmap",
      static_cast<double>(needed) / kGiB, images, static_cast<double>(available) / kGiB);
}

PoseEstimate EstimatePoses(const PoseRequest& request, const Listener& listener) {
  const WeightsFile file = ReadWeightsFile(request.weights);
  const int64_t patch = file.network.aggregator.backbone.patch;
  const Input input = PrepareInput(request.images, Fit::kWhole, file.side, patch);
  const int64_t height = input.images.size(2), width = input.images.size(3);
  const auto images = static_cast<int64_t>(request.images.size());
  const int64_t needed = WeightBytes(file.network, kHeads) + PassBytes(file.network, {images, height, width, kHeads});
  RequirePoseMemory(request.images.size(), needed, static_cast<uint64_t>(request.free_bytes));
  listener(Note{fmt::format("{} looks at {} photos of {} x {} at once, which needs about {:.1f} GiB", request.network,
                            images, width, height, static_cast<double>(needed) / kGiB)});
  const torch::Device device = ToTorch(request.device);
  const Vggt vggt = LoadVggt({request.weights}, kHeads, PlaceOn(device), file.network);
  const AggregatorResult aggregated = Aggregate(vggt.aggregator, input.images.to(device), {HeadLayers(vggt), {}});
  const Tensor encodings = PredictCameras(vggt, aggregated).back().to(torch::kCPU);
  PoseEstimate estimate;
  estimate.cameras = ImageCameras(encodings, input, request.images, request.names);
  DepthPrediction depth = PredictDepth(vggt, aggregated, {height / patch, width / patch});
  depth = {depth.depth.to(torch::kCPU).contiguous(), depth.confidence.to(torch::kCPU).contiguous()};
  estimate.cloud = MakeCloud({estimate.cameras, request.images, input, depth}, kMaxLatticePoints);
  return estimate;
}

}  // namespace oraclegs::vggt
