#include "oraclegs/core/safetensors_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {
using testing::ElementsAre;

constexpr int64_t kMost = std::numeric_limits<int64_t>::max();

TEST(ElementBytes, KnowsTheTypesOfTheFormat) {
  EXPECT_EQ(ElementBytes("F32"), 4u);
  EXPECT_EQ(ElementBytes("BF16"), 2u);
  EXPECT_EQ(ElementBytes("BOOL"), 1u);
  EXPECT_EQ(ElementBytes("C64"), std::nullopt);
}

TEST(TensorBytes, RefusesOverflowAndNegativeSizes) {
  EXPECT_EQ(TensorBytes({2, 3}, 4), 24u);
  EXPECT_EQ(TensorBytes({}, 8), 8u);
  EXPECT_EQ(TensorBytes({0, kMost}, 8), 0u);
  EXPECT_EQ(TensorBytes({kMost}, 1), static_cast<uint64_t>(kMost));
  EXPECT_EQ(TensorBytes({kMost}, 2), std::nullopt);
  EXPECT_EQ(TensorBytes({int64_t{1} << 32, int64_t{1} << 31}, 1), std::nullopt);
  EXPECT_EQ(TensorBytes({-1}, 1), std::nullopt);
}

TEST(LayOutSafetensors, PutsWideElementsFirst) {
  const SafetensorsLayout layout =
      LayOutSafetensors({{"a", {"U8", {3}}}, {"b", {"F64", {1}}}, {"c", {"U8", {2}}}}, {{"k", "v"}});
  EXPECT_THAT(layout.order, ElementsAre("b", "a", "c"));
  EXPECT_EQ(layout.data_bytes, 13u);
  EXPECT_EQ(layout.beginning.size() % 8, 0u);
  const SafetensorsFile file = SafetensorsFile::Parse(layout.beginning + "12345678abcde", "f");
  EXPECT_EQ(file.Get("a").bytes, "abc");
  EXPECT_EQ(file.Get("c").bytes, "de");
  EXPECT_EQ(file.metadata().at("k"), "v");
}

TEST(LayOutSafetensors, RefusesWhatTheFormatCannotHold) {
  for (const auto& [name, tensor] : std::map<std::string, TensorLayout>{{"type", {"C64", {1}}},
                                                                        {"size", {"U8", {-1}}},
                                                                        {"large", {"F64", {kMost}}},
                                                                        {"\xff", {"U8", {1}}},
                                                                        {"__metadata__", {"U8", {1}}}}) {
    EXPECT_THROW(LayOutSafetensors({{name, tensor}}, {}), std::logic_error) << name;
  }
  EXPECT_THROW(LayOutSafetensors({{"a", {"U8", {kMost}}}, {"b", {"U8", {1}}}}, {}), std::logic_error);
}

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string kIndex = "model.safetensors.index.json";

/// A safetensors file of one-number tensors.
std::string File(const std::map<std::string, float>& values) {
  std::map<std::string, TensorEntry> tensors;
  for (const auto& [name, value] : values) {
    tensors[name] = {"F32", {1}, {reinterpret_cast<const char*>(&value), sizeof value}};
  }
  return SerializeSafetensors(tensors, {{"format", "pt"}});
}

class ShardIndex : public testing::Test {
 protected:
  void SetUp() override {
    WriteFileAtomically(dir_ / "a.safetensors", File({{"x", 1}, {"y", 2}}));
    WriteFileAtomically(dir_ / "b.safetensors", File({{"z", 3}}));
  }
  /// The line that opening this index ends with; empty when it opens.
  std::string Complaint(const std::string& index) {
    WriteFileAtomically(dir_ / kIndex, index);
    try {
      SafetensorsFile::Open(dir_ / kIndex);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), AllOf(StartsWith(dir_.path().string()), Not(HasSubstr("\n"))));
      return error.what();
    }
    return "";
  }
  std::string Seeking(const std::string& part) {
    return Complaint(R"({"weight_map":{"x":)" + part + R"(,"y":"a.safetensors","z":"b.safetensors"}})");
  }

  TempDir dir_;
};

