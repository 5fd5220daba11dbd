#include "oraclegs/networks/common/dpt.h"

#include <cmath>

#include "networks/golden_tensors.h"

namespace oraclegs {
namespace {

DptHead RandomHead(DptStyle style) {
  RandomParameters source(21);
  return LoadDptHead(ParameterScope(source), {style, 12, 8, {8, 8, 12, 16}, 3});
}

std::array<Tensor, 4> RandomLayers(int64_t views, int64_t patches) {
  torch::manual_seed(22);
  std::array<Tensor, 4> layers;
  for (Tensor& layer : layers) layer = torch::randn({views, patches, 12});
  return layers;
}

TEST(Dpt, SizesGrowFromTheGridToTheImage) {
  const auto layers = RandomLayers(1, 15);
  for (const DptStyle style : {DptStyle::kDepthAnything, DptStyle::kVggt}) {
    const DptHead head = RandomHead(style);
    const auto fused = FuseLayers(head, layers, {3, 5});
    EXPECT_EQ(fused[3].sizes(), at::IntArrayRef({1, 8, 3, 5}));
    EXPECT_EQ(fused[2].sizes(), at::IntArrayRef({1, 8, 6, 10}));
    EXPECT_EQ(fused[1].sizes(), at::IntArrayRef({1, 8, 12, 20}));
    EXPECT_EQ(fused[0].sizes(), at::IntArrayRef({1, 8, 24, 40}));
    EXPECT_EQ(Forward(head, layers, {3, 5}).sizes(), at::IntArrayRef({1, 3, 42, 70}));
  }
}

TEST(Dpt, ViewsDoNotMeet) {
  const DptHead head = RandomHead(DptStyle::kVggt);
  const auto layers = RandomLayers(2, 6);
  std::array<Tensor, 4> second;
  for (size_t i = 0; i < 4; ++i) second[i] = layers[i].slice(0, 1);
  EXPECT_TRUE(torch::equal(Forward(head, layers, {2, 3}).slice(0, 1), Forward(head, second, {2, 3})));
}

TEST(Dpt, OneForwardPassDoesNotChangeTheNext) {
  const DptHead head = RandomHead(DptStyle::kVggt);
  const auto layers = RandomLayers(1, 6);
  const Tensor first = Forward(head, layers, {2, 3});
  EXPECT_TRUE(torch::equal(Forward(head, layers, {2, 3}), first));
}

TEST(Dpt, TheUnusedUnitBelongsToDepthAnythingOnly) {
  for (const DptStyle style : {DptStyle::kDepthAnything, DptStyle::kVggt}) {
    ListedParameters list;
    LoadDptHead(ParameterScope(list), {style, 12, 8, {8, 8, 12, 16}, 3});
    EXPECT_EQ(list.shapes().count("scratch.refinenet4.resConfUnit1.conv2.bias"),
              style == DptStyle::kDepthAnything ? 1u : 0u);
  }
}

TEST(Dpt, RefusesTokensOfAnotherGrid) {
  const DptHead head = RandomHead(DptStyle::kDepthAnything);
  EXPECT_THROW(Forward(head, RandomLayers(1, 6), {2, 2}), ShapeError);
  auto narrow = RandomLayers(1, 6);
  narrow[2] = torch::rand({1, 6, 11});
  EXPECT_THROW(FuseLayers(head, narrow, {2, 3}), ShapeError);
}

TEST(GridEmbedding, FollowsItsFormula) {
  const double aspect = 1.5, diagonal = std::sqrt(aspect * aspect + 1);
  const Tensor e = GridEmbedding(8, 3, 5, aspect);
  ASSERT_EQ(e.sizes(), at::IntArrayRef({8, 3, 5}));
  const double x = aspect / diagonal * 4 / 5 * 0.5, y = -1 / diagonal * 2 / 3;  // of column 3 and of row 0
  const double slow = 0.1;                                                      // 100^(-1/2)
  const std::vector<double> expected = {std::sin(x), std::sin(x * slow), std::cos(x), std::cos(x * slow),
                                        std::sin(y), std::sin(y * slow), std::cos(y), std::cos(y * slow)};
  EXPECT_LT(MaxAbsError(e.select(2, 3).select(1, 0), torch::tensor(expected, torch::kDouble)), 1e-7);
}

TEST(GridEmbedding, ASinglePixelIsInTheMiddle) {
  const Tensor e = GridEmbedding(4, 1, 1, 2).flatten();
  EXPECT_TRUE(torch::equal(e, torch::tensor({0.f, 1.f, 0.f, 1.f})));
}

TEST(GridEmbedding, RefusesOddChannels) {
  EXPECT_THROW(GridEmbedding(6, 2, 2, 1), ShapeError);
  EXPECT_THROW(GridEmbedding(0, 2, 2, 1), ShapeError);
  EXPECT_THROW(GridEmbedding(4, 0, 2, 1), ShapeError);
}

}  // namespace

}  // namespace oraclegs
