#include "oraclegs/validate/consistency.h"

#include <gtest/gtest.h>

#include <map>

#include "depth/surfaces.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

/// Photographs of a textured plane. The hidden ones are proposed right, but for a square of noise in each.
class ConsistencyTest : public testing::Test {
 protected:
  ConsistencyTest() : photos(TakeAll(plane, Arc(6, 8))) {
    for (const LoadedView& photo : photos) maps.push_back(TrueDepth(photo, plane, 0.9f));
    for (int v = 0; v < 6; ++v) hidden.push_back({v, Spoilt(photos[static_cast<size_t>(v)], 10 + 9 * v)});
  }

  static bool InSquare(size_t pixel, int left) {
    const int x = static_cast<int>(pixel % 96), y = static_cast<int>(pixel / 96);
    return x >= left && x < left + 30 && y >= 20 && y < 50;
  }

  static Proposal Spoilt(const LoadedView& photo, int left) {
    Proposal p{photo.name, "test", photo.camera, photo.rgb};
    Rng rng(static_cast<uint64_t>(left), RandomStream::kDemoScene);
    for (size_t i = 0; i < 96 * 72; ++i) {
      for (size_t c = 3 * i; InSquare(i, left) && c < 3 * i + 3; ++c) p.rgb.data[c] = static_cast<float>(rng.Uniform());
    }
    return p;
  }

  TexturedPlane plane;
  std::vector<LoadedView> photos;
  std::vector<DepthMap> maps;
  std::vector<HiddenPhotograph> hidden;
};

TEST_F(ConsistencyTest, TrustsWhatPhotographsShowAndDoubtsWhatIsInvented) {
  const Warper warper({photos, maps});
  ConsistencyOracle oracle(warper, photos);
  oracle.Learn(hidden);
  const LoadedView truth = plane.Take(CameraAt({0.5, 0.1, -4}, {0, 0, 0}, 96, 72), "new");
  const ConfidenceMap map = oracle.Validate({Spoilt(truth, 40)})[0];
  ASSERT_EQ(map.size(), 96u * 72u);
  double inside = 0, outside = 0;
  for (size_t i = 0; i < map.size(); ++i) {
    EXPECT_GE(map[i], 0.f);
    EXPECT_LE(map[i], 1.f);
    (InSquare(i, 40) ? inside : outside) += map[i];
  }
  EXPECT_LT(inside / 900, 0.25);
  EXPECT_GT(outside / (96 * 72 - 900), 0.8);
}

TEST_F(ConsistencyTest, CalibrationMovesTheLevelAndKeepsTheOrder) {
  const Warper warper({photos, maps});
  ConsistencyOracle calibrated(warper, photos), as_it_comes(warper, photos);
  as_it_comes.LeaveLevel();
  calibrated.Learn(hidden);
  as_it_comes.Learn(hidden);
  const ConfidenceMap level = calibrated.Validate({hidden[2].proposal})[0];
  const ConfidenceMap order = as_it_comes.Validate({hidden[2].proposal})[0];
  EXPECT_NE(level, order);
  constexpr float kRounding = 1e-5f;  // near 1 both maps are flat
  for (size_t i = 1; i < order.size(); ++i) {
    if (order[i - 1] < order[i]) {
      EXPECT_LE(level[i - 1], level[i] + kRounding);
    } else {
      EXPECT_GE(level[i - 1] + kRounding, level[i]);
    }
  }
}

TEST_F(ConsistencyTest, AProposalsMapDoesNotDependOnTheOthers) {
  const Warper warper({photos, maps});
  ConsistencyOracle oracle(warper, photos);
  oracle.Learn(hidden);
  const Proposal a = Spoilt(photos[1], 12), b = Spoilt(photos[4], 50);
  const auto together = oracle.Validate({a, b});
  EXPECT_EQ(together[0], oracle.Validate({a})[0]);
  EXPECT_EQ(together[1], oracle.Validate({b})[0]);
}

TEST_F(ConsistencyTest, JudgesAnUnknownProposerAsTheOthersTogether) {
  const Warper warper({photos, maps});
  ConsistencyOracle oracle(warper, photos);
  oracle.Learn(hidden);
  Proposal known = Spoilt(photos[2], 30), unknown = known;
  unknown.source = "folder";
  EXPECT_EQ(oracle.Validate({known})[0], oracle.Validate({unknown})[0]);
}

TEST_F(ConsistencyTest, LearnsAnotherSourceWithoutForgettingTheFirst) {
  const Warper warper({photos, maps});
  ConsistencyOracle oracle(warper, photos);
  oracle.Learn(hidden);
  const ConfidenceMap before = oracle.Validate({hidden[0].proposal})[0];
  std::vector<HiddenPhotograph> right;
  for (int v = 0; v < 6; ++v) right.push_back({v, {"right", "right", photos[v].camera, photos[v].rgb}});
  oracle.Learn(right);
  EXPECT_EQ(oracle.Validate({hidden[0].proposal})[0], before);
  const ConfidenceMap sure = oracle.Validate({right[3].proposal})[0];
  EXPECT_GT(*std::min_element(sure.begin(), sure.end()), 0.95f);  // this source was never wrong
}

TEST_F(ConsistencyTest, NeedsSomethingToLearnFrom) {
  const Warper warper({photos, maps});
  ConsistencyOracle oracle(warper, photos);
  EXPECT_THROW(oracle.Learn({}), InputError);
  EXPECT_THROW(oracle.Validate({hidden[0].proposal}), UsageError);
}

