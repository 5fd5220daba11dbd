#include "oraclegs/weights/convert.h"
#include "oraclegs/weights/parameter_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "checkpoint/torch_bytes.h"
#include "lpips_files.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/safetensors.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace torch_bytes;  // NOLINT: files and pieces of pickles

class ConvertWeightsTest : public testing::Test {
 protected:
  /// Converts files of this content for the model, if it has a name.
  size_t Convert(const std::vector<std::string>& contents, const std::string& model = "") {
    ConvertRequest request;
    for (const std::string& content : contents) {
      request.files.push_back(dir_ / fmt::format("{}.pth", request.files.size()));
      WriteFileAtomically(request.files.back(), content);
    }
    request.to = out_;
    if (!model.empty()) request.model = &WeightsNamed(model);
    return ConvertWeights(request, events_.AsListener());
  }
  std::string ErrorOf(const std::vector<std::string>& contents, const std::string& model = "") {
    const std::string message = MessageOf<InputError>([&] { Convert(contents, model); });
    EXPECT_FALSE(std::filesystem::exists(out_));
    return message;
  }
  SafetensorsFile Written() const { return SafetensorsFile::Open(out_); }

  TempDir dir_;
  std::filesystem::path out_ = dir_ / "out/model.safetensors";
  EventRecorder events_;
};

TEST_F(ConvertWeightsTest, KeepsNumbersAndTypes) {
  const std::string half = Tensor(Storage("1", 3, "HalfStorage"), {{3}, {1}});
  EXPECT_EQ(Convert({ZipFile(Dict({{"turned", Tensor(Storage("0", 6), {{3, 2}, {1, 3}})}, {"half", half}}),
                             {{"0", Floats({0, 1, 2, 3, 4, 5})}, {"1", "abcdef"}})}),
            2u);
  EXPECT_EQ(Written().Values<float>("turned"), (std::vector<float>{0, 3, 1, 4, 2, 5}));
  EXPECT_EQ(Written().Get("half").dtype, "F16");
  EXPECT_EQ(Written().Get("half").bytes, "abcdef");
  EXPECT_EQ(Written().metadata(), (std::map<std::string, std::string>{{"source", "0.pth"}}));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_ / "out"), {}), 1);
}

TEST_F(ConvertWeightsTest, FitsTensorsToTheNetwork) {
  EXPECT_EQ(Convert({LpipsFeatures({{"other", {1}}}), LpipsTaps()}, "lpips-alex"), 15u);
  EXPECT_THAT(events_.warnings,
              ElementsAre(EndsWith("1.pth: leaves out 1 tensors that are no part of lpips-alex: other")));
  EXPECT_EQ(Written().tensors().size(), 15u);
  EXPECT_TRUE(Written().Has("lin4.model.1.weight"));
  EXPECT_FALSE(Written().Has("classifier.6.bias"));
  EXPECT_EQ(Written().metadata().at("model"), "lpips-alex");
}

TEST_F(ConvertWeightsTest, ListsWhatDoesNotFit) {
  EXPECT_THAT(ErrorOf({LpipsFeatures()}, "lpips-alex"),
              EndsWith("0.pth: cannot be converted to lpips-alex; 5 missing: lin0.model.1.weight, lin1.model.1.weight, "
                       "lin2.model.1.weight, lin3.model.1.weight, lin4.model.1.weight; is it the right file?"));
  EXPECT_THAT(ErrorOf({LpipsFeatures(), LpipsTaps(63)}, "lpips-alex"),
              HasSubstr("; 1 of another shape: lin0.model.1.weight is [1, 63, 1, 1], expected [1, 64, 1, 1]; is it"));
  EXPECT_THAT(events_.warnings, IsEmpty());
}

TEST_F(ConvertWeightsTest, RefusesATensorThatComesTwice) {
  const std::string file = ZipFile(Dict({{"a", Vector("0", 1)}}), {{"0", Floats({1})}});
  EXPECT_THAT(ErrorOf({file, file}), EndsWith("1.pth: holds tensor 'a' a second time; convert the files one by one"));
}

TEST_F(ConvertWeightsTest, RefusesWhatSafetensorsCannotHold) {
  const auto file = [](const std::string& name, const std::string& type) {
    return ZipFile(Dict({{name, Tensor(Storage("0", 1, type), {{1}, {1}})}}), {{"0", "12345678"}});
  };
  EXPECT_THAT(ErrorOf({file("a", "ComplexFloatStorage")}),
              HasSubstr("tensor 'a' is of type C64, which safetensors cannot"));
  EXPECT_THAT(ErrorOf({file("\xff", "FloatStorage")}),
              HasSubstr("a tensor with the name '?', which safetensors cannot"));
  EXPECT_THAT(ErrorOf({file("__metadata__", "FloatStorage")}), HasSubstr("the name '__metadata__'"));
}

TEST_F(ConvertWeightsTest, RefusesFilesThatGrow) {
  std::vector<std::pair<std::string, std::string>> tensors;
  for (int i = 0; i < 40; ++i) tensors.emplace_back(fmt::format("t{}", i), Vector("0", 100'000));
  const std::map<std::string, std::string> storages = {{"0", std::string(400'000, '\0')}};
  EXPECT_THAT(ErrorOf({ZipFile(Dict(tensors), storages)}),
              HasSubstr("would fill more than 16 times the file; refused"));
  tensors.resize(3);  // tied weights
  EXPECT_EQ(Convert({ZipFile(Dict(tensors), storages)}), 3u);
}

TEST_F(ConvertWeightsTest, LeavesNothingWhenItIsInterrupted) {
  RequestInterrupt(true);
  EXPECT_THROW(Convert({ZipFile(Dict({{"a", Vector("0", 1)}}), {{"0", Floats({1})}})}), Interrupted);
  RequestInterrupt(false);
  EXPECT_TRUE(std::filesystem::is_empty(dir_ / "out"));
}

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
