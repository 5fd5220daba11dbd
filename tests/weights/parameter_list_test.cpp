#include "oraclegs/weights/parameter_list.h"

#include <fstream>
#include <stdexcept>

#include "support/golden.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;

TEST(ParseParameterList, ExpandsRangesAndWords) {
  const ParameterList list = ParseParameterList("# a comment\nignore text.\na.{0-2,7}.{w,b} 3x1\n?c 5\n");
  EXPECT_EQ(list.tensors.size(), 9u);
  for (const char* name : {"a.0.w", "a.2.b", "a.7.w"}) EXPECT_THAT(list.tensors.at(name).shape, ElementsAre(3, 1));
  EXPECT_FALSE(list.tensors.at("a.0.w").optional);
  EXPECT_TRUE(list.tensors.at("c").optional);
  EXPECT_TRUE(list.Ignores("text.x"));
  EXPECT_FALSE(list.Ignores("tex"));
}

TEST(ParseParameterList, RefusesMalformedLists) {
  for (const char* text : {"a", "a b", "a 3 4", "a 3y4", "a{1 3", "a -3", "a 3\na 3"}) {
    EXPECT_THROW(ParseParameterList(text), std::logic_error) << text;
  }
  EXPECT_THROW(ParametersOf("none"), std::logic_error);
}

/// The parameter lists made from the official networks: name, shape 1x2x3, type, numbers.
std::map<std::string, std::string> Official(const std::string& file) {
  std::ifstream in(GoldenDir() / (file + "_params.tsv"));
  EXPECT_TRUE(in) << file;
  std::map<std::string, std::string> shapes;
  std::string name, shape, rest;
  std::getline(in, rest);
  while (std::getline(in, name, '\t') && std::getline(in, shape, '\t') && std::getline(in, rest)) shapes[name] = shape;
  return shapes;
}

TEST(ParametersOf, EqualsTheOfficialNetworks) {
  const std::map<std::string, std::string> kFiles = {{"depth-anything-v2-small", "depth_anything_v2_vits"},
                                                     {"depth-anything-v2-base", "depth_anything_v2_vitb"},
                                                     {"depth-anything-v2-large", "depth_anything_v2_vitl"},
                                                     {"vggt", "vggt"},
                                                     {"seva", "seva_unet"},
                                                     {"sd21-vae", "sd21_vae"},
                                                     {"openclip-vith14", "openclip_vith14_visual"}};
  for (const auto& [list, file] : kFiles) {
    std::map<std::string, std::string> ours;
    for (const auto& [name, tensor] : ParametersOf(list).tensors) {
      for (const int64_t size : tensor.shape) ours[name] += (ours[name].empty() ? "" : "x") + std::to_string(size);
    }
    EXPECT_EQ(ours, Official(file)) << list;
  }
}

}  // namespace
}  // namespace oraclegs
