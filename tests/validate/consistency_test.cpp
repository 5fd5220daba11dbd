#include "oraclegs/validate/consistency.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "depth/surfaces.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

/// Photos of a textured plane. Proposals of the held-out ones are right, except for a square of noise in each.
class ConsistencyTest : public testing::Test {
 protected:
  ConsistencyTest() : views(TakeAll(plane, Arc(6, 8))) {
    for (const LoadedView& view : views) maps.push_back(TrueDepth(view, plane, 0.9f));
    for (int v = 0; v < 6; ++v) held_out.push_back({Spoilt(views[static_cast<size_t>(v)], 10 + 9 * v), v});
  }

  static bool InSquare(size_t pixel, int left) {
    const int x = static_cast<int>(pixel % 96), y = static_cast<int>(pixel / 96);
    return x >= left && x < left + 30 && y >= 20 && y < 50;
  }

  static Proposal Spoilt(const LoadedView& view, int left) {
    Proposal p{view.name, "test", view.camera, view.rgb};
    Rng rng(static_cast<uint64_t>(left), RandomStream::kDemoScene);
    for (size_t i = 0; i < 96 * 72; ++i) {
      for (size_t c = 3 * i; InSquare(i, left) && c < 3 * i + 3; ++c) p.rgb.data[c] = static_cast<float>(rng.Uniform());
    }
    return p;
  }

  TexturedPlane plane;
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  std::vector<Query> held_out;
};

