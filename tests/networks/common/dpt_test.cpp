#include "oraclegs/networks/common/dpt.h"

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

}  // namespace
}  // namespace oraclegs
