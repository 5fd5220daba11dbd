// The lists by which `models check` checks a file are what the networks ask for.

#include "oraclegs/weights/parameter_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "oraclegs/networks/aliked/aliked.h"
#include "oraclegs/networks/depth_anything/depth_anything.h"
#include "oraclegs/networks/lpips/lpips.h"
#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs {
namespace {

using Shapes = std::map<std::string, std::vector<int64_t>>;

Shapes Required(const std::string& list) {
  Shapes shapes;
  for (const auto& [name, tensor] : ParametersOf(list).tensors) {
    if (!tensor.optional) shapes[name] = tensor.shape;
  }
  return shapes;
}

TEST(ModelLists, DepthAnything) {
  for (const auto& [list, size] : {std::pair{"depth-anything-v2-small", DepthAnythingSize::kSmall},
                                   {"depth-anything-v2-base", DepthAnythingSize::kBase},
                                   {"depth-anything-v2-large", DepthAnythingSize::kLarge}}) {
    ListedParameters listed;
    LoadDepthAnything(listed, DepthAnythingV2(size));
    EXPECT_EQ(Required(list), listed.shapes()) << list;
  }
}

TEST(ModelLists, Vggt) {
  ListedParameters listed;
  vggt::LoadVggt(listed, vggt::Config(), vggt::Heads{true, true});
  EXPECT_EQ(Required("vggt"), listed.shapes());
}

TEST(ModelLists, Lpips) {
  for (const auto& [list, network] :
       {std::pair{"lpips-vgg", FeatureNetwork::kVgg16}, {"lpips-alex", FeatureNetwork::kAlexNet}}) {
    ListedParameters listed;
    LoadLpips(listed, PublishedFeatures(network));
    EXPECT_EQ(Required(list), listed.shapes()) << list;
  }
}

TEST(ModelLists, Aliked) {
  ListedParameters listed;
  aliked::LoadAliked(listed, aliked::AlikedConfig());
  EXPECT_EQ(Required("aliked-n16"), listed.shapes());
}

}  // namespace
}  // namespace oraclegs
