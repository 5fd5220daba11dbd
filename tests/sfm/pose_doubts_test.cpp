#include "oraclegs/sfm/pose_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

MotionCounts Usual() {
  MotionCounts counts;
  counts.moving = counts.inliers = 300;
  return counts;
}

MotionCounts WithStill(int still) {
  MotionCounts counts = Usual();
  counts.still = still;
  return counts;
}

std::vector<PairMotions> Pairs(const std::vector<MotionCounts>& counts) {
  std::vector<PairMotions> pairs;
  for (size_t i = 0; i < counts.size(); ++i) {
    pairs.push_back({std::to_string(i) + ".jpg", std::to_string(i + 1) + ".jpg", counts[i]});
  }
  return pairs;
}

TEST(PoseDoubts, IsSilentWhereNothingSpeaksAgainstThem) {
  EXPECT_THAT(PoseDoubts(Pairs({Usual(), Usual()}), {{{"a.jpg"}, 1000, 1090}, {{"b.jpg"}, 500, 0}}), IsEmpty());
  EXPECT_THAT(PoseDoubts({}, {}), IsEmpty());
}

TEST(PoseDoubts, ComparesFocalLengthsWithExif) {
  EXPECT_THAT(PoseDoubts({}, {{{"a.jpg", "b.jpg"}, 238, 480}}),
              ElementsAre(AllOf(StartsWith(kPosesDoubtful), HasSubstr("a.jpg, b.jpg"),
                                HasSubstr("238 pixels, 2.0 times shorter than the 480"), HasSubstr("mask"))));
  EXPECT_THAT(PoseDoubts({}, {{{"a.jpg"}, 960, 480}}), ElementsAre(HasSubstr("2.0 times longer")));
}

TEST(PoseDoubts, NamesWhatStandsStill) {
  EXPECT_THAT(PoseDoubts(Pairs({Usual(), WithStill(40), WithStill(70), Usual()}), {}),
              ElementsAre(AllOf(StartsWith(kPosesDoubtful), HasSubstr("stands still"),
                                HasSubstr("2 of 4 pairs; 70 points in 2.jpg and 3.jpg"), HasSubstr("turntable"))));
  EXPECT_THAT(PoseDoubts(Pairs({Usual(), Usual(), Usual(), WithStill(40)}), {}), IsEmpty()) << "one pair is chance";
}

TEST(PoseDoubts, NamesWhatMoved) {
  MotionCounts moved = Usual();
  moved.apart = 60;
  EXPECT_THAT(PoseDoubts(Pairs({moved, moved, Usual()}), {}), ElementsAre(HasSubstr("moved on its own")));
}

TEST(PoseDoubts, NamesAPlaneWhereTheFocalLengthIsNotKnown) {
  MotionCounts plane = Usual();
  plane.planar = plane.inliers;
  EXPECT_THAT(PoseDoubts(Pairs({plane, plane}), {{{"a.jpg"}, 900, 0}}), ElementsAre(HasSubstr("one plane")));
  EXPECT_THAT(PoseDoubts(Pairs({plane, plane}), {{{"a.jpg"}, 900, 910}}), IsEmpty());
  EXPECT_THAT(PoseDoubts(Pairs({plane, Usual()}), {{{"a.jpg"}, 900, 0}}), IsEmpty());
}

}  // namespace
}  // namespace oraclegs
