#include "oraclegs/depth/refine_poses.h"

#include <algorithm>
#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/depth/patch_adjustment.h"
#include "oraclegs/depth/pose_offsets.h"

namespace oraclegs {
namespace {

constexpr size_t kMinCells = 8;   // below, a residual says nothing
constexpr double kOfOneView = 2;  // a view's residual is of fewer cells, and noisier

}  // namespace

bool PassesGate(double all, const std::vector<double>& views, double gate) {
  // A wrong camera among many hardly shows in the median of all.
  return all < gate && std::all_of(views.begin(), views.end(), [&](double view) { return view < kOfOneView * gate; });
}

double LeftShare(const std::vector<RefinedView>& views) {
  PoseResidual sum;
  for (const RefinedView& view : views) {
    if (view.residual.before == 0 || view.residual.after == 0) continue;
    sum.before += view.residual.before;
    sum.after += view.residual.after;
  }
  return sum.before > 0 ? sum.after / sum.before : 1;
}

bool IsBelieved(const std::vector<CameraMovement>& movements) {
  return std::all_of(movements.begin(), movements.end(), [](const CameraMovement& movement) {
    return movement.degrees <= kMaxPoseDegrees && movement.share <= kMaxPoseShare;
  });
}

PoseRefinement RefinePoses(const std::vector<LoadedView>& views, const std::vector<DepthMap>& maps,
                           const PoseRefinementOptions& options) {
  PoseRefinement refinement;
  AdjustedScene scene;
  for (const LoadedView& view : views) {
    scene.cameras.push_back(view.camera);
    refinement.views.push_back({view.name, {}, {}});
  }
  const std::vector<Camera> given = refinement.cameras = scene.cameras;
  if (views.size() < 2) return refinement;

  const OffsetMeter meter(views, maps);
  scene.pixels = meter.Choose(options.pixels_per_view);
  std::vector<PatchOffset> offsets = meter.Measure(scene.cameras, scene.pixels);
  refinement.offsets = offsets.size();
  const AcrossResidual before = ResidualAcross(scene.pixels, offsets, scene.cameras);
  if (before.cells < kMinCells) return refinement;
  refinement.residual = {before.all, before.all};
  for (size_t v = 0; v < views.size(); ++v) refinement.views[v].residual = {before.views[v], before.views[v]};
  if (PassesGate(before.all, before.views, options.gate)) {
    refinement.result = PoseRefinementResult::kKept;
    return refinement;
  }

  for (int round = 0; round < options.rounds; ++round) {
    ThrowIfInterrupted();
    AdjustScene(offsets, given, &scene);
    offsets = meter.Measure(scene.cameras, scene.pixels);
  }
  const AcrossResidual after = ResidualAcross(scene.pixels, offsets, scene.cameras);
  const std::vector<CameraMovement> movements = Movements(given, scene.cameras);
  std::vector<RefinedView> refined = refinement.views;
  for (size_t v = 0; v < views.size(); ++v) {
    refined[v].residual.after = after.views[v];
    refined[v].movement = movements[v];
  }
  const bool is_good = after.cells >= kMinCells && LeftShare(refined) < options.enough && IsBelieved(movements);
  if (!is_good && PassesGate(before.all, before.views, PoseRefinementOptions().gate)) {
    refinement.result = PoseRefinementResult::kKept;
    return refinement;
  }
  refinement.residual.after = after.all;
  refinement.views = std::move(refined);
  if (!is_good) {
    refinement.result = PoseRefinementResult::kUndone;
    return refinement;
  }
  refinement.result = PoseRefinementResult::kRefined;
  refinement.cameras = std::move(scene.cameras);
  return refinement;
}

}  // namespace oraclegs
