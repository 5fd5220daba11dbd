#include "oraclegs/validate/feature_source.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

/// Predicts 0.25 everywhere.
class Quarter : public Oracle {
 public:
  std::string name() const override { return "quarter"; }
  std::vector<ConfidenceMap> Predict(const std::vector<Query>& queries) const override {
    return std::vector<ConfidenceMap>(queries.size(), ConfidenceMap(size_t{96} * 72, 0.25f));
  }
};

class FeatureSourceTest : public testing::Test {
 protected:
  FeatureSourceTest() {
    for (const LoadedView& view : views) maps.push_back(TrueDepth(view, plane, 0.9f));
    for (int v = 0; v < 2; ++v) {
      const LoadedView& view = views[static_cast<size_t>(v)];
      queries.push_back({{view.name, "test", view.camera, view.rgb}, v});
    }
  }

  /// The rows of the first pixel of each query.
  std::vector<std::vector<float>> FirstRows(const FeatureSource& source) const {
    std::vector<std::vector<float>> rows(queries.size());
    source.ForEach(queries, source.SecondMaps(queries), [&](size_t q, const PixelRows& of_query) {
      EXPECT_EQ(of_query.size(), 96u * 72u);
      PixelRows::Space space;
      const float* row = of_query.Row(0, &space);
      rows[q].assign(row, row + of_query.columns());
    });
    return rows;
  }

  TexturedPlane plane;
  std::vector<LoadedView> views = TakeAll(plane, Arc(4, 8));
  std::vector<DepthMap> maps;
  std::vector<Query> queries;
};

TEST_F(FeatureSourceTest, GivesRowsOfTheChosenEvidence) {
  const Warper warper({views, maps});
  const Quarter quarter;
  const auto images = FirstRows(FeatureSource(warper));
  const auto second = FirstRows(FeatureSource(warper, quarter, Evidence::kSecond));
  const auto both = FirstRows(FeatureSource(warper, quarter, Evidence::kBoth));
  for (size_t q = 0; q < queries.size(); ++q) {
    ASSERT_EQ(images[q].size(), kFeatures);
    EXPECT_EQ(second[q], std::vector<float>{0.25f});
    std::vector<float> expected = images[q];
    expected.push_back(0.25f);
    EXPECT_EQ(both[q], expected);
  }
}

TEST_F(FeatureSourceTest, ComparesThoroughlyWithWarpAndProxyRender) {
  const Warper warper({views, maps});
  const Quarter quarter;
  const auto plain = FirstRows(FeatureSource(warper)), warp = FirstRows(FeatureSource(warper).Thorough());
  for (Query& query : queries) query.proxy_render = query.proposal.rgb;
  EXPECT_EQ(FirstRows(FeatureSource(warper)), plain) << "proxy renders are for thorough ones";
  const auto both = FirstRows(FeatureSource(warper, quarter, Evidence::kBoth).Thorough());
  for (size_t q = 0; q < queries.size(); ++q) {
    ASSERT_EQ(warp[q].size(), kFeatures + kComparisons);
    EXPECT_TRUE(std::equal(plain[q].begin(), plain[q].end(), warp[q].begin()));
    ASSERT_EQ(both[q].size(), PixelRows::kMaxColumns);
    EXPECT_TRUE(std::equal(warp[q].begin(), warp[q].end(), both[q].begin()));
    const Comparison same = Compare(queries[q].proposal.rgb, queries[q].proxy_render)[0];
    EXPECT_TRUE(std::equal(same.begin(), same.end(), both[q].begin() + kFeatures + kComparisons));
    EXPECT_EQ(both[q].back(), 0.25f);
  }
}

TEST_F(FeatureSourceTest, IsNamedAfterItsEvidence) {
  const Warper warper({views, maps});
  const Quarter quarter;
  EXPECT_EQ(FeatureSource(warper).name(), "consistency");
  EXPECT_EQ(FeatureSource(warper, quarter, Evidence::kSecond).name(), "quarter");
  EXPECT_EQ(FeatureSource(warper, quarter, Evidence::kBoth).name(), "quarter+consistency");
}

}  // namespace
}  // namespace oraclegs
