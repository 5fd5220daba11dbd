#include "oraclegs/core/safetensors.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/golden.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

template <class T>
std::string_view BytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A file made by hand: the length field, the header, `data_bytes` zeros.
std::string Raw(const std::string& header, size_t data_bytes, int64_t length_error = 0) {
  const uint64_t length = header.size() + static_cast<uint64_t>(length_error);
  std::string out(8, '\0');
  std::memcpy(out.data(), &length, 8);
  return out + header + std::string(data_bytes, '\0');
}

std::string OneTensor(const std::string& dtype, const std::string& shape, const std::string& offsets) {
  return R"({"t":{"dtype":")" + dtype + R"(","shape":)" + shape + R"(,"data_offsets":)" + offsets + "}}";
}

/// The one-line message that parsing `bytes` ends with.
std::string Complaint(const std::string& bytes) {
  try {
    SafetensorsFile::Parse(bytes, "file.st");
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(StartsWith("file.st: "), Not(HasSubstr("\n"))));
    return error.what();
  }
  return "";
}

TEST(Safetensors, RoundTripKeepsEveryBit) {
  const std::vector<float> f = {1.5f, -0.f, std::numeric_limits<float>::infinity(), 1e-40f, 0.1f, 7};
  const std::vector<double> d = {0.1};
  const std::vector<int64_t> i = {-5, std::numeric_limits<int64_t>::max()};
  const std::vector<uint8_t> u = {0, 255, 3};
  const std::string bytes = SerializeSafetensors({{"f", {"F32", {2, 3}, BytesOf(f)}},
                                                  {"d", {"F64", {}, BytesOf(d)}},
                                                  {"i", {"I64", {2, 1}, BytesOf(i)}},
                                                  {"u", {"U8", {3}, BytesOf(u)}},
                                                  {"a \"name\"\n", {"F16", {0, 4}, {}}}},
                                                 {{"format", "7"}, {"note", "a\nb"}});
  const TempDir dir;
  WriteFileAtomically(dir / "file.st", bytes);
  for (const auto& file : {SafetensorsFile::Parse(bytes, "memory"), SafetensorsFile::Open(dir / "file.st")}) {
    EXPECT_EQ(file.tensors().size(), 5u);
    EXPECT_EQ(file.Get("f").bytes, BytesOf(f));
    EXPECT_THAT(file.Get("f").shape, ElementsAre(2, 3));
    EXPECT_EQ(file.Get("f").numel(), 6);
    EXPECT_EQ(file.Get("d").numel(), 1);
    EXPECT_EQ(file.Values<double>("d"), d);
    EXPECT_EQ(file.Values<int64_t>("i"), i);
    EXPECT_EQ(file.Values<uint8_t>("u"), u);
    EXPECT_EQ(file.Get("a \"name\"\n").numel(), 0);
    EXPECT_EQ(file.metadata(), (std::map<std::string, std::string>{{"format", "7"}, {"note", "a\nb"}}));
  }
}

TEST(Safetensors, EveryTensorIsAlignedToItsElement) {
  const std::vector<uint8_t> u = {1, 2, 3};
  const std::vector<double> d = {1, 2};
  const std::vector<float> f = {1};
  const auto file = SafetensorsFile::Parse(
      SerializeSafetensors(
          {{"a", {"U8", {3}, BytesOf(u)}}, {"b", {"F32", {1}, BytesOf(f)}}, {"c", {"F64", {2}, BytesOf(d)}}}, {}),
      "memory");
  const char* base = file.Get("c").bytes.data();
  EXPECT_EQ(file.Get("b").bytes.data() - base, 16);
  EXPECT_EQ(file.Get("a").bytes.data() - base, 20);
}

TEST(Safetensors, TheSameContentGivesTheSameBytes) {
  const std::vector<float> f = {1};
  const std::map<std::string, TensorEntry> tensors = {{"f", {"F32", {1}, BytesOf(f)}}};
  const std::string expected = R"({"f":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})";
  const std::string bytes = SerializeSafetensors(tensors, {});
  EXPECT_EQ(bytes.substr(8, expected.size()), expected);
  EXPECT_EQ((bytes.size() - 4) % 8, 0u);
}

