#include "oraclegs/networks/seva/plan.h"
#include "networks/seva/sampling_fixture.h"
#include "oraclegs/camera/camera_path.h"

#include "networks/seva/chunks_fixture.h"

namespace oraclegs::seva {
namespace {

TEST(SevaPlan, PassSizesMatchTheOfficialOnes) {
  constexpr int64_t kFirstInterpolating = 2;  // strategies of the fixture from here on need a path, which we have not
  const SafetensorsFile file = SamplingFixture();
  const std::vector<int64_t> rows = file.Values<int64_t>("prior_stats.rows");
  const auto columns = static_cast<size_t>(file.Get("prior_stats.rows").shape.at(1));
  for (size_t r = 0; r < rows.size(); r += columns) {
    if (rows[r + 4] >= kFirstInterpolating) continue;
    const PassSizes sizes = SizePasses(rows[r + 2], rows[r]);
    EXPECT_EQ(sizes.anchors, rows[r + 6]) << r / columns;
    EXPECT_EQ(sizes.first_frames, rows[r + 7]) << r / columns;
  }
}

/// Cameras on an arc that look at the origin.
std::vector<View> Arc(int count, double first_angle) {
  std::vector<View> views(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    const Eigen::AngleAxisd turn(first_angle + 0.3 * i, Eigen::Vector3d::UnitY());
    View& view = views[static_cast<size_t>(i)];
    view.world_from_camera.linear() = turn.toRotationMatrix();
    view.world_from_camera.translation() = turn * Eigen::Vector3d(0, 0, -3);
  }
  return views;
}

/// Expects that a frame is an input only after it was made, every target is made once, and all jobs have the same
/// number of frames.
void ExpectSound(const Plan& plan, size_t targets) {
  std::vector<int> anchors(plan.anchors.size()), made(targets);
  const auto count_of = [&](const Frame& frame) -> int& {
    auto& list = frame.source == FrameSource::kAnchor ? anchors : made;
    return list.at(static_cast<size_t>(frame.index));
  };
  for (const Job& job : plan.jobs) {
    EXPECT_TRUE(std::any_of(job.frames.begin(), job.frames.end(), [](const Frame& f) { return f.given; }));
    for (const Frame& frame : job.frames) {
      const bool input = frame.source == FrameSource::kInput;
      EXPECT_TRUE(frame.given || !input);
      if (frame.given && !input) {
        EXPECT_EQ(count_of(frame), 1);
      }
    }
    for (const Frame& frame : job.frames) {
      if (!frame.given && !frame.copy) ++count_of(frame);
    }
  }
  EXPECT_EQ(made, std::vector<int>(targets, 1));
  EXPECT_EQ(anchors, std::vector<int>(anchors.size(), 1));
}

TEST(SevaPlan, MakesEveryTargetOnce) {
  for (const int inputs : {1, 3, 10}) {
    SevaOptions options;
    options.frames = 21;
    const Plan plan = MakePlan(Arc(inputs, 0.1), Arc(30, 0.17), options);
    SCOPED_TRACE(inputs);
    ExpectSound(plan, 30);
    EXPECT_EQ(plan.anchors.size(), static_cast<size_t>(21 - inputs));
  }
}

TEST(SevaPlan, NoTargetsMeanNoWork) { EXPECT_TRUE(MakePlan(Arc(3, 0), {}, {}).jobs.empty()); }

TEST(SevaPlan, SaysWhichOptionsDoNotFit) {
  EXPECT_THROW(MakePlan({}, Arc(5, 0), {}), ShapeError);
  SevaOptions options;
  options.steps = 0;
  EXPECT_THROW(MakePlan(Arc(3, 0), Arc(5, 0), options), UsageError);
}

TEST(SevaOrbit, MatchesTheOfficialOne) {
  const SafetensorsFile file = SamplingFixture();
  const std::vector<View> all = GoldenViews(file, "traj.all_c2w"), orbit = GoldenViews(file, "traj.orbit_c2w");
  std::vector<View> inputs;
  for (const int64_t i : file.Values<int64_t>("traj.train_ids")) inputs.push_back(all.at(static_cast<size_t>(i)));
  const std::vector<double> center = file.Values<double>("traj.lookat"), up = file.Values<double>("traj.up");
  const Eigen::Vector3d our_center = LookAtPoint(all), our_up = UpOf(inputs);
  EXPECT_LE((our_center - Eigen::Map<const Eigen::Vector3d>(center.data())).norm(), 1e-4 * our_center.norm());
  EXPECT_LE((our_up - Eigen::Map<const Eigen::Vector3d>(up.data())).norm(), 1e-4);
  const std::vector<Eigen::Isometry3d> poses =
      Orbit(inputs.front().center(), our_center, our_up, static_cast<int64_t>(orbit.size()));
  for (size_t i = 0; i < orbit.size(); ++i) {
    const Eigen::Matrix4d expected = orbit[i].world_from_camera.matrix();
    EXPECT_LE((poses[i].matrix() - expected).cwiseAbs().maxCoeff(), 1e-4 * expected.cwiseAbs().maxCoeff()) << i;
  }
}

TEST(SevaOrbit, AnchorsLeaveOutTheImage) {
  View input, target;
  input.world_from_camera = LookAt({3, 0, 0}, {0, 0, 0}, {0, 0, 1}).inverse();
  target.world_from_camera = LookAt({0, 3, 0}, {0, 0, 0}, {0, 0, 1}).inverse();
  target.intrinsics(0, 0) = 7;
  const std::vector<View> anchors = OrbitAnchors({input}, {target}, 5);
  ASSERT_EQ(anchors.size(), 5u);
  for (const View& anchor : anchors) {
    EXPECT_NEAR(anchor.center().norm(), 3, 1e-9);
    EXPECT_GE((anchor.center() - input.center()).norm(), 1);
    EXPECT_EQ(anchor.intrinsics, target.intrinsics);
    EXPECT_NEAR(anchor.world_from_camera.linear().determinant(), 1, 1e-9);
  }
}

TEST(SevaOrbit, ParallelAxesMeetBesideTheirMean) {
  std::vector<View> views(2);
  views[1].world_from_camera.translation().x() = 2;
  EXPECT_LE((LookAtPoint(views) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-9);
  EXPECT_THROW(LookAtPoint({}), ShapeError);
  EXPECT_THROW(OrbitAnchors({}, {}, 3), ShapeError);
}

}  // namespace

}  // namespace oraclegs::seva
