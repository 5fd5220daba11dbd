#include "oraclegs/weights/checkpoint/published_checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"
#include "support/errors.h"
#include "support/temp_dir.h"
#include "torch_bytes.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using namespace torch_bytes;  // NOLINT: files and pieces of pickles

std::string OneTensor(const std::string& name, float value) {
  return ZipFile(Dict({{name, Vector("0", 1)}}), {{"0", Floats({value})}});
}
std::string OneSafetensor(const std::string& name, float value) {
  const std::string bytes = Floats({value});
  return SerializeSafetensors({{name, {"F32", {1}, bytes}}}, {});
}
float Only(const StoredTensor& tensor) {
  float value = 0;
  EXPECT_EQ(tensor.bytes.size(), sizeof value);
  std::memcpy(&value, tensor.bytes.data(), sizeof value);
  return value;
}

class ReadPublishedCheckpointTest : public testing::Test {
 protected:
  std::string ErrorOf(const std::string& name) {
    return MessageOf<InputError>([&] { ReadPublishedCheckpoint(dir_ / name, ""); });
  }
  TempDir dir_;
};

TEST_F(ReadPublishedCheckpointTest, LooksAtTheContentNotTheName) {
  WriteFileAtomically(dir_ / "zip.bin", OneTensor("module.a", 1));
  WriteFileAtomically(dir_ / "legacy.safetensors", LegacyFile(Dict({{"a", Vector("0", 1)}}), {{"0", Floats({1})}}));
  WriteFileAtomically(dir_ / "safe.pth", OneSafetensor("module.a", 1));
  for (const char* name : {"zip.bin", "legacy.safetensors", "safe.pth"}) {
    const PublishedCheckpoint checkpoint = ReadPublishedCheckpoint(dir_ / name, "");
    ASSERT_EQ(checkpoint.tensors.count("a"), 1u) << name;
    EXPECT_EQ(Only(checkpoint.tensors.at("a")), 1) << name;
    EXPECT_GT(checkpoint.bytes, 0u);
  }
}

TEST_F(ReadPublishedCheckpointTest, ReadsParts) {
  WriteFileAtomically(dir_ / "a.bin", OneTensor("a", 1));
  WriteFileAtomically(dir_ / "b.bin", OneTensor("b", 2));
  WriteFileAtomically(dir_ / "pytorch_model.bin.index.json", R"({"weight_map":{"a":"a.bin","b":"b.bin"}})");
  WriteFileAtomically(dir_ / "a.safetensors", OneSafetensor("a", 1));
  WriteFileAtomically(dir_ / "b.safetensors", OneSafetensor("b", 2));
  WriteFileAtomically(dir_ / "m.safetensors.index.json", R"({"weight_map":{"a":"a.safetensors","b":"b.safetensors"}})");
  for (const char* name : {"pytorch_model.bin.index.json", "m.safetensors.index.json"}) {
    const PublishedCheckpoint checkpoint = ReadPublishedCheckpoint(dir_ / name, "");
    ASSERT_EQ(checkpoint.tensors.size(), 2u);
    EXPECT_EQ(Only(checkpoint.tensors.at("a")), 1);
    EXPECT_EQ(Only(checkpoint.tensors.at("b")), 2);
  }
}

TEST_F(ReadPublishedCheckpointTest, ComparesPartsWithTheirIndex) {
  WriteFileAtomically(dir_ / "a.bin", OneTensor("a", 1));
  const auto with = [&](const std::string& map) {
    WriteFileAtomically(dir_ / "m.bin.index.json", R"({"weight_map":)" + map + "}");
    return ErrorOf("m.bin.index.json");
  };
  EXPECT_EQ(with(R"({"a":"a.bin"})"), "");
  EXPECT_THAT(with(R"({"a":"b.bin"})"), EndsWith("the part 'b.bin' is not beside it; get the missing part"));
  EXPECT_THAT(with(R"({"a":"../a.bin"})"), HasSubstr("expected the name of a .bin file beside it"));
  EXPECT_THAT(with(R"({"x":"a.bin"})"),
              AllOf(HasSubstr("a.bin: holds tensor 'a', which "), HasSubstr("m.bin.index.json")));
  EXPECT_THAT(with(R"({"a":"a.bin","x":"a.bin"})"), HasSubstr("a.bin: lacks tensor 'x', which "));
}

TEST_F(ReadPublishedCheckpointTest, RefusesForeignFiles) {
  EXPECT_THAT(ErrorOf("none.pth"), EndsWith("none.pth: cannot open: No such file or directory"));
  WriteFileAtomically(dir_ / "page.pth", "<html>not found</html>");
  EXPECT_THAT(ErrorOf("page.pth"),
              EndsWith("is neither a checkpoint of PyTorch nor a safetensors file; name the published file"));
  WriteFileAtomically(dir_ / "none.safetensors", SerializeSafetensors({}, {{"a", "b"}}));
  EXPECT_THAT(ErrorOf("none.safetensors"), HasSubstr("holds no tensor"));
}

}  // namespace
}  // namespace oraclegs