TEST(Safetensors, ValuesConvert) {
  const std::vector<float> f = {1, -2, 3};
  const std::vector<int32_t> i = {4, -5};
  const auto file = SafetensorsFile::Parse(
      SerializeSafetensors({{"f", {"F32", {3}, BytesOf(f)}}, {"i", {"I32", {2}, BytesOf(i)}}}, {}), "memory");
  EXPECT_THAT(file.Values<double>("f"), ElementsAre(1, -2, 3));
  EXPECT_THAT(file.Values<int64_t>("f"), ElementsAre(1, -2, 3));
  EXPECT_THAT(file.Values<int32_t>("f"), ElementsAre(1, -2, 3));
  EXPECT_THAT(file.Values<float>("i"), ElementsAre(4, -5));
}

TEST(Safetensors, NumbersThatDoNotFitAreRefused) {
  const std::vector<float> wild = {std::nanf("")}, big = {3e9f}, minus = {-1}, edge = {9223372036854775808.f};
  const std::vector<int64_t> large = {int64_t{1} << 40};
  const std::vector<uint16_t> words = {0x3c00};
  const std::map<std::string, TensorEntry> tensors = {
      {"wild", {"F32", {1}, BytesOf(wild)}},   {"big", {"F32", {1}, BytesOf(big)}},
      {"minus", {"F32", {1}, BytesOf(minus)}}, {"edge", {"F32", {1}, BytesOf(edge)}},
      {"large", {"I64", {1}, BytesOf(large)}}, {"words", {"U16", {1}, BytesOf(words)}}};
  const auto file = SafetensorsFile::Parse(SerializeSafetensors(tensors, {}), "memory");
  EXPECT_TRUE(std::isnan(file.Values<float>("wild")[0]));
  EXPECT_THROW(file.Values<int64_t>("wild"), InputError);
  EXPECT_THROW(file.Values<int32_t>("big"), InputError);
  EXPECT_THROW(file.Values<uint8_t>("minus"), InputError);
  EXPECT_THROW(file.Values<int64_t>("edge"), InputError);
  EXPECT_THROW(file.Values<int32_t>("large"), InputError);
  EXPECT_THAT([&] { file.Values<float>("words"); }, ThrowsMessage<InputError>(HasSubstr("tensor \"words\" is U16")));
}

TEST(Safetensors, HalfPrecisionIsReadExactly) {
  const std::vector<uint16_t> f16 = {0x3c00, 0xc000, 0x3555, 0x7bff, 0x0400, 0x0001, 0x8000, 0x7c00, 0x7e00};
  const std::vector<uint16_t> bf16 = {0x3f80, 0xc000, 0x3eab, 0x7f80, 0x0001};
  const auto file = SafetensorsFile::Parse(
      SerializeSafetensors({{"f16", {"F16", {9}, BytesOf(f16)}}, {"bf16", {"BF16", {5}, BytesOf(bf16)}}}, {}),
      "memory");
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<float> half = file.Values<float>("f16");
  EXPECT_EQ((std::vector<float>(half.begin(), half.end() - 1)),
            (std::vector<float>{1, -2, 0.333251953125f, 65504, 0x1p-14f, 0x1p-24f, -0.f, infinity}));
  EXPECT_TRUE(std::signbit(half[6]));
  EXPECT_TRUE(std::isnan(half[8]));
  EXPECT_THAT(file.Values<float>("bf16"), ElementsAre(1, -2, 0.333984375f, infinity, 0x1p-133f));
  EXPECT_THROW(file.Values<int32_t>("f16"), InputError);
}

TEST(Safetensors, MissingTensorIsNamed) {
  const auto file = SafetensorsFile::Parse(Raw("{}", 0), "file.st");
  EXPECT_FALSE(file.Has("means"));
  EXPECT_THAT([&] { file.Get("means"); }, ThrowsMessage<InputError>(StartsWith("file.st: has no tensor \"means\"")));
}

