#include "oraclegs/mesh/tsdf.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int kAxisBits = 21;  // of a block's coordinate in a key
constexpr int64_t kAxisOffset = int64_t{1} << (kAxisBits - 1);
constexpr uint64_t kAxisMask = (uint64_t{1} << kAxisBits) - 1;
constexpr int64_t kKeyRows = 8, kBlocksATask = 16;
constexpr uint64_t kFarAway = ~uint64_t{0};  // no key

uint64_t KeyOf(const Eigen::Vector3d& point, double block) {
  uint64_t key = 0;
  for (int c = 0; c < 3; ++c) {
    const double at = std::floor(point[c] / block) + static_cast<double>(kAxisOffset);
    if (!(at >= 0 && at < 2.0 * static_cast<double>(kAxisOffset))) return kFarAway;
    key = key << kAxisBits | static_cast<uint64_t>(at);
  }
  return key;
}

/// A view's observation of a voxel's center.
struct VoxelInView {
  float distance;  // along the normal to the surface on the line of sight; positive before it
  float weight;
};

/// Interpolates the surface between pixel centers; on its border takes the nearest pixel.
class SurfaceSampler {
 public:
  explicit SurfaceSampler(const SurfaceView& view) : view_(view), width_(view.surface.camera.width) {}

  /// Observation along a ray; weight 0 where no pixel is trusted.
  VoxelInView At(const Eigen::Vector3f& ray, float u, float v, float z) const {
    const size_t nearest = Index(static_cast<int>(u), static_cast<int>(v));
    const float weight = view_.weights[nearest];
    if (weight <= 0) return {0, 0};
    const float inverse = InverseDepth(u - 0.5f, v - 0.5f, nearest);
    return {(1 / inverse - z) * -view_.surface.normals[nearest].dot(ray), weight};
  }

 private:
  size_t Index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }

  float InverseDepth(float u, float v, size_t nearest) const {
    const std::vector<float>& inverse = view_.surface.inv_depth;
    const int x = std::clamp(static_cast<int>(std::floor(u)), 0, width_ - 2);
    const int y = std::clamp(static_cast<int>(std::floor(v)), 0, view_.surface.camera.height - 2);
    const size_t a = Index(x, y), b = Index(x, y + 1);
    for (const size_t i : {a, a + 1, b, b + 1}) {
      if (view_.weights[i] <= 0) return inverse[nearest];
    }
    const float s = u - static_cast<float>(x), t = v - static_cast<float>(y);
    return (1 - t) * ((1 - s) * inverse[a] + s * inverse[a + 1]) + t * ((1 - s) * inverse[b] + s * inverse[b + 1]);
  }

  const SurfaceView& view_;
  int width_;
};

}  // namespace

