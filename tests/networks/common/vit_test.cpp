#include "oraclegs/networks/common/vit.h"

#include "networks/golden_tensors.h"

namespace oraclegs {
namespace {

VitConfig Tiny(int64_t registers) {
  VitConfig config;
  config.width = 16;
  config.depth = 3;
  config.heads = 2;
  config.position_grid = 3;
  config.registers = registers;
  return config;
}

Vit RandomVit(const VitConfig& config) {
  RandomParameters source(11);
  return LoadVit(ParameterScope(source), config);
}

TEST(Vit, RegistersStandBetweenClassAndPatchesWithoutPosition) {
  const Vit with = RandomVit(Tiny(2));
  Vit without = with;
  without.config.registers = 0;
  const Tensor image = torch::rand({2, 3, 28, 42});
  const Tensor a = EmbedImages(with, image), b = EmbedImages(without, image);
  ASSERT_EQ(a.sizes(), at::IntArrayRef({2, 1 + 2 + 6, 16}));
  EXPECT_TRUE(torch::equal(a.slice(1, 0, 1), b.slice(1, 0, 1)));
  EXPECT_TRUE(torch::equal(a.slice(1, 1, 3), with.register_tokens.expand({2, 2, 16})));
  EXPECT_TRUE(torch::equal(a.slice(1, 3), b.slice(1, 1)));
}

TEST(Vit, ThePositionGridOfTheTrainingSizeIsUsedAsStored) {
  const Vit vit = RandomVit(Tiny(0));
  EXPECT_TRUE(torch::equal(PositionEmbedding(vit, 3, 3), vit.positions));
  EXPECT_GT(MaxAbsError(PositionEmbedding(vit, 1, 9).slice(1, 1), vit.positions.slice(1, 1)), 0.01);
}

TEST(Vit, ConstantPositionsStayConstant) {
  for (const bool antialias : {false, true}) {
    Vit vit = RandomVit(Tiny(0));
    vit.config.position_antialias = antialias;
    vit.config.position_offset = antialias ? 0 : 0.1;
    vit.positions = torch::full({1, 10, 16}, 0.25f);
    const Tensor resampled = PositionEmbedding(vit, 2, 5);
    ASSERT_EQ(resampled.sizes(), at::IntArrayRef({1, 11, 16}));
    EXPECT_LT(MaxAbsError(resampled, torch::full({1, 11, 16}, 0.25f)), 1e-6);
  }
}

TEST(Vit, LayersAreNormedPrefixesOfOneNetwork) {
  const Vit vit = RandomVit(Tiny(1));
  const Tensor image = torch::rand({1, 3, 28, 28});
  const std::vector<Tensor> layers = LayerTokens(vit, image, {0, 2});
  Tensor x = Forward(vit.blocks[0], EmbedImages(vit, image));
  EXPECT_TRUE(torch::equal(layers[0], Forward(vit.norm, x)));
  x = Forward(vit.blocks[2], Forward(vit.blocks[1], x));
  EXPECT_TRUE(torch::equal(layers[1], Forward(vit.norm, x)));
}

TEST(Vit, RunsInHalfPrecision) {
  torch::manual_seed(5);
  Vit vit = RandomVit(Tiny(1));
  const Tensor image = torch::rand({1, 3, 28, 28});
  const Tensor full = LayerTokens(vit, image, {2})[0];
  class Halved : public RandomParameters {
   public:
    using RandomParameters::RandomParameters;
    Tensor Get(const std::string& name, at::IntArrayRef shape) override {
      return RandomParameters::Get(name, shape).to(torch::kBFloat16);
    }
  } source(11);
  const Tensor half = LayerTokens(LoadVit(ParameterScope(source), Tiny(1)), image, {2})[0];
  EXPECT_EQ(half.scalar_type(), torch::kBFloat16);
  EXPECT_LT(RelativeL2(half, full), kMaxHalfError);
}

TEST(Vit, RefusesLayersThatDoNotExist) {
  const Vit vit = RandomVit(Tiny(0));
  const Tensor image = torch::rand({1, 3, 28, 28});
  EXPECT_THROW(LayerTokens(vit, image, {}), ShapeError);
  EXPECT_THROW(LayerTokens(vit, image, {3}), ShapeError);
  EXPECT_THROW(LayerTokens(vit, image, {-1}), ShapeError);
  EXPECT_THROW(LayerTokens(vit, image, {2, 1}), ShapeError);
  EXPECT_THROW(EmbedImages(vit, torch::rand({1, 3, 27, 28})), ShapeError);
}

}  // namespace
}  // namespace oraclegs
