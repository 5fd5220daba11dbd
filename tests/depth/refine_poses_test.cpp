#include "oraclegs/depth/refine_poses.h"

#include <gtest/gtest.h>

#include "depth/disturbed.h"
#include "depth/surfaces.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/demo/demo_kinds.h"
#include "oraclegs/depth/plane_search.h"
#include "oraclegs/depth/stereo.h"

namespace oraclegs {
namespace {

constexpr int kWidth = 208, kHeight = 156;

/// Views of the demo scene from an arc before it.
std::vector<LoadedView> DemoViews(int n) {
  const RayScene world = DemoWorld(DemoKind::kRoom);
  std::vector<LoadedView> views;
  for (int i = 0; i < n; ++i) {
    const double azimuth = 0.2 * (i - (n - 1) / 2.0), height = i % 2 == 0 ? 1.05 : 1.75;
    const Eigen::Vector3d target(0.02, 0.05, 0.6);
    const Eigen::Vector3d eye(target.x() + 2.95 * std::sin(azimuth), target.y() - 2.95 * std::cos(azimuth), height);
    const Eigen::Vector3d forward = (target - eye).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized(), down = forward.cross(right);
    const auto plain = [](const Eigen::Vector3d& v) { return Vec3{v.x(), v.y(), v.z()}; };
    const RayCamera ray_camera{kWidth, kHeight, 0.92 * kWidth, plain(eye), plain(right), plain(down), plain(forward)};
    LoadedView view;
    view.name = fmt::format("{:03}.png", i);
    view.camera.width = kWidth, view.camera.height = kHeight;
    view.camera.fx = view.camera.fy = 0.92 * kWidth;
    view.camera.cx = 0.5 * kWidth, view.camera.cy = 0.5 * kHeight;
    view.camera.cam_from_world.linear() << right.transpose(), down.transpose(), forward.transpose();
    view.camera.cam_from_world.translation() = -(view.camera.cam_from_world.linear() * eye);
    view.rgb = ToFloat(TraceView(world, ray_camera, 2, i).rgb);
    views.push_back(std::move(view));
  }
  return views;
}

std::vector<LoadedView> WithCameras(std::vector<LoadedView> views, const std::vector<Camera>& cameras) {
  for (size_t v = 0; v < views.size(); ++v) views[v].camera = cameras[v];
  return views;
}

std::vector<Camera> CamerasOfAll(const std::vector<LoadedView>& views) {
  std::vector<Camera> cameras;
  for (const LoadedView& view : views) cameras.push_back(view.camera);
  return cameras;
}

std::vector<DepthMap> StereoOf(const std::vector<LoadedView>& views) {
  return EstimateDepth(views, {}, {}, MakePlaneSearch(kCpu).get(), Silent());
}

void ExpectUnchanged(const PoseRefinement& refinement, const std::vector<LoadedView>& views) {
  ASSERT_EQ(refinement.cameras.size(), views.size());
  for (size_t v = 0; v < views.size(); ++v) {
    EXPECT_EQ(refinement.cameras[v].cam_from_world.matrix(), views[v].camera.cam_from_world.matrix());
    EXPECT_EQ(refinement.cameras[v].fx, views[v].camera.fx);
  }
}

TEST(RefinePoses, KeepsTruePoses) {
  const std::vector<LoadedView> views = DemoViews(4);
  const PoseRefinement refinement = RefinePoses(views, StereoOf(views), {});
  EXPECT_EQ(refinement.result, PoseRefinementResult::kKept);
  EXPECT_LT(refinement.residual.before, 0.15);
  for (const RefinedView& view : refinement.views) EXPECT_LT(view.residual.before, 0.2) << view.name;
  EXPECT_EQ(refinement.residual.after, refinement.residual.before);
  EXPECT_GT(refinement.offsets, 3000u);
  ExpectUnchanged(refinement, views);
  for (size_t v = 0; v < views.size(); ++v) {
    EXPECT_EQ(refinement.views[v].name, views[v].name);
    EXPECT_EQ(refinement.views[v].movement.degrees, 0);
  }
}

TEST(RefinePoses, KeepsTruePosesAlsoWithoutAGate) {
  const std::vector<LoadedView> views = DemoViews(4);
  const PoseRefinement refinement = RefinePoses(views, StereoOf(views), {.gate = 0});
  EXPECT_EQ(refinement.result, PoseRefinementResult::kKept) << "others fit hardly better";
  ExpectUnchanged(refinement, views);
}

TEST(RefinePoses, PassTheGateAllTogetherAndEachAtTwiceIt) {
  EXPECT_TRUE(PassesGate(0.2, {0.1, 0.45}, 0.25));
  EXPECT_FALSE(PassesGate(0.3, {0.1, 0.2}, 0.25));
  EXPECT_FALSE(PassesGate(0.1, {0.1, 0.55}, 0.25));
  EXPECT_FALSE(PassesGate(0, {0}, 0));
}

TEST(RefinePoses, LeaveAShareOfTheResidualsThatWereMeasuredTwice) {
  EXPECT_EQ(LeftShare({}), 1);
  const RefinedView half{"a", {1, 0.5}, {}}, unseen{"b", {0, 0.4}, {}}, lost{"c", {0.7, 0}, {}};
  EXPECT_EQ(LeftShare({half, unseen, lost}), 0.5);
  EXPECT_EQ(LeftShare({unseen, lost}), 1);
}

TEST(RefinePoses, FindsTruePosesFromWrongOnes) {
  const std::vector<LoadedView> views = DemoViews(4);
  const std::vector<Camera> truth = CamerasOfAll(views), given = Disturbed(truth, 0.3, 0.01, 0);
  std::vector<Camera> cameras = given;
  std::vector<PoseResidual> residuals;
  for (int round = 0; round < 2; ++round) {
    const std::vector<LoadedView> wrong = WithCameras(views, cameras);
    const PoseRefinement refinement = RefinePoses(wrong, StereoOf(wrong), {});
    residuals.push_back(refinement.residual);
    cameras = refinement.cameras;
    if (refinement.result != PoseRefinementResult::kRefined) break;
  }
  EXPECT_GT(residuals[0].before, 0.2);
  EXPECT_LT(residuals[0].after, residuals[0].before);
  const CameraMovement before = MeanMovement(truth, given), after = MeanMovement(truth, cameras);
  EXPECT_LT(after.degrees, 0.35 * before.degrees);  // to about a tenth of a pixel: the limit of these photos
  EXPECT_LT(after.share, 0.35 * before.share);
}

TEST(RefinePoses, UndoesWhatMovesTooFar) {
  const std::vector<LoadedView> views = TakeAll(kSlanted, Arc(4, 8, 160, 120));
  std::vector<DepthMap> maps;
  std::vector<Camera> given = CamerasOfAll(views);
  given[1] = Stepped(given[1], 0.1 * SpatialExtent(given) * Twist::Unit(1));
  const std::vector<LoadedView> wrong = WithCameras(views, given);
  for (const LoadedView& view : wrong) maps.push_back(TrueDepth(view, kSlanted, 1));
  const PoseRefinement refinement = RefinePoses(wrong, maps, {});
  EXPECT_EQ(refinement.result, PoseRefinementResult::kUndone);
  EXPECT_GT(refinement.views[1].movement.share, kMaxPoseShare);
  ExpectUnchanged(refinement, wrong);
}

TEST(RefinePoses, SaysNothingWithoutOffsets) {
  EXPECT_EQ(RefinePoses({}, {}, {}).result, PoseRefinementResult::kUnknown);
  const Camera camera = Arc(1, 8).front();
  for (const std::vector<Camera>& cameras : {Arc(1, 8), {camera, camera, camera}, Arc(3, 8)}) {
    const std::vector<LoadedView> views = TakeAll(kSlanted, cameras);
    std::vector<DepthMap> maps;
    for (const LoadedView& view : views) maps.push_back(TrueDepth(view, kSlanted, 0.1f));  // nothing is confident
    const PoseRefinement refinement = RefinePoses(views, maps, {});
    EXPECT_EQ(refinement.result, PoseRefinementResult::kUnknown);
    EXPECT_EQ(refinement.offsets, 0u);
    ExpectUnchanged(refinement, views);
  }
}

TEST(RefinePoses, RefinesTwoViews) {
  const std::vector<LoadedView> views = TakeAll(kSlanted, Arc(2, 12, 160, 120));
  const std::vector<LoadedView> wrong = WithCameras(views, Disturbed(CamerasOfAll(views), 0.8, 0, 4));
  std::vector<DepthMap> maps;
  for (const LoadedView& view : wrong) maps.push_back(TrueDepth(view, kSlanted, 1));
  const PoseRefinement refinement = RefinePoses(wrong, maps, {});
  EXPECT_NE(refinement.result, PoseRefinementResult::kUnknown);
  EXPECT_LT(refinement.residual.after, refinement.residual.before);
}

TEST(RefinePoses, HasTheSameBitsForAnyNumberOfThreads) {
  const std::vector<LoadedView> views = TakeAll(kSlanted, Arc(4, 8, 160, 120));
  const std::vector<LoadedView> wrong = WithCameras(views, Disturbed(CamerasOfAll(views), 0.2, 0.005, 5));
  std::vector<DepthMap> maps;
  for (const LoadedView& view : wrong) maps.push_back(TrueDepth(view, kSlanted, 1));
  const int threads_before = NumThreads();
  PoseRefinement results[2];
  for (const int threads : {1, 3}) {
    SetNumThreads(threads);
    results[threads / 2] = RefinePoses(wrong, maps, {.rounds = 1});
  }
  SetNumThreads(threads_before);
  EXPECT_EQ(results[0].residual.after, results[1].residual.after);
  for (size_t v = 0; v < views.size(); ++v) {
    EXPECT_EQ(results[0].cameras[v].cam_from_world.matrix(), results[1].cameras[v].cam_from_world.matrix());
  }
}

}  // namespace
}  // namespace oraclegs
