#include "oraclegs/propose/warp.h"

#include <algorithm>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/depth/confidence.h"
#include "oraclegs/depth/plane.h"
#include "oraclegs/propose/fill_holes.h"
#include "oraclegs/propose/warp_device.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxWarped = 8;  // views that one is warped from

void CheckSizes(const WarpSources& sources) {
  if (sources.maps.size() > sources.views.size()) {
    throw ShapeError("Warper: {} depth maps of {} views", sources.maps.size(), sources.views.size());
  }
  if (!sources.gains.empty() && sources.gains.size() != sources.views.size()) {
    throw ShapeError("Warper: {} gains of {} views", sources.gains.size(), sources.views.size());
  }
  for (size_t v = 0; v < sources.maps.size(); ++v) {
    const LoadedView& view = sources.views[v];
    const DepthMap& map = sources.maps[v];
    if (map.size() == 0) continue;
    const size_t pixels = static_cast<size_t>(map.camera.width) * static_cast<size_t>(map.camera.height);
    if (view.rgb.width != map.camera.width || view.rgb.height != map.camera.height ||
        view.rgb.data.size() != 3 * pixels || map.inv_depth.size() != pixels || map.confidence.size() != pixels ||
        (!view.mask.empty() && view.mask.size() != pixels)) {
      throw ShapeError("Warper: {} is {} x {}, its depth or its mask is not", view.name, view.rgb.width,
                       view.rgb.height);
    }
  }
}

WarpSource SourceOf(const WarpSources& all, size_t v, const Camera& camera) {
  const DepthMap& map = all.maps[v];
  const LoadedView& view = all.views[v];
  WarpSource source;
  source.rgb = view.rgb.data.data();
  source.inv_depth = map.inv_depth.data(), source.confidence = map.confidence.data();
  if (!view.mask.empty()) source.mask = view.mask.data();
  if (all.silhouettes != nullptr && !all.silhouettes->empty()) source.near_object = all.silhouettes->Mask(v).grown;
  source.width = map.camera.width, source.height = map.camera.height;
  source.number = static_cast<int>(v);
  source.focal = static_cast<float>(map.camera.fx);
  source.magnification = static_cast<float>(camera.fx / map.camera.fx);
  source.exposed = !all.gains.empty();
  if (source.exposed) std::copy_n(all.gains[v].data(), 3, source.gain);
  source.to_new = Plain(MapBetween(map.camera, camera)), source.from_new = Plain(MapBetween(camera, map.camera));
  const Eigen::Vector3f center = (camera.cam_from_world * map.camera.Center()).cast<float>();
  source.center = {center.x(), center.y(), center.z()};
  return source;
}

}  // namespace

Warper::Warper(WarpSources sources, Device device) : sources_(std::move(sources)), nearest_sources_(sources_.maps) {
  CheckSizes(sources_);
  device_ = MakeWarpDevice(device, sources_);
  FindRange();
}

Warper::Warper(WarpSources sources, std::unique_ptr<WarpDevice> device)
    : sources_(std::move(sources)), nearest_sources_(sources_.maps), device_(std::move(device)) {
  CheckSizes(sources_);
  FindRange();
}

Warper::~Warper() = default;

void Warper::FindRange() {
  std::vector<float> depths;
  for (const DepthMap& map : sources_.maps) {
    for (size_t i = 0; i < map.size(); i += 7) {
      if (map.confidence[i] >= kConfident) depths.push_back(1 / map.inv_depth[i]);
    }
  }
  if (depths.empty()) return;
  const auto at = [&](double share) {
    const auto nth = depths.begin() + static_cast<int64_t>(share * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), nth, depths.end());
    return *nth;
  };
  nearest_ = 0.8f * at(0.005), farthest_ = 1.25f * at(0.995);
}

WarpTask Warper::TaskOf(const Camera& camera, std::optional<int> held_out) const {
  WarpTask task;
  WarpScene& scene = task.scene;
  scene.width = camera.width, scene.height = camera.height;
  scene.fx = static_cast<float>(camera.fx), scene.fy = static_cast<float>(camera.fy);
  scene.cx = static_cast<float>(camera.cx), scene.cy = static_cast<float>(camera.cy);
  std::copy(sources_.background.begin(), sources_.background.end(), scene.background);
  scene.bounded = sources_.silhouettes != nullptr && !sources_.silhouettes->empty() && nearest_ > 0;
  scene.nearest = nearest_, scene.farthest = farthest_;
  std::optional<size_t> but;
  if (held_out) but = static_cast<size_t>(*held_out);
  for (const size_t v : nearest_sources_.For(camera, kMaxWarped, but)) {
    task.sources.push_back(SourceOf(sources_, v, camera));
    if (!held_out) continue;
    task.confidence.push_back(ConfidenceWithout(sources_.maps, v, {*held_out}));
    task.sources.back().confidence = task.confidence.back().data();
  }
  return task;
}

WarpDepth Warper::Surfaces(const Camera& camera) const { return device_->FindSurfaces(TaskOf(camera, std::nullopt)); }

WarpedView Warper::Warp(const Camera& camera, std::optional<int> held_out) const {
  const WarpTask task = TaskOf(camera, held_out);
  const size_t pixels = task.scene.pixels();
  WarpDepth depth = device_->FindSurfaces(task);
  std::vector<uint8_t> to_fill(pixels);
  for (size_t i = 0; i < pixels; ++i) to_fill[i] = !(depth.inv_depth[i] > 0) && depth.beside[i] == 0;
  const std::vector<float> rings = FillDepth(camera.width, camera.height, to_fill, &depth.inv_depth);
  WarpedView view;
  view.rgb = {camera.width, camera.height, 3, std::vector<float>(3 * pixels)};
  view.evidence.resize(pixels);
  view.provenance.resize(pixels);
  const std::vector<float> known = device_->Shade(task, depth, &view);
  for (size_t i = 0; i < pixels; ++i) view.evidence[i].ring = rings[i];
  view.inv_depth = std::move(depth.inv_depth);
  PushPull(known, &view.rgb);
  return view;
}

std::optional<Proposal> WarpProposer::Propose(const Target& target, std::optional<int> held_out) const {
  WarpedView view = warper_.Warp(target.camera, held_out);
  Proposal proposal{target.name, name(), target.camera, std::move(view.rgb)};
  proposal.inv_depth = std::move(view.inv_depth);
  proposal.provenance = std::move(view.provenance);
  return proposal;
}

}  // namespace oraclegs