void TsdfBlocks::Add(const SurfaceView& view) {
  const Camera& camera = view.surface.camera;
  const Eigen::Isometry3d world_from_cam = camera.cam_from_world.inverse();
  const double block = voxel_ * kBlockSide;
  const int64_t tasks = (camera.height + kKeyRows - 1) / kKeyRows;
  std::vector<std::vector<uint64_t>> found(static_cast<size_t>(tasks));
  ParallelFor(tasks, [&](int64_t task) {
    std::vector<uint64_t>& keys = found[static_cast<size_t>(task)];
    for (int64_t y = task * kKeyRows; y < std::min<int64_t>(camera.height, (task + 1) * kKeyRows); ++y) {
      for (int64_t x = 0; x < camera.width; ++x) {
        const auto i = static_cast<size_t>(y * camera.width + x);
        if (view.weights[i] <= 0) continue;
        const Eigen::Vector3d ray((static_cast<double>(x) + 0.5 - camera.cx) / camera.fx,
                                  (static_cast<double>(y) + 0.5 - camera.cy) / camera.fy, 1);
        const double z = 1.0 / view.surface.inv_depth[i];
        // The truncation is measured along the normal, as the distance is.
        const double cosine = -view.surface.normals[i].cast<double>().dot(ray);
        const double reach = std::min(truncation_ / std::max(cosine, 1e-3), 4 * truncation_);
        const int steps = static_cast<int>(std::ceil(2 * reach * ray.norm() / (block / 2)));
        for (int k = 0; k <= steps; ++k) {
          const double at = z - reach + 2 * reach * k / std::max(1, steps);
          const uint64_t key = KeyOf(world_from_cam * (at * ray), block);
          if (keys.empty() || keys.back() != key) keys.push_back(key);
        }
      }
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  });
  std::vector<uint64_t> all = std::move(keys_);
  for (const auto& keys : found) all.insert(all.end(), keys.begin(), keys.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (!all.empty() && all.back() == kFarAway) {
    throw UsageError("--voxel is {:.3g}: too small for a scene of this size; leave it out, or give a larger one",
                     voxel_);
  }
  keys_ = std::move(all);
}

std::vector<std::array<int32_t, 3>> TsdfBlocks::Coordinates() const {
  std::vector<std::array<int32_t, 3>> blocks;
  blocks.reserve(keys_.size());
  for (const uint64_t key : keys_) {
    const auto axis = [&](int shift) {
      return static_cast<int32_t>(static_cast<int64_t>(key >> shift & kAxisMask) - kAxisOffset);
    };
    blocks.push_back({axis(2 * kAxisBits), axis(kAxisBits), axis(0)});
  }
  return blocks;
}

int64_t TsdfBlocks::CountAt(int doublings) const {
  std::vector<std::array<int32_t, 3>> blocks = Coordinates();
  for (auto& block : blocks) {
    for (int32_t& axis : block) axis >>= doublings;
  }
  std::sort(blocks.begin(), blocks.end());
  return std::unique(blocks.begin(), blocks.end()) - blocks.begin();
}

void RequireRoom(const TsdfBlocks& blocks, uint64_t available) {
  const auto fits = static_cast<int64_t>(available / kBlockBytes);
  if (available == 0 || blocks.count() <= fits) return;
  constexpr int kMaxDoublings = 20;  // one block holds all
  int doublings = 1;
  while (doublings < kMaxDoublings && blocks.CountAt(doublings) > fits) ++doublings;
  constexpr double kGibibyte = 1 << 30;
  throw UsageError("--voxel is {:.3g}: the grid needs {:.1f} GiB, {:.1f} GiB are free; {:.3g} fits", blocks.voxel(),
                   static_cast<double>(blocks.count() * kBlockBytes) / kGibibyte,
                   static_cast<double>(available) / kGibibyte, blocks.voxel() * (1 << doublings));
}

TsdfVolume::TsdfVolume(const TsdfBlocks& blocks)
    : voxel_(blocks.voxel()),
      truncation_(static_cast<float>(blocks.truncation())),
      blocks_(blocks.Coordinates()),
      distances_(blocks_.size() * kBlockVoxels, 1.f),
      weights_(blocks_.size() * kBlockVoxels, 0.f) {}

void TsdfVolume::Integrate(const SurfaceView& view) {
  const Camera& camera = view.surface.camera;
  const Eigen::Matrix3f rotation = camera.cam_from_world.linear().cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  const SurfaceSampler sampler(view);
  ParallelBlocks(static_cast<int64_t>(blocks_.size()), kBlocksATask, [&](int64_t begin, int64_t end) {
    for (int64_t b = begin; b < end; ++b) {
      const auto& block = blocks_[static_cast<size_t>(b)];
      // In double so far: a scene may be far from its origin.
      const Eigen::Vector3d corner(block[0], block[1], block[2]);
      const Eigen::Vector3f origin =
          (camera.cam_from_world * Eigen::Vector3d(corner * kBlockSide * voxel_)).cast<float>();
      for (int64_t i = 0; i < kBlockVoxels; ++i) {
        const Eigen::Vector3f offset(static_cast<float>(i >> 6), static_cast<float>(i >> 3 & 7),
                                     static_cast<float>(i & 7));
        const Eigen::Vector3f point = origin + rotation * (offset * static_cast<float>(voxel_));
        const float z = point.z();
        if (z <= 0) continue;
        const Eigen::Vector3f ray = point / z;
        const float u = fx * ray.x() + cx, v = fy * ray.y() + cy;
        if (!(u >= 0 && v >= 0 && u < width && v < height)) continue;
        const VoxelInView seen = sampler.At(ray, u, v, z);
        if (seen.weight <= 0 || seen.distance < -truncation_) continue;
        const auto at = static_cast<size_t>(b * kBlockVoxels + i);
        const float distance = std::min(1.f, seen.distance / truncation_), old = weights_[at];
        distances_[at] = (distances_[at] * old + distance * seen.weight) / (old + seen.weight);
        weights_[at] = old + seen.weight;
      }
    }
  });
}

}  // namespace oraclegs