TEST(Safetensors, SerializeRefusesWhatIsNotAFile) {
  const std::vector<float> f = {1};
  EXPECT_THROW(SerializeSafetensors({{"f", {"F32", {2}, BytesOf(f)}}}, {}), std::logic_error);
  EXPECT_THROW(SerializeSafetensors({{"f", {"F32", {-1}, BytesOf(f)}}}, {}), std::logic_error);
  EXPECT_THROW(SerializeSafetensors({{"f", {"F99", {1}, BytesOf(f)}}}, {}), std::logic_error);
  EXPECT_THROW(SerializeSafetensors({{"__metadata__", {"F32", {1}, BytesOf(f)}}}, {}), std::logic_error);
}

TEST(SafetensorsBadInput, FilesThatAreNone) {
  const TempDir dir;
  EXPECT_THAT([&] { SafetensorsFile::Open(dir / "none"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("none"), HasSubstr("No such file"))));
  EXPECT_THROW(SafetensorsFile::Open(dir.path()), InputError);
  WriteFileAtomically(dir / "empty", "");
  EXPECT_THAT([&] { SafetensorsFile::Open(dir / "empty"); }, ThrowsMessage<InputError>(HasSubstr("is empty")));
}

TEST(SafetensorsBadInput, EveryPrefixOfAFileIsRefused) {
  const std::vector<float> f = {1, 2};
  const std::string bytes = SerializeSafetensors({{"f", {"F32", {2}, BytesOf(f)}}}, {{"key", "value"}});
  ASSERT_EQ(Complaint(bytes), "");
  for (size_t size = 0; size < bytes.size(); ++size) EXPECT_NE(Complaint(bytes.substr(0, size)), "") << size;
  EXPECT_THAT(Complaint(bytes + "x"), HasSubstr("1 bytes after its last tensor"));
}

TEST(SafetensorsBadInput, EveryFlippedHeaderByteIsReadOrRefused) {
  const std::vector<float> f = {1, 2};
  const std::string good = SerializeSafetensors({{"f", {"F32", {2}, BytesOf(f)}}}, {{"key", "value"}});
  for (size_t i = 0; i + BytesOf(f).size() < good.size(); ++i) {
    for (const int flip : {0x01, 0x04, 0x20, 0x80, 0xff}) {
      std::string bytes = good;
      bytes[i] = static_cast<char>(bytes[i] ^ flip);
      Complaint(bytes);  // checks the message; anything but an InputError fails the test
    }
  }
}

TEST(SafetensorsBadInput, LyingHeaderLength) {
  const std::string header = OneTensor("F32", "[1]", "[0,4]");
  ASSERT_EQ(Complaint(Raw(header, 4)), "");
  EXPECT_NE(Complaint(Raw(header, 4, -1)), "");
  EXPECT_NE(Complaint(Raw(header, 4, 1)), "");
  EXPECT_THAT(Complaint(Raw(header, 4, 5)), HasSubstr("announces a header of"));
  EXPECT_THAT(Complaint(Raw(header, 4, int64_t{1} << 40)), HasSubstr("announces a header of"));
  EXPECT_THAT(Complaint(Raw("", 100, -1)), HasSubstr("announces a header of 18446744073709551615 bytes"));
  EXPECT_NE(Complaint(Raw("", 100)), "");
}

TEST(SafetensorsBadInput, HugeHeaderIsRefusedBeforeItIsRead) {
  EXPECT_THAT(Complaint(Raw(std::string(100'000'001, ' '), 0)), HasSubstr("announces a header of 100000001"));
}

TEST(SafetensorsBadInput, HeaderThatIsNotTheRightJson) {
  EXPECT_THAT(Complaint(Raw("{\"a\":", 0)), HasSubstr("not valid JSON"));
  EXPECT_THAT(Complaint(Raw("{\"\xff\":1}", 0)), HasSubstr("not valid JSON"));
  EXPECT_THAT(Complaint(Raw("[]", 0)), HasSubstr("not a JSON object"));
  EXPECT_THAT(Complaint(Raw("7", 0)), HasSubstr("not a JSON object"));
  EXPECT_THAT(Complaint(Raw("{\"t\":7}", 0)), HasSubstr("tensor \"t\" lacks"));
  EXPECT_THAT(Complaint(Raw(R"({"t":{"dtype":"F32","shape":[]}})", 0)), HasSubstr("tensor \"t\" lacks"));
  EXPECT_THAT(Complaint(Raw(R"({"__metadata__":7})", 0)), HasSubstr("__metadata__ is not"));
  EXPECT_THAT(Complaint(Raw(R"({"__metadata__":{"a":7}})", 0)), HasSubstr("metadata \"a\" is not a text"));
  EXPECT_NE(Complaint(Raw(std::string(1'000'000, '['), 0)), "");
  EXPECT_NE(Complaint(Raw("{\"a\\nb\":7}", 0)), "");  // a line break in a name must not break the message's line
}

