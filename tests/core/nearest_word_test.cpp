#include "oraclegs/core/nearest_word.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

const std::vector<std::string> kOptions = {"iterations", "views", "view", "out", "quality", "max-gaussians"};

TEST(NearestWord, FindsSlips) {
  EXPECT_EQ(NearestWord("iteration", kOptions), "iterations");
  EXPECT_EQ(NearestWord("iterationz", kOptions), "iterations");
  EXPECT_EQ(NearestWord("itreations", kOptions), "iterations");
  EXPECT_EQ(NearestWord("veiws", kOptions), "views");
  EXPECT_EQ(NearestWord("max-gausians", kOptions), "max-gaussians");
  EXPECT_EQ(NearestWord("QUALITY", kOptions), "quality");
}

TEST(NearestWord, FindsBeginnings) {
  EXPECT_EQ(NearestWord("iter", kOptions), "iterations");
  EXPECT_EQ(NearestWord("max", kOptions), "max-gaussians");
}

TEST(NearestWord, FindsNothingFarAway) {
  EXPECT_EQ(NearestWord("frobnicate", kOptions), "");
  EXPECT_EQ(NearestWord("", kOptions), "");
  EXPECT_EQ(NearestWord("it", kOptions), "");
  EXPECT_EQ(NearestWord("x", {"y"}), "");
  EXPECT_EQ(NearestWord(std::string(100000, 'x'), kOptions), "");
  EXPECT_EQ(NearestWord("views", {}), "");
}

TEST(NearestWord, TakesTheNearest) {
  EXPECT_EQ(NearestWord("view", kOptions), "view");
  EXPECT_EQ(NearestWord("viewz", kOptions), "views") << "the first of those as near";
}

TEST(DidYouMean, EndsAMessage) {
  EXPECT_EQ(DidYouMean("whit", {"black", "white"}), "; did you mean 'white'?");
  EXPECT_EQ(DidYouMean("pink", {"black", "white"}), "");
}

}  // namespace
}  // namespace oraclegs