TEST_F(ShardIndex, MayListFilesOfPyTorch) {
  const auto index = dir_ / "pytorch_model.bin.index.json";
  EXPECT_TRUE(IsTorchShardIndex(index));
  EXPECT_FALSE(IsShardIndex(index));
  EXPECT_FALSE(IsTorchShardIndex(dir_ / kIndex));
  WriteFileAtomically(index, R"({"weight_map":{"x":"a.bin","y":"b.bin"}})");
  EXPECT_EQ(ReadShardIndex(index).at("b.bin"), std::set<std::string>{"y"});
  WriteFileAtomically(index, R"({"weight_map":{"x":"a.safetensors"}})");
  EXPECT_THROW(ReadShardIndex(index), InputError);
}

TEST_F(ShardIndex, PartsOpenAsOneFile) {
  WriteFileAtomically(dir_ / kIndex, R"({"metadata":{"total_size":12},"weight_map":{"x":"a.safetensors",)"
                                     R"("y":"a.safetensors","z":"b.safetensors"}})");
  EXPECT_TRUE(IsShardIndex(dir_ / kIndex));
  EXPECT_FALSE(IsShardIndex(dir_ / "a.safetensors"));
  EXPECT_EQ(ReadShardIndex(dir_ / kIndex).at("a.safetensors"), (std::set<std::string>{"x", "y"}));
  const auto file = SafetensorsFile::Open(dir_ / kIndex);
  EXPECT_EQ(file.tensors().size(), 3u);
  EXPECT_EQ(file.Values<int64_t>("x")[0] * 100 + file.Values<int64_t>("y")[0] * 10 + file.Values<int64_t>("z")[0], 123);
  EXPECT_EQ(file.metadata().at("format"), "pt");
}

TEST_F(ShardIndex, NoOtherFolderIsEverOpened) {
  WriteFileAtomically(dir_ / "in/c.safetensors", File({{"x", 1}}));
  for (const char* part :
       {R"("../a.safetensors")", R"("in/c.safetensors")", R"("/tmp/a.safetensors")", R"("in\\c.safetensors")",
        R"("..")", R"("")", R"(".safetensors")", R"("a.bin")", R"("a.safetensors\u0000.safetensors")", "7", "null",
        R"(["a.safetensors"])", R"(".hidden.safetensors")", R"("model.safetensors.index.json")"}) {
    EXPECT_THAT(Seeking(part), AllOf(HasSubstr(": seeks tensor \"x\" in "),
                                     EndsWith("expected the name of a .safetensors file beside it; get it again")))
        << part;
  }
}

TEST_F(ShardIndex, PartsThatDoNotMatchTheIndex) {
  EXPECT_THAT(Complaint(R"({"weight_map":{"z":"b.safetensors","w":"c.safetensors"}})"),
              EndsWith("the part \"c.safetensors\" is not beside it; get the missing part"));
  EXPECT_THAT(Seeking(R"("b.safetensors")"), HasSubstr("a.safetensors: holds tensor \"x\", which "));
  EXPECT_THAT(Complaint(R"({"weight_map":{"w":"b.safetensors"}})"), HasSubstr("b.safetensors: has no tensor \"w\""));
  WriteFileAtomically(dir_ / "b.safetensors", File({{"z", 3}}).substr(0, 20));
  EXPECT_THAT(Seeking(R"("a.safetensors")"), HasSubstr("b.safetensors: announces a header"));
}

TEST_F(ShardIndex, MalformedIndexes) {
  EXPECT_THAT(Complaint("{"), HasSubstr("the index is not valid JSON"));
  EXPECT_THAT(Complaint(R"({"weight_map":{"x":"a.safetensors","x":"b.safetensors"}})"), HasSubstr("names \"x\" twice"));
  for (const char* text : {"[]", "{}", R"({"weight_map":[]})", R"({"weight_map":null})"}) {
    EXPECT_THAT(Complaint(text), HasSubstr("has no weight_map")) << text;
  }
  EXPECT_THAT(Complaint(R"({"weight_map":{}})"), HasSubstr("its weight_map is empty"));
  EXPECT_THAT(Complaint(""), HasSubstr("the index is not valid JSON"));
  EXPECT_THROW(SafetensorsFile::Open(dir_ / ("none/" + kIndex)), InputError);
}

}  // namespace

}  // namespace oraclegs
