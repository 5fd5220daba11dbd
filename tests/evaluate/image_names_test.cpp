#include "oraclegs/evaluate/image_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace oraclegs {
namespace {

using testing::ElementsAre;

TEST(ImageNames, ArePlainWhenNothingCollides) {
  EXPECT_THAT(ImageNames({"0001.jpg", "left/0001.jpg", "a.b.png", "x_gt.png"}),
              ElementsAre("0001", "left_0001", "a.b", "x_gt"));
  EXPECT_TRUE(ImageNames({}).empty());
}

TEST(ImageNames, KeepTheExtensionWhereTheyWouldCollide) {
  EXPECT_THAT(ImageNames({"1.jpg", "1.png", "2.jpg"}), ElementsAre("1_jpg", "1_png", "2"));
}

TEST(ImageNames, AreNumberedWhereThatIsNotEnough) {
  EXPECT_THAT(ImageNames({"a/1.jpg", "a_1.jpg"}), ElementsAre("a_1_jpg", "a_1_jpg_2"));
  EXPECT_THAT(ImageNames({"1", "1.jpg", "1_jpg.png"}), ElementsAre("1", "1_jpg_2", "1_jpg"));
}

TEST(ImageNames, LeaveRoomForTheTruthOfOthers) {
  EXPECT_THAT(ImageNames({"x.png", "x_gt.png"}), ElementsAre("x_png", "x_gt_png"));
}

TEST(ImageNames, NoTwoFilesOfASetAreTheSame) {
  const std::vector<std::string> views = {"x",    "x_gt",    "x_gt_gt", "x.gt",   "x_gt.gt",
                                          "x/gt", "x/gt.gt", "x_gt_2",  "x.gt_gt"};
  std::set<std::string> files;
  for (const std::string& name : ImageNames(views)) files.insert({name, name + "_gt"});
  EXPECT_EQ(files.size(), 2 * views.size());
}

}  // namespace
}  // namespace oraclegs
