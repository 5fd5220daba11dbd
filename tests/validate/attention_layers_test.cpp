#include "oraclegs/validate/attention_layers.h"

#include <gmock/gmock.h>

#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

ValidateOptions With(const std::string& layers, const std::string& weights) {
  ValidateOptions options;
  options.vggt_layers = layers, options.vggt_layer_weights = weights;
  return options;
}

std::string Refusal(const std::string& layers, const std::string& weights) {
  return MessageOf<UsageError>([&] { AttentionLayersOf(With(layers, weights)); });
}

TEST(AttentionLayers, AreLeftToTheFileByDefault) { EXPECT_TRUE(AttentionLayersOf({}).empty()); }

TEST(AttentionLayers, HaveWeightsThatSumToOne) {
  const auto layers = AttentionLayersOf(With("0, 22", "1,3"));
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layers[0].layer, 0);
  EXPECT_EQ(layers[1].layer, 22);
  EXPECT_EQ(layers[0].weight, 0.25);
  EXPECT_EQ(layers[1].weight, 0.75);
  const auto with_zero = AttentionLayersOf(With("4,11,17", "0,0.5,0"));
  EXPECT_EQ(with_zero[0].weight, 0);
  EXPECT_EQ(with_zero[1].weight, 1);
}

TEST(AttentionLayers, CountAlikeWithoutWeights) {
  for (const LayerWeight& layer : AttentionLayersOf(With("3,1,7,5", ""))) EXPECT_EQ(layer.weight, 0.25);
  EXPECT_EQ(AttentionLayersOf(With("11", "")).at(0).weight, 1);
}

TEST(AttentionLayers, RefuseWhatIsNoListOfThem) {
  for (const char* layers : {"x", "0,2.5", "-1", "0;22", "99999999999999999999"}) {
    EXPECT_THAT(Refusal(layers, ""), AllOf(HasSubstr("--set vggt-layers: '"), HasSubstr("number of a layer")))
        << layers;
  }
  for (const char* weights : {"1,x", "1,-3", "1,nan", "inf,1", "1,1e999"}) {
    EXPECT_THAT(Refusal("0,22", weights), AllOf(HasSubstr("--set vggt-layer-weights: '"), HasSubstr("a number from 0")))
        << weights;
  }
  EXPECT_THAT(Refusal("0,22,0", ""), HasSubstr("--set vggt-layers names layer 0 more than once"));
  EXPECT_THAT(Refusal("0,22", "1,2,3"), HasSubstr("names 2 layers, --set vggt-layer-weights 3"));
  EXPECT_THAT(Refusal("0,22", "1"), HasSubstr("give each layer one weight"));
  EXPECT_THAT(Refusal("0,22", "0,0"), HasSubstr("at least one must be above 0"));
  EXPECT_THAT(Refusal("", "1,3"), HasSubstr("--set vggt-layer-weights needs --set vggt-layers"));
}

TEST(AttentionLayers, MustBeAmongTheNetworks) {
  const auto layers = AttentionLayersOf(With("0,23", ""));
  EXPECT_NO_THROW(RequireAttentionLayers(layers, 24, "VGGT-1B"));
  EXPECT_NO_THROW(RequireAttentionLayers({}, 1, "VGGT-1B"));
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAttentionLayers(layers, 23, "VGGT-1B"); }),
              HasSubstr("--set vggt-layers names layer 23; VGGT-1B has the layers 0 to 22"));
}

}  // namespace
}  // namespace oraclegs