TEST(SafetensorsBadInput, DuplicateKeys) {
  const std::string tensor = R"({"dtype":"U8","shape":[1],"data_offsets":[0,1]})";
  EXPECT_THAT(Complaint(Raw(R"({"t":)" + tensor + R"(,"t":)" + tensor + "}", 1)), HasSubstr("names \"t\" twice"));
  EXPECT_THAT(Complaint(Raw(R"({"t":{"dtype":"U8","dtype":"U8","shape":[1],"data_offsets":[0,1]}})", 1)),
              HasSubstr("names \"dtype\" twice"));
}

TEST(SafetensorsBadInput, OffsetsOutOfRange) {
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[2]", "[0,8]"), 4)), HasSubstr("outside the file's 4 data bytes"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[1]", "[4,0]"), 4)), HasSubstr("outside"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[1]", "[-4,0]"), 4)), HasSubstr("outside"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[1]", "[0.0,4.0]"), 4)), HasSubstr("outside"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[1]", "[18446744073709551612,18446744073709551615]"), 4)),
              HasSubstr("outside"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[1]", "[0,4,8]"), 4)), HasSubstr("lacks"));
}

TEST(SafetensorsBadInput, GapsAndOverlaps) {
  EXPECT_THAT(Complaint(Raw(OneTensor("U8", "[1]", "[1,2]"), 2)), HasSubstr("begins at data byte 1, expected 0"));
  EXPECT_THAT(Complaint(Raw(R"({"a":{"dtype":"U8","shape":[3],"data_offsets":[0,3]},)"
                            R"("b":{"dtype":"U8","shape":[2],"data_offsets":[2,4]}})",
                            4)),
              HasSubstr("tensor \"b\" begins at data byte 2, expected 3"));
}

TEST(SafetensorsBadInput, ShapesThatAreNone) {
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[-1]", "[0,4]"), 4)), HasSubstr("no count"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[1.0]", "[0,4]"), 4)), HasSubstr("no count"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[\"1\"]", "[0,4]"), 4)), HasSubstr("no count"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[9223372036854775808]", "[0,4]"), 4)), HasSubstr("no count"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[1e400]", "[0,4]"), 4)), HasSubstr("not valid JSON"));
}

TEST(SafetensorsBadInput, BytesThatDisagreeWithShapeOrDtype) {
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[2]", "[0,4]"), 4)),
              HasSubstr("has 4 bytes, which its shape [2] of F32"));
  EXPECT_THAT(Complaint(Raw(OneTensor("F64", "[1]", "[0,4]"), 4)), HasSubstr("disagrees"));
  EXPECT_THAT(Complaint(Raw(OneTensor("Q4", "[1]", "[0,4]"), 4)), HasSubstr("unknown dtype \"Q4\""));
  // 2^62 * 4 wraps round to 0 in 64 bits.
  EXPECT_THAT(Complaint(Raw(OneTensor("F32", "[4611686018427387904]", "[0,0]"), 0)), HasSubstr("disagrees"));
  EXPECT_THAT(Complaint(Raw(OneTensor("U8", "[4294967296,4294967296]", "[0,0]"), 0)), HasSubstr("disagrees"));
}

TEST(SafetensorsGolden, EveryFixtureOpens) {
  for (const auto& entry : std::filesystem::directory_iterator(GoldenDir())) {
    if (entry.path().extension() != ".safetensors") continue;
    const auto file = SafetensorsFile::Open(entry.path());
    EXPECT_FALSE(file.tensors().empty()) << entry.path();
    for (const auto& [name, tensor] : file.tensors()) {
      EXPECT_EQ(file.Values<double>(name).size(), static_cast<size_t>(tensor.numel())) << entry.path() << " " << name;
    }
  }
}

}  // namespace
}  // namespace oraclegs
