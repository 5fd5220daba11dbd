#include "oraclegs/stages/vggt_registration.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "oraclegs/image/read_image.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/scene/colmap_files.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/sfm/colmap_staging.h"
#include "oraclegs/sfm/colmap_workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMinPointsToTrust = 100;  // a smaller cloud hints that the cameras are wrong

/// Asks the network about the images as they stand upright in work_dir/images.
PoseEstimate Estimate(const std::vector<StagedView>& plan, const VggtWeights& weights, const fs::path& work_dir,
                      const Listener& listener, Device device) {
  const Networks& networks = GetNetworks();
  PoseRequest request;
  request.weights = weights.path;
  request.network = weights.name;
  for (const StagedView& staged : plan) {
    request.names.push_back(fs::path(staged.name).filename().string());
    request.images.push_back(ReadImage(work_dir / "images" / staged.name));
  }
  request.device = DeviceOfNetworks(networks, device, listener);
  request.free_bytes = FreeBytes(request.device);
  return networks.EstimatePoses(request, listener);
}

/// Masks of the images, where they have one.
class Masks {
 public:
  Masks(const std::vector<StagedView>& plan, const fs::path& work_dir) {
    for (const StagedView& staged : plan) {
      const fs::path path = work_dir / "masks" / (staged.name + ".png");
      std::error_code ignored;
      masks_.push_back(fs::exists(path, ignored) ? ReadImage(path) : Image8());
    }
  }
  /// False where a mask excludes the pixel.
  bool Counts(const CloudSight& sight) const {
    const Image8& mask = masks_[static_cast<size_t>(sight.view)];
    if (mask.data.empty()) return true;
    const int x = std::clamp(static_cast<int>(sight.pixel.x()), 0, mask.width - 1);
    const int y = std::clamp(static_cast<int>(sight.pixel.y()), 0, mask.height - 1);
    return mask.data[(static_cast<size_t>(y) * mask.width + x) * mask.channels] > 0;
  }

 private:
  std::vector<Image8> masks_;
};

/// Image and camera ids are 1 + the image's index.
void WriteModel(const PoseEstimate& estimate, const std::vector<StagedView>& plan, const fs::path& work_dir) {
  ColmapCameras cameras;
  std::vector<ColmapImage> images;
  for (size_t v = 0; v < plan.size(); ++v) {
    const Camera& c = estimate.cameras[v];
    const auto id = static_cast<uint32_t>(v + 1);
    cameras[id] = {CameraModel::kPinhole, c.width, c.height, {c.fx, c.fy, c.cx, c.cy}};
    images.push_back({id, plan[v].name, id, c.cam_from_world});
  }
  const Masks masks(plan, work_dir);
  std::vector<ColmapTrack> tracks;
  for (const CloudPoint& point : estimate.cloud) {
    ColmapTrack track{point.xyz, point.rgb, {}};
    for (const CloudSight& sight : point.sights) {
      if (masks.Counts(sight)) track.observations.push_back({static_cast<uint32_t>(sight.view + 1), sight.pixel});
    }
    if (track.observations.size() >= 2) tracks.push_back(std::move(track));
  }
  MakeFolder(work_dir / "sparse" / "0");
  WriteColmapText(work_dir / "sparse" / "0", cameras, images, tracks);
}

}  // namespace

Scene RegisterWithVggt(const Scene& photos, const VggtWeights& weights, const fs::path& work_dir,
                       const Listener& listener, Device device) {
  if (photos.views.size() < 2) {
    throw InputError("{}: has one photo; VGGT needs at least two of the scene", photos.root.string());
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
    WriteModel(Estimate(plan, weights, work_dir, listener, device), plan, work_dir);
    MarkDone(work_dir, inputs);
  }
  Scene scene = RegisteredScene(photos, ReadModel(photos, views, plan, work_dir, listener));
  if (scene.points.size() < kMinPointsToTrust) {
    listener(
        Warning{fmt::format("VGGT's depth maps agree on {} points only: its cameras may be wrong; try --poses colmap",
                            scene.points.size())});
  }
  listener(Note{fmt::format("registered {} of {} photos with {}, {} points", scene.views.size(), photos.views.size(),
                            weights.name, scene.points.size())});
  return scene;
}

}  // namespace oraclegs
