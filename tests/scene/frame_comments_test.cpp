#include "oraclegs/scene/frame_comments.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(FrameComments, CarryTheUnit) {
  SceneFrame frame;
  EXPECT_TRUE(FrameComments(frame).empty());
  frame.is_level = true, frame.unit_meters = 0.0625;
  std::vector<std::string> comments = FrameComments(frame);
  EXPECT_EQ(comments.size(), 2u);
  EXPECT_EQ(UnitMetersOf(comments), 0.0625);
  comments.push_back("by me");
  const std::string level = comments[0];
  EXPECT_EQ(WithUnit(comments, 1), (std::vector<std::string>{level, "by me", "a unit is 1 m"}));
  EXPECT_EQ(WithUnit(comments, {}), (std::vector<std::string>{level, "by me"}));
  EXPECT_EQ(WithoutLevel(comments), (std::vector<std::string>{"a unit is 0.0625 m", "by me"}));
  for (const char* text : {"a unit is  m", "a unit is long m", "a unit is -1 m", "a unit is 1 mm"}) {
    EXPECT_FALSE(UnitMetersOf({text})) << text;
  }
}

TEST(OffsetOf, ReadsWhatFrameCommentsWrites) {
  SceneFrame frame;
  EXPECT_TRUE(FrameComments(frame).empty());
  frame.offset = {500000.25, -4100000, 1. / 3};
  EXPECT_EQ(OffsetOf(FrameComments(frame)), frame.offset);
  EXPECT_EQ(OffsetOf(WithOffset(FrameComments(frame), {1, 2, 3})), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(WithOffset(FrameComments(frame), Eigen::Vector3d::Zero()).empty());
  for (const char* text :
       {"offset", "offset 1 2", "offset 1 2 3 4", "offset a b c", "offset 1 2 inf", "offsets 1 2 3"}) {
    EXPECT_EQ(OffsetOf({text}), Eigen::Vector3d::Zero()) << text;
  }
}

}  // namespace
}  // namespace oraclegs
