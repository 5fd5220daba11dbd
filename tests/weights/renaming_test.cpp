#include "oraclegs/weights/renaming.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/weights/parameter_list.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;

TEST(NameInNetwork, NamesTheTapsOfLpips) {
  EXPECT_EQ(NameInNetwork("lpips-vgg", "3.1.weight"), "lin3.model.1.weight");
  for (const char* same :
       {"lin3.model.1.weight", "5.1.weight", "3.1.weight.x", "x3.1.weight", "features.0.weight", ""}) {
    EXPECT_EQ(NameInNetwork("lpips-alex", same), same);
  }
  EXPECT_EQ(NameInNetwork("vggt", "3.1.weight"), "3.1.weight");
}

TEST(NameInNetwork, NamesTheAttentionOfTheAutoencoder) {
  const ParameterList list = ParametersOf("sd21-vae");
  const std::string at = "decoder.mid_block.attentions.0.";
  for (const auto& [old_name, name] : std::map<std::string, std::string>{{"query.weight", "to_q.weight"},
                                                                         {"key.bias", "to_k.bias"},
                                                                         {"value.weight", "to_v.weight"},
                                                                         {"proj_attn.bias", "to_out.0.bias"},
                                                                         {"group_norm.weight", "group_norm.weight"},
                                                                         {"to_q.weight", "to_q.weight"}}) {
    EXPECT_EQ(NameInNetwork("sd21-vae", at + old_name), at + name);
    EXPECT_TRUE(list.tensors.contains(at + name)) << name;
  }
  for (const char* same :
       {"quant_conv.weight", "x.attentions.query.weight", "x.attentions.0", "x.attentions.0query."}) {
    EXPECT_EQ(NameInNetwork("sd21-vae", same), same);
  }
}

TEST(ShapedForNetwork, FlattensTheMatricesOfTheAttention) {
  const StoredTensor convolution{"F32", 4, {2, 3, 1, 1}, {3, 1, 1, 1}, {}};
  const std::string at = "encoder.mid_block.attentions.0.";
  for (const char* name : {"to_q.weight", "to_out.0.weight"}) {
    const StoredTensor matrix = ShapedForNetwork("sd21-vae", at + name, convolution);
    EXPECT_THAT(matrix.shape, ElementsAre(2, 3));
    EXPECT_THAT(matrix.strides, ElementsAre(3, 1));
  }
  EXPECT_EQ(ShapedForNetwork("sd21-vae", "quant_conv.weight", convolution).shape.size(), 4u);
  EXPECT_EQ(ShapedForNetwork("sd21-vae", at + "to_q.bias", convolution).shape.size(), 4u);
  EXPECT_EQ(ShapedForNetwork("vggt", at + "to_q.weight", convolution).shape.size(), 4u);
}

}  // namespace
}  // namespace oraclegs
