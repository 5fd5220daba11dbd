#include "oraclegs/propose/trajectory.h"

#include <set>
#include <stdexcept>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/propose/target_check.h"
#include "propose/rigs.h"
#include "scene/tiny_scenes.h"
#include "support/event_recorder.h"

namespace oraclegs {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<std::string> kGenerated = {"orbit", "spiral", "interpolate", "coverage"};

class TrajectoryTest : public ::testing::Test {
 protected:
  TrajectoryTest() : points_(SpherePoints(3000, 1)) {
    request_.train = RigAround(12);
    request_.points = &points_;
  }
  std::vector<Target> Choose(const std::string& trajectory, int proposals = 16) {
    const bool is_auto = trajectory == "auto";
    const TargetPlan plan{proposals, is_auto ? Trajectory::kDataset : *FromWord<Trajectory>(trajectory), is_auto};
    return ChooseTargets(request_, plan, events_.AsListener());
  }
  void AddSpare(int count) {
    for (int i = 0; i < count; ++i) {
      const double a = 0.3 + 0.4 * i;
      request_.spare.push_back(
          {"images/" + std::to_string(i) + ".jpg", RigCamera({4 * std::cos(a), 4 * std::sin(a), 0.5}, {0, 0, 0})});
    }
  }

  std::vector<DensePoint> points_;
  TrajectoryRequest request_;
  EventRecorder events_;
};

std::vector<std::string> Names(const std::vector<Target>& targets) {
  std::vector<std::string> names;
  for (const Target& target : targets) names.push_back(target.name);
  return names;
}

TEST_F(TrajectoryTest, GivesRequestedCountWithUniqueNames) {
  for (const std::string& trajectory : kGenerated) {
    const auto targets = Choose(trajectory);
    EXPECT_EQ(targets.size(), 16u) << trajectory;
    const std::vector<std::string> names = Names(targets);
    EXPECT_EQ(names.at(3), trajectory + "_0003");
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
    for (const Target& target : targets) {
      EXPECT_NO_THROW(target.camera.Check(target.name));
      EXPECT_EQ(target.camera.width, 64);
    }
    ASSERT_FALSE(events_.notes.empty());
    EXPECT_THAT(events_.notes.back(), HasSubstr("16 poses for proposals chosen by trajectory '" + trajectory + "'"));
  }
  EXPECT_THAT(events_.warnings, IsEmpty());
}

TEST_F(TrajectoryTest, DependsOnSeedOnly) {
  for (const bool with_points : {true, false}) {
    request_.points = with_points ? &points_ : nullptr;
    for (const std::string& trajectory : kGenerated) {
      SetNumThreads(1);
      const auto once = Choose(trajectory);
      SetNumThreads(3);
      const auto again = Choose(trajectory);
      SetNumThreads(0);
      ASSERT_EQ(once.size(), again.size());
      ASSERT_EQ(once.size(), 16u);
      for (size_t i = 0; i < once.size(); ++i) {
        EXPECT_EQ(once[i].camera.cam_from_world.matrix(), again[i].camera.cam_from_world.matrix()) << trajectory;
      }
    }
  }
}

TEST_F(TrajectoryTest, NeverChoosesTestPose) {
  AddSpare(8);
  std::vector<std::string> all = kGenerated;
  all.insert(all.end(), {"dataset", "auto"});
  for (const std::string& trajectory : all) {
    request_.test.clear();
    const auto wanted = Choose(trajectory, 6);
    ASSERT_FALSE(wanted.empty()) << trajectory;
    for (const Target& target : wanted) request_.test.push_back(target.camera);  // where it would go is forbidden
    const PoseSet forbidden(request_.test, SamePlace(request_.train));
    for (const int proposals : {6, 7, 64}) {
      for (const Target& target : Choose(trajectory, proposals)) {
        EXPECT_FALSE(forbidden.Has(target.camera)) << trajectory << " " << target.name;
      }
    }
  }
}

TEST_F(TrajectoryTest, NeverChoosesTrainingPoseOrDuplicate) {
  request_.spare = {{"a.png", request_.train[0]},
                    {"b.png", RigCamera({0, 3, 1}, {0, 0, 0})},
                    {"c.png", RigCamera({0, 3, 1}, {0, 0, 0})}};
  EXPECT_THAT(Names(Choose("dataset")), ElementsAre("b"));
  ASSERT_EQ(events_.warnings.size(), 1u);
  EXPECT_THAT(events_.warnings[0],
              AllOf(HasSubstr("more than half of the poses of trajectory 'dataset' cannot be used"),
                    HasSubstr("2 at a training pose or at one chosen already")));
}

TEST_F(TrajectoryTest, DatasetPicksEvenly) {
  AddSpare(10);
  EXPECT_THAT(Names(Choose("dataset", 4)), ElementsAre("images_0", "images_3", "images_6", "images_9"));
  EXPECT_EQ(Choose("dataset", 32).size(), 10u);
  EXPECT_EQ(Choose("dataset", 1).size(), 1u);
  request_.spare.resize(2);
  request_.spare[0].name = "a/b.jpg", request_.spare[1].name = "a_b.png";
  EXPECT_THAT(Names(Choose("dataset")), ElementsAre("a_b", "a_b_2"));
}

TEST_F(TrajectoryTest, AutoUsesDatasetFromFourPoses) {
  AddSpare(4);
  EXPECT_EQ(Choose("auto").at(0).name, "images_0");
  request_.test = {request_.spare[0].camera};  // one of them is not usable
  EXPECT_EQ(Choose("auto").at(0).name, "coverage_0000");
}

TEST_F(TrajectoryTest, AvoidsGeometry) {
  points_ = SpherePoints(20000, 1);
  const auto pillar = SpherePoints(2000, 0.5);  // in the way of the orbit
  const Eigen::Vector3f place = OrbitPath(request_.train, 4)[1].Center().cast<float>();
  for (DensePoint p : pillar) {
    p.xyz += place;
    points_.push_back(p);
  }
  const auto targets = Choose("orbit", 60);
  EXPECT_LT(targets.size(), 60u);
  EXPECT_GT(targets.size(), 30u);
  for (const Target& target : targets) EXPECT_GT((target.camera.Center().cast<float>() - place).norm(), 0.6f);
  EXPECT_THAT(events_.notes.back(), HasSubstr("inside geometry"));
}

TEST_F(TrajectoryTest, WarnsOfRejectedPoses) {
  for (DensePoint& p : points_) p.xyz += Eigen::Vector3f(0, 0, 500);  // nobody looks there, but for one view
  request_.spare = {{"a.png", RigCamera({0, 0, 490}, {0, 0, 500})},
                    {"b.png", RigCamera({0, 0, 490}, {0, 0, 0})},
                    {"c.png", RigCamera({0, 1, 490}, {0, 0, 0})}};
  request_.train.assign(1, RigCamera({3, 0, 490}, {0, 0, 500}));
  EXPECT_THAT(Names(Choose("dataset")), ElementsAre("a"));
  ASSERT_EQ(events_.warnings.size(), 1u);
  EXPECT_THAT(events_.warnings[0], AllOf(HasSubstr("of 3 candidates 2 rejected"), HasSubstr("next to nothing")));
  request_.spare.erase(request_.spare.begin());
  EXPECT_THAT(Choose("dataset"), IsEmpty());
  ASSERT_EQ(events_.warnings.size(), 2u);
  EXPECT_THAT(events_.warnings[1], AllOf(HasSubstr("no usable pose for proposals on trajectory 'dataset'"),
                                         HasSubstr("another --trajectory"), HasSubstr("--proposals 0")));
  request_.spare.clear();
  EXPECT_THAT(Choose("dataset"), IsEmpty());
  EXPECT_THAT(events_.warnings.at(2), HasSubstr("0 candidates"));
}

TEST_F(TrajectoryTest, AcceptsFewCameras) {
  for (const int n : {2, 3}) {
    for (const auto& train : {RigAround(n, 60), RigForward(n)}) {
      request_.train = train;
      request_.points = nullptr;
      for (const std::string& trajectory : kGenerated) {
        const auto targets = Choose(trajectory, 8);
        EXPECT_EQ(targets.size(), 8u) << trajectory << " of " << n;
        for (const Target& target : targets) EXPECT_NO_THROW(target.camera.Check(target.name));
      }
    }
  }
  request_.train.resize(1);
  for (const std::string& trajectory : kGenerated) EXPECT_THAT(Choose(trajectory, 8), IsEmpty()) << trajectory;
}

TEST_F(TrajectoryTest, GivesNoneForZeroProposals) {
  EXPECT_THAT(Choose("orbit", 0), IsEmpty());
  EXPECT_THAT(events_.warnings, IsEmpty());
  EXPECT_THAT(events_.notes, IsEmpty());
}

TEST_F(TrajectoryTest, NeedsTrainingCameras) {
  request_.train.clear();
  EXPECT_THROW(Choose("orbit"), std::invalid_argument);
}

}  // namespace
}  // namespace oraclegs
