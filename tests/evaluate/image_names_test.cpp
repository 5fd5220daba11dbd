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

TEST(ImageNames, TakeNoLongerWhenManyAreEqual) {
  std::vector<std::string> views;  // of 16 letters, each of which is / or _: all want one name
  for (int i = 0; i < 1 << 16; ++i) {
    std::string view = "v";
    for (int bit = 0; bit < 16; ++bit) view += (i >> bit & 1) != 0 ? "_" : "/";
    views.push_back(view + "x");
  }
  const std::vector<std::string> names = ImageNames(views);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), views.size());
}

}  // namespace
}  // namespace oraclegs
