#include "oraclegs/mesh/fuse_model.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/mesh/isosurface.h"
#include "oraclegs/mesh/simplify.h"
#include "oraclegs/mesh/vertex_colors.h"
#include "oraclegs/render/render.h"

namespace oraclegs {
namespace {

constexpr double kTruncationVoxels = 4;    // a surface needs voxels on both sides
constexpr double kTruncationShare = 0.01;  // of depth: what renders of a splat disagree by
constexpr double kMaxTruncationVoxels = 16;
constexpr double kMinFootprintShare = 0.25;  // finer voxels would find no pixel
constexpr int64_t kMaxAutoBlocks = 60'000;   // about two million vertices
constexpr size_t kViewsForScale = 8;
constexpr size_t kRendersForOne = 10;  // a surface that one of so many renders shows may be a torn bit
constexpr int kMaxMinRenders = 6;      // in a large capture a place is seen by few

struct DepthScale {
  double depth = 0;      // median of the pixels, scene units; 0 = nothing is seen
  double footprint = 0;  // median of what a pixel covers there
};

/// Renders views one after the other.
class ViewSource {
 public:
  ViewSource(const Gaussians& gaussians, const RenderOptions& render, std::vector<Camera> cameras, int passes,
             const Listener& listener)
      : gaussians_(gaussians),
        render_(render),
        cameras_(std::move(cameras)),
        passes_(passes),
        listener_(listener),
        rasterizer_(MakeRasterizer(gaussians.device())) {}

  SurfaceView View(size_t i) {
    ThrowIfInterrupted();
    return SurfaceViewOf(rasterizer_->Forward(gaussians_, cameras_[i], render_, RenderPass::kInference), cameras_[i]);
  }
  void ForEach(int pass, const std::function<void(const SurfaceView&)>& body) {
    const auto n = static_cast<int64_t>(cameras_.size());
    for (int64_t i = 0; i < n; ++i) {
      body(View(static_cast<size_t>(i)));
      listener_(StepDone{"mesh", pass * n + i + 1, passes_ * n, "renders", ""});
    }
  }
  size_t count() const { return cameras_.size(); }
  const std::vector<Camera>& cameras() const { return cameras_; }