/// Knows where the noise is, or does not: says 0.1 in the square of noise of each proposal, 0.9 elsewhere.
class Seer : public Oracle {
 public:
  explicit Seer(std::map<std::string, int> lefts) : lefts_(std::move(lefts)) {}
  std::string name() const override { return "seer"; }
  std::vector<ConfidenceMap> Judge(const std::vector<HiddenPhotograph>& hidden) const override {
    asked += hidden.size();
    std::vector<ConfidenceMap> maps;
    for (const HiddenPhotograph& h : hidden) {
      maps.emplace_back(size_t{96} * 72, 0.9f);
      const int left = lefts_.at(h.proposal.name);
      for (int y = 20; y < 50; ++y) {
        for (int x = left; x < left + 30; ++x) maps.back()[static_cast<size_t>(y) * 96 + x] = 0.1f;
      }
    }
    return maps;
  }
  mutable size_t asked = 0;

 private:
  std::map<std::string, int> lefts_;
};

TEST_F(ConsistencyTest, ASecondOracleIsCalibratedAlone) {
  std::map<std::string, int> lefts = {{"new", 40}};
  for (const HiddenPhotograph& h : hidden) lefts[h.proposal.name] = 10 + 9 * h.photograph;
  const Seer seer(lefts);
  const Warper warper({photos, maps});
  ConsistencyOracle oracle(warper, photos, seer, Evidence::kSecond);
  EXPECT_EQ(oracle.name(), "seer");
  oracle.Learn(hidden);
  const ConfidenceMap map = oracle.Validate({{"new", "test", photos[0].camera, photos[0].rgb}})[0];
  ASSERT_EQ(map.size(), 96u * 72u);
  for (size_t i = 0; i < map.size(); ++i) {
    // Two values in, two values out: what pixels of each turned out to be worth.
    if (InSquare(i, 40)) {
      EXPECT_LT(map[i], 0.2f);
    } else {
      EXPECT_GT(map[i], 0.9f);
    }
  }
}

TEST_F(ConsistencyTest, ASecondOracleTellsWhatThePhotographsDoNot) {
  // Each photograph shows something in its square that no other one shows, and no proposal has.
  std::map<std::string, int> lefts = {{"new", 40}};
  std::vector<LoadedView> surprising = photos;
  std::vector<HiddenPhotograph> blind;
  for (int v = 0; v < 6; ++v) {
    const LoadedView& photo = photos[static_cast<size_t>(v)];
    lefts[photo.name] = 10 + 9 * v;
    surprising[static_cast<size_t>(v)].rgb = hidden[static_cast<size_t>(v)].proposal.rgb;
    blind.push_back({v, {photo.name, "test", photo.camera, photo.rgb}});
  }
  const Seer seer(lefts);
  const Warper warper({photos, maps});
  ConsistencyOracle alone(warper, surprising), both(warper, surprising, seer, Evidence::kBoth);
  EXPECT_EQ(both.name(), "seer+consistency");
  alone.Learn(blind);
  both.Learn(blind);
  const LoadedView truth = plane.Take(CameraAt({0.5, 0.1, -4}, {0, 0, 0}, 96, 72), "new");
  const Proposal proposal{"new", "test", truth.camera, truth.rgb};
  const auto means = [](const ConfidenceMap& map) {
    double inside = 0, outside = 0;
    for (size_t i = 0; i < map.size(); ++i) (InSquare(i, 40) ? inside : outside) += static_cast<double>(map[i]);
    return std::pair{inside / 900, outside / (96 * 72 - 900)};
  };
  const auto [inside, outside] = means(both.Validate({proposal})[0]);
  const double inside_alone = means(alone.Validate({proposal})[0]).first;
  EXPECT_LT(inside, inside_alone - 0.2);
  EXPECT_GT(outside, 0.98) << "but for the square's edge, where doubt spreads";
}

TEST_F(ConsistencyTest, WhatWasLookedAtIsNotAskedAboutAgain) {
  std::map<std::string, int> lefts;
  for (const HiddenPhotograph& h : hidden) lefts[h.proposal.name] = 10 + 9 * h.photograph;
  const Seer seer(lefts);
  const Warper warper({photos, maps});
  ConsistencyOracle oracle(warper, photos, seer, Evidence::kBoth), again(warper, photos, seer, Evidence::kBoth);
  std::vector<HiddenPhotograph> looked = hidden;
  oracle.Look(&looked);
  EXPECT_EQ(seer.asked, 6u);
  oracle.Learn(looked);
  const auto maps_of = oracle.Judge(looked);
  EXPECT_EQ(seer.asked, 6u);
  again.Learn(hidden);
  EXPECT_EQ(again.Judge(hidden), maps_of);
  EXPECT_EQ(seer.asked, 18u);
  ConsistencyOracle(warper, photos).Look(&looked);  // nobody to ask
  EXPECT_EQ(seer.asked, 18u);
}

TEST(Goodness, FallsWithTheError) {
  EXPECT_EQ(Goodness(0), 1.f);
  EXPECT_NEAR(Goodness(0.08f), std::exp(-1.f), 1e-6f);
  EXPECT_LT(Goodness(0.3f), 1e-5f);
}

}  // namespace
}  // namespace oraclegs
