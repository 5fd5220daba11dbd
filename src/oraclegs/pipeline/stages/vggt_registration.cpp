#include "oraclegs/pipeline/stages/vggt_registration.h"

#include <algorithm>

#include "oraclegs/networks/vggt/point_cloud.h"
#include "oraclegs/networks/vggt/weights_file.h"
#include "oraclegs/networks/vggt/memory.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/sfm/colmap_staging.h"
#include "oraclegs/sfm/colmap_workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostPoints = 40000;  // asked about; the surer half of them is looked at
constexpr size_t kFewPoints = 100;     // a cloud that says the cameras are not right
constexpr double kGiB = 1024.0 * 1024 * 1024;
constexpr VggtHeads kHeads{.camera = true, .depth = true, .points = false};

/// Photographs as they stand upright in work_dir/images, and what VGGT says of them.
struct Seen {
  std::vector<Image8> photos;
  std::vector<Camera> cameras;
  std::vector<CloudPoint> cloud;
};

Seen LookAt(const std::vector<StagedView>& plan, const VggtWeights& weights, const fs::path& work_dir,
            const Listener& listener, torch::Device device) {
  Seen seen;
  std::vector<std::string> names;
  for (const StagedView& staged : plan) {
    names.push_back(fs::path(staged.name).filename().string());
    seen.photos.push_back(ReadImage(work_dir / "images" / staged.name));
  }
  const VggtFile file = ReadVggtFile(weights.path);
  const int64_t patch = file.network.aggregator.backbone.patch;
  const VggtInput input = PrepareVggtInput(seen.photos, VggtFit::kWhole, file.side, patch);
  const int64_t height = input.images.size(2), width = input.images.size(3);
  const int64_t needed = VggtWeightBytes(file.network, kHeads) +
                         VggtPassBytes(file.network, {static_cast<int64_t>(plan.size()), height, width, kHeads});
  const VggtPlacement placement = PlaceVggt(device);
  RequirePoseMemory(plan.size(), needed, static_cast<uint64_t>(FreeBytes(device)));
  listener(Note{fmt::format("{} looks at {} photographs of {} x {} at once, which needs about {:.1f} GiB", weights.name,
                            plan.size(), width, height, static_cast<double>(needed) / kGiB)});
  const Vggt vggt = LoadVggt({weights.path}, kHeads, placement, file.network);
  const AggregatorResult aggregated = Aggregate(vggt.aggregator, input.images.to(device), {HeadLayers(vggt), {}});
  const Tensor encodings = PredictCameras(vggt, aggregated).back().to(torch::kCPU);
  seen.cameras = PhotographCameras(encodings, input, seen.photos, names);
  DepthPrediction depth = PredictDepth(vggt, aggregated, {height / patch, width / patch});
  depth = {depth.depth.to(torch::kCPU).contiguous(), depth.confidence.to(torch::kCPU).contiguous()};
  seen.cloud = MakeCloud({seen.cameras, seen.photos, input, depth}, kMostPoints);
  return seen;
}

/// False where a mask says that the pixel must not count.
class Masks {
 public:
  Masks(const std::vector<StagedView>& plan, const fs::path& work_dir) {
    for (const StagedView& staged : plan) {
      const fs::path path = work_dir / "masks" / (staged.name + ".png");
      std::error_code ignored;
      masks_.push_back(fs::exists(path, ignored) ? ReadImage(path) : Image8());
    }
  }
  bool Counts(const CloudSight& sight) const {
    const Image8& mask = masks_[static_cast<size_t>(sight.photograph)];
    if (mask.data.empty()) return true;
    const int x = std::clamp(static_cast<int>(sight.pixel.x()), 0, mask.width - 1);
    const int y = std::clamp(static_cast<int>(sight.pixel.y()), 0, mask.height - 1);
    return mask.data[(static_cast<size_t>(y) * mask.width + x) * mask.channels] > 0;
  }

 private:
  std::vector<Image8> masks_;
};

/// Image and camera ids are 1 + the photograph's index.
void WriteModel(const Seen& seen, const std::vector<StagedView>& plan, const fs::path& work_dir) {
  ColmapCameras cameras;
  std::vector<ColmapImage> images;
  for (size_t v = 0; v < plan.size(); ++v) {
    const Camera& c = seen.cameras[v];
    const auto id = static_cast<uint32_t>(v + 1);
    cameras[id] = {CameraModel::kPinhole, c.width, c.height, {c.fx, c.fy, c.cx, c.cy}};
    images.push_back({id, plan[v].name, id, c.cam_from_world});
  }
  const Masks masks(plan, work_dir);
  std::vector<ColmapTrack> tracks;
  for (const CloudPoint& point : seen.cloud) {
    ColmapTrack track{point.xyz, point.rgb, {}};
    for (const CloudSight& sight : point.sights) {
      if (masks.Counts(sight)) track.sights.push_back({static_cast<uint32_t>(sight.photograph + 1), sight.pixel});
    }
    if (track.sights.size() >= 2) tracks.push_back(std::move(track));
  }
  MakeFolder(work_dir / "sparse" / "0");
  WriteColmapText(work_dir / "sparse" / "0", cameras, images, tracks);
}

}  // namespace

void RequirePoseMemory(size_t views, int64_t needed, uint64_t available) {
  if (available == 0 || static_cast<uint64_t>(needed) <= available) return;
  throw RunError(
      "VGGT needs about {:.1f} GiB of memory to look at {} photographs at once, {:.1f} GiB are free; give fewer "
      "photographs, or use --poses colmap",
      static_cast<double>(needed) / kGiB, views, static_cast<double>(available) / kGiB);
}

Scene RegisterWithVggt(const Scene& photos, const VggtWeights& weights, const fs::path& work_dir,
                       const Listener& listener, torch::Device device) {
  if (photos.views.size() < 2) {
    throw InputError("{}: has one photograph; VGGT needs at least two of the scene", photos.root.string());
  }
  std::vector<int> views;
  for (size_t v = 0; v < photos.views.size(); ++v) views.push_back(static_cast<int>(v));
  nlohmann::json inputs = DescribeInputs(photos, views);
  inputs["vggt"] = weights.fingerprint;
  const std::vector<StagedView> plan = PlanStaging(photos, views);
  if (IsUnchanged(work_dir, inputs)) {
    RestoreImages(photos, views, plan, work_dir);
  } else {
    ClearWorkDir(work_dir);
    StageImages(photos, views, plan, work_dir);
    const Seen seen = LookAt(plan, weights, work_dir, listener, device);
    WriteModel(seen, plan, work_dir);
    MarkDone(work_dir, inputs);
  }
  Scene scene = RegisteredScene(photos, ReadModel(photos, views, plan, work_dir, listener));
  if (scene.points.size() < kFewPoints) {
    listener(Warning{fmt::format(
        "VGGT's depth maps agree on {} points only: its cameras may be wrong; --poses colmap is the other way",
        scene.points.size())});
  }
  listener(Note{fmt::format("registered {} of {} photographs with {}, {} points", scene.views.size(),
                            photos.views.size(), weights.name, scene.points.size())});
  return scene;
}

}  // namespace oraclegs