 private:
  const Gaussians& gaussians_;
  RenderOptions render_;
  std::vector<Camera> cameras_;
  int passes_;
  const Listener& listener_;
  std::unique_ptr<Rasterizer> rasterizer_;
};

DepthScale ScaleOf(ViewSource* source) {
  std::vector<float> depths, footprints;
  const size_t step = std::max<size_t>(1, source->count() / kViewsForScale);
  for (size_t i = 0; i < source->count(); i += step) {
    const SurfaceView view = source->View(i);
    for (size_t p = 0; p < view.weights.size(); ++p) {
      if (view.weights[p] <= 0) continue;
      depths.push_back(1 / view.surface.inv_depth[p]);
      footprints.push_back(depths.back() / static_cast<float>(view.surface.camera.fx));
    }
  }
  if (depths.empty()) return {};
  const auto median = [](std::vector<float>* values) {
    const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
    std::nth_element(values->begin(), middle, values->end());
    return static_cast<double>(*middle);
  };
  return {median(&depths), median(&footprints)};
}

double TruncationOf(const MeshOptions& options, double voxel, double depth) {
  const double automatic =
      std::clamp(kTruncationShare * depth, kTruncationVoxels * voxel, kMaxTruncationVoxels * voxel);
  const double truncation = options.truncation.is_auto() ? automatic : options.truncation.value() / options.unit;
  if (truncation >= voxel && truncation <= 4 * kMaxTruncationVoxels * voxel) return truncation;
  throw UsageError("--trunc is {:.3g}, must be 1 to {:.0f} voxels of {:.3g}; leave it out, or change --voxel",
                   truncation * options.unit, 4 * kMaxTruncationVoxels, voxel * options.unit);
}

TsdfBlocks BlocksAt(ViewSource* source, double voxel, double truncation) {
  TsdfBlocks blocks(voxel, truncation);
  source->ForEach(0, [&](const SurfaceView& view) { blocks.Add(view); });
  return blocks;
}

/// Blocks for the requested voxel size, or for one that gives a mesh of a size that viewers open.
TsdfBlocks DecideBlocks(ViewSource* source, const DepthScale& scale, const MeshOptions& options) {
  double voxel = options.voxel.is_auto() ? scale.footprint : options.voxel.value() / options.unit;
  if (voxel < kMinFootprintShare * scale.footprint) {
    throw UsageError(
        "--voxel is {:.3g}: the renders hold no such detail, a pixel covers {:.3g}; give at least {:.3g}, or work on "
        "larger images (--downscale)",
        voxel * options.unit, scale.footprint * options.unit, kMinFootprintShare * scale.footprint * options.unit);
  }
  TsdfBlocks blocks = BlocksAt(source, voxel, TruncationOf(options, voxel, scale.depth));
  if (options.voxel.is_auto() && blocks.count() > kMaxAutoBlocks) {
    voxel *= std::sqrt(static_cast<double>(blocks.count()) / kMaxAutoBlocks);
    blocks = BlocksAt(source, voxel, TruncationOf(options, voxel, scale.depth));
  }
  RequireRoom(blocks, AvailableMemory());
  return blocks;
}

int TextureSide(const MeshOptions& options) { return options.texture.is_auto() ? 0 : options.texture.value(); }

int MinRenders(const MeshOptions& options, size_t renders) {
  const int automatic = std::clamp(static_cast<int>(renders / kRendersForOne), 1, kMaxMinRenders);
  return options.min_renders.is_auto() ? automatic : options.min_renders.value();
}

/// The part of the surface that so many views show, with their colors.
TriangleMesh Shown(ViewSource* source, double tolerance, TriangleMesh mesh, int min_views) {
  VertexColors colors(mesh, tolerance);
  source->ForEach(2, [&](const SurfaceView& view) { colors.Add(view); });
  mesh.colors = colors.Colors();
  std::vector<std::array<uint32_t, 3>> shown;
  for (const auto& t : mesh.triangles) {
    if (std::min({colors.Views(t[0]), colors.Views(t[1]), colors.Views(t[2])}) >= min_views) shown.push_back(t);
  }
  return PartOf(mesh, shown);
}

void SetTexture(ViewSource* source, double tolerance, int max_side, TriangleMesh* mesh) {
  const TextureAtlas atlas(*mesh, source->cameras(), max_side);
  VertexColors colors(atlas.points(), tolerance);
  source->ForEach(3, [&](const SurfaceView& view) { colors.Add(view); });
  *mesh = atlas.Textured(colors);
}

}  // namespace

void CheckMesh(const MeshOptions& options) {
  CheckOptions(options);
  if (options.triangles > 0 && options.triangles < kMinTriangles) {
    throw UsageError("--triangles is {}, must be 0 (all of them) or at least {}", options.triangles, kMinTriangles);
  }
}

std::vector<Camera> MeshCameras(const std::vector<Camera>& cameras, int count) {
  std::vector<Camera> all = cameras;
  const int between = count - static_cast<int>(cameras.size());
  if (cameras.size() < 2 || between <= 0) return all;
  const std::vector<size_t> order = OrderBesideEachOther(cameras);
  const auto last = static_cast<double>(order.size() - 1);
  for (int i = 0; i < between; ++i) {
    const double s = (i + 0.5) / between * last;
    Camera camera = cameras[order[static_cast<size_t>(s)]];
    camera.cam_from_world = PoseAlong(cameras, order, s);
    all.push_back(camera);
  }
  return all;
}

FusedMesh FuseModel(const Gaussians& gaussians, const RenderOptions& render, const std::vector<Camera>& cameras,
                    const MeshOptions& options, const Listener& listener) {
  CheckMesh(options);
  RequireIsosurface();
  const int passes = TextureSide(options) > 0 ? 4 : 3;
  ViewSource source(gaussians, render, MeshCameras(cameras, options.renders), passes, listener);
  const DepthScale scale = ScaleOf(&source);
  FusedMesh fused;
  if (scale.depth == 0) return fused;
  {  // the volume is gone before colors are gathered
    const TsdfBlocks blocks = DecideBlocks(&source, scale, options);
    fused.voxel = blocks.voxel(), fused.truncation = blocks.truncation();
    TsdfVolume volume(blocks);
    source.ForEach(1, [&](const SurfaceView& view) { volume.Integrate(view); });
    const VoxelField field{volume.voxel(),    &volume.blocks(),   &volume.distances(),
                           &volume.weights(), options.adaptivity, NumThreads()};
    fused.mesh = Isosurface(field);
  }
  SetNormals(&fused.mesh);
  fused.mesh = Shown(&source, fused.truncation, fused.mesh, MinRenders(options, source.count()));
  fused.mesh = Simplified(WithoutSmallParts(fused.mesh, options.min_part), options.triangles);
  SetNormals(&fused.mesh);
  if (const int side = TextureSide(options); side > 0 && !fused.mesh.triangles.empty()) {
    SetTexture(&source, fused.truncation, side, &fused.mesh);
  }
  for (Eigen::Vector3f& position : fused.mesh.positions) position *= static_cast<float>(options.unit);
  fused.voxel *= options.unit, fused.truncation *= options.unit;
  return fused;
}

}  // namespace oraclegs