TEST_F(ConsistencyTest, TrustsWhatTheImagesShowAndNotWhatIsInvented) {
  const Warper warper({views, maps});
  ConsistencyOracle oracle(FeatureSource(warper), views);
  oracle.Calibrate(held_out);
  const LoadedView truth = plane.Take(CameraAt({0.5, 0.1, -4}, {0, 0, 0}, 96, 72), "new");
  const ConfidenceMap map = oracle.Predict(std::vector<Proposal>{Spoilt(truth, 40)})[0];
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

TEST_F(ConsistencyTest, FitsTheLevelAndKeepsTheOrder) {
  const Warper warper({views, maps});
  ConsistencyOracle calibrated(FeatureSource(warper), views), as_is(FeatureSource(warper), views, LevelRule::kAsIs);
  calibrated.Calibrate(held_out);
  as_is.Calibrate(held_out);
  const ConfidenceMap level = calibrated.Predict(std::vector<Proposal>{held_out[2].proposal})[0];
  const ConfidenceMap order = as_is.Predict(std::vector<Proposal>{held_out[2].proposal})[0];
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

TEST_F(ConsistencyTest, PredictsEachProposalByItself) {
  const Warper warper({views, maps});
  ConsistencyOracle oracle(FeatureSource(warper), views);
  oracle.Calibrate(held_out);
  const Proposal a = Spoilt(views[1], 12), b = Spoilt(views[4], 50);
  const auto together = oracle.Predict(std::vector<Proposal>{a, b});
  EXPECT_EQ(together[0], oracle.Predict(std::vector<Proposal>{a})[0]);
  EXPECT_EQ(together[1], oracle.Predict(std::vector<Proposal>{b})[0]);
}

TEST_F(ConsistencyTest, PredictsUnknownProposersByAllTogether) {
  const Warper warper({views, maps});
  ConsistencyOracle oracle(FeatureSource(warper), views);
  oracle.Calibrate(held_out);
  Proposal known = Spoilt(views[2], 30), unknown = known;
  unknown.source = "folder";
  EXPECT_EQ(oracle.Predict(std::vector<Proposal>{known})[0], oracle.Predict(std::vector<Proposal>{unknown})[0]);
}

TEST_F(ConsistencyTest, KeepsTheFirstSourceWhenAnotherIsCalibrated) {
  const Warper warper({views, maps});
  ConsistencyOracle oracle(FeatureSource(warper), views);
  oracle.Calibrate(held_out);
  const ConfidenceMap before = oracle.Predict(std::vector<Proposal>{held_out[0].proposal})[0];
  std::vector<Query> right;
  for (int v = 0; v < 6; ++v) right.push_back({{"right", "right", views[v].camera, views[v].rgb}, v});
  oracle.Calibrate(right);
  EXPECT_EQ(oracle.Predict(std::vector<Proposal>{held_out[0].proposal})[0], before);
  const ConfidenceMap sure = oracle.Predict(std::vector<Proposal>{right[3].proposal})[0];
  EXPECT_GT(*std::min_element(sure.begin(), sure.end()), 0.95f);  // this source was never wrong
}

TEST_F(ConsistencyTest, AnotherExposureIsNoError) {
  const Warper warper({views, maps});
  const ConsistencyOracle oracle(FeatureSource(warper), views);
  Query darker = held_out[0];
  for (float& color : darker.proposal.rgb.data) color *= 0.85f;
  const auto as_it_is = oracle.Sample({held_out[0]}, 96 * 72), scaled = oracle.Sample({darker}, 96 * 72);
  const std::vector<float>&expected = as_it_is[0].second.errors, &errors = scaled[0].second.errors;
  ASSERT_EQ(errors.size(), expected.size());
  for (size_t i = 0; i < errors.size(); ++i) {
    if (expected[i] == 0) {
      ASSERT_LT(errors[i], 0.01f) << i;
    } else if (expected[i] > 0.2f) {
      ASSERT_GT(errors[i], 0.1f) << "what is invented stays an error";
    }
  }
}

TEST_F(ConsistencyTest, LearnsFromSamplesAsFromProposals) {
  const Warper warper({views, maps});
  ConsistencyOracle at_once(FeatureSource(warper), views), in_parts(FeatureSource(warper), views);
  at_once.Calibrate(held_out);
  std::vector<std::pair<std::string, PixelSamples>> samples;
  for (const Query& query : held_out) {
    for (auto& sample : in_parts.Sample({query}, 36000 / held_out.size())) samples.push_back(std::move(sample));
  }
  EXPECT_LT(in_parts.Sample({held_out[0]}, 100)[0].second.errors.size(), 105u);
  in_parts.Fit(samples);
  const std::vector<Proposal> asked = {held_out[2].proposal};
  EXPECT_EQ(in_parts.Predict(asked), at_once.Predict(asked));
}

TEST_F(ConsistencyTest, NeedsHeldOutViews) {
  const Warper warper({views, maps});
  ConsistencyOracle oracle(FeatureSource(warper), views);
  EXPECT_THROW(oracle.Calibrate({}), InputError);
  EXPECT_THROW(oracle.Predict(std::vector<Proposal>{held_out[0].proposal}), UsageError);
}

/// Predicts 0.1 in the square of noise of each proposal and 0.9 elsewhere.
class Seer : public Oracle {
 public:
  explicit Seer(std::map<std::string, int> lefts) : lefts_(std::move(lefts)) {}
  std::string name() const override { return "seer"; }
  std::vector<ConfidenceMap> Predict(const std::vector<Query>& queries) const override {
    asked += queries.size();
    std::vector<ConfidenceMap> maps;
    for (const Query& h : queries) {
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

TEST_F(ConsistencyTest, CalibratesASecondOracleAlone) {
  std::map<std::string, int> lefts = {{"new", 40}};
  for (const Query& h : held_out) lefts[h.proposal.name] = 10 + 9 * *h.held_out;
  const Seer seer(lefts);
  const Warper warper({views, maps});
  ConsistencyOracle oracle(FeatureSource(warper, seer, Evidence::kSecond), views);
  EXPECT_EQ(oracle.name(), "seer");
  oracle.Calibrate(held_out);
  const ConfidenceMap map = oracle.Predict(std::vector<Proposal>{{"new", "test", views[0].camera, views[0].rgb}})[0];
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

TEST_F(ConsistencyTest, LearnsFromASecondOracleWhatTheImagesDoNotShow) {
  // Each view shows something in its square that no other one shows, and no proposal has.
  std::map<std::string, int> lefts = {{"new", 40}};
  std::vector<LoadedView> surprising = views;
  std::vector<Query> blind;
  for (int v = 0; v < 6; ++v) {
    const LoadedView& view = views[static_cast<size_t>(v)];
    lefts[view.name] = 10 + 9 * v;
    surprising[static_cast<size_t>(v)].rgb = held_out[static_cast<size_t>(v)].proposal.rgb;
    blind.push_back({{view.name, "test", view.camera, view.rgb}, v});
  }
  const Seer seer(lefts);
  const Warper warper({views, maps});
  ConsistencyOracle alone(FeatureSource(warper), surprising),
      both(FeatureSource(warper, seer, Evidence::kBoth), surprising);
  EXPECT_EQ(both.name(), "seer+consistency");
  alone.Calibrate(blind);
  both.Calibrate(blind);
  const LoadedView truth = plane.Take(CameraAt({0.5, 0.1, -4}, {0, 0, 0}, 96, 72), "new");
  const Proposal proposal{"new", "test", truth.camera, truth.rgb};
  const auto means = [](const ConfidenceMap& map) {
    double inside = 0, outside = 0;
    for (size_t i = 0; i < map.size(); ++i) (InSquare(i, 40) ? inside : outside) += static_cast<double>(map[i]);
    return std::pair{inside / 900, outside / (96 * 72 - 900)};
  };
  const auto [inside, outside] = means(both.Predict(std::vector<Proposal>{proposal})[0]);
  const double inside_alone = means(alone.Predict(std::vector<Proposal>{proposal})[0]).first;
  EXPECT_LT(inside, inside_alone - 0.2);
  EXPECT_GT(outside, 0.98) << "but for the square's edge, where doubt spreads";
}

TEST_F(ConsistencyTest, AsksTheSecondOracleOnceToCalibrateAndPredict) {
  std::map<std::string, int> lefts;
  for (const Query& query : held_out) lefts[query.proposal.name] = 10 + 9 * *query.held_out;
  const Seer seer(lefts);
  const Warper warper({views, maps});
  const FeatureSource features(warper, seer, Evidence::kBoth);
  ConsistencyOracle oracle(features, views), again(features, views);
  const auto maps_of = oracle.CalibrateAndPredict(held_out);
  EXPECT_EQ(seer.asked, 6u);
  again.Calibrate(held_out);
  EXPECT_EQ(again.Predict(held_out), maps_of);
  EXPECT_EQ(seer.asked, 18u);
}

TEST(Smooth, WhatIsTheSameEverywhereStays) {
  ConfidenceMap map(7 * 4, 0.375f);
  Smooth(7, 4, &map);
  for (const float trust : map) EXPECT_FLOAT_EQ(trust, 0.375f);
}

TEST(Smooth, APixelSpreadsToTheFiveByFiveAroundIt) {
  ConfidenceMap map(9 * 10, 0);
  map[4 * 9 + 4] = 1;
  Smooth(9, 10, &map);
  constexpr float kTaps[] = {1, 4, 6, 4, 1};
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 9; ++x) {
      const bool near = std::abs(x - 4) <= 2 && std::abs(y - 4) <= 2;
      const float expected = near ? kTaps[x - 2] * kTaps[y - 2] / 256 : 0;
      EXPECT_NEAR(map[static_cast<size_t>(y * 9 + x)], expected, 1e-7) << x << ' ' << y;
    }
  }
}

TEST(Smooth, AtTheBorderOnlyWhatLiesWithinCounts) {
  ConfidenceMap row = {1, 0, 0, 0};
  Smooth(4, 1, &row);
  EXPECT_FLOAT_EQ(row[0], 6.f / 11);
  EXPECT_FLOAT_EQ(row[1], 4.f / 15);
  EXPECT_FLOAT_EQ(row[2], 1.f / 15);
  EXPECT_EQ(row[3], 0);
  ConfidenceMap column = {1, 0, 0, 0};
  Smooth(1, 4, &column);
  EXPECT_EQ(column, row);
}

TEST(Smooth, RefusesAMapOfAnotherSize) {
  ConfidenceMap map(5);
  EXPECT_THROW(Smooth(2, 2, &map), ShapeError);
}

}  // namespace
}  // namespace oraclegs
