#include "oraclegs/formats/glb_file.h"

#include "formats/glb_edit.h"
#include "formats/splats.h"
#include "oraclegs/formats/codecs.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

std::string Edited(const std::function<void(nlohmann::json&)>& edit) {
  return EditGlb(EncodeGltf(PlausibleGaussians(6), 0), edit);
}

TEST(GlbFile, ReadsNormalizedIntegersWithAStride) {
  std::string bytes = Edited([](nlohmann::json& json) {
    json["accessors"][0] = {
        {"componentType", 5122}, {"type", "VEC2"}, {"count", 3}, {"bufferView", 0}, {"byteOffset", 2}};
    json["bufferViews"][0]["byteStride"] = 8;
    json["accessors"][1] = json["accessors"][0];
    json["accessors"][1]["normalized"] = true;
  });
  const size_t bin = bytes.find("BIN") + 4;
  StoreLittle(bytes.data() + bin + 8 + 2, int16_t{-32768});
  StoreLittle(bytes.data() + bin + 8 + 4, int16_t{32767});
  const GlbFile glb(bytes, "x.glb");
  EXPECT_EQ(glb.Floats(0, 2)[2], -32768);
  EXPECT_EQ(glb.Floats(1, 2)[2], -1);
  EXPECT_EQ(glb.Floats(1, 2)[3], 1);
}

TEST(GlbFile, RefusesWhatLeavesTheFile) {
  const std::string good = EncodeGltf(PlausibleGaussians(6), 0);
  const auto open = [](const std::string& bytes) {
    return MessageOf<InputError>([&] { GlbFile(bytes, "x.glb").Floats(0, 3); });
  };
  EXPECT_THAT(open("glTF"), HasSubstr("x.glb: is not binary glTF"));
  EXPECT_THAT(open(good.substr(0, good.size() - 4)), HasSubstr("a chunk of it has"));
  EXPECT_THAT(open(good.substr(0, 12)), HasSubstr("has no JSON chunk"));
  const auto edited = [&](const char* path, nlohmann::json value) {
    return open(Edited([&](nlohmann::json& json) { json[nlohmann::json::json_pointer(path)] = std::move(value); }));
  };
  EXPECT_THAT(edited("/bufferViews/0/byteLength", 1 << 30), HasSubstr("and the file holds"));
  EXPECT_THAT(edited("/bufferViews/0/byteOffset", -1), HasSubstr("'byteOffset' is no valid number"));
  EXPECT_THAT(edited("/bufferViews/0/byteOffset", 1e300), HasSubstr("'byteOffset' is no valid number"));
  EXPECT_THAT(edited("/bufferViews/0/byteStride", 2), HasSubstr("2 bytes apart, expected 12 to 252"));
  EXPECT_THAT(edited("/bufferViews/0/byteStride", 253), HasSubstr("253 bytes apart"));
  EXPECT_THAT(edited("/bufferViews/0/byteStride", 1099511627776), HasSubstr("1099511627776 bytes apart"));
  EXPECT_THAT(edited("/bufferViews/0/byteStride", 16), HasSubstr("promises 6 items"));
  EXPECT_THAT(edited("/accessors/0/byteOffset", 73), HasSubstr("promises 6 items"));
  EXPECT_THAT(edited("/accessors/0/componentType", 5), HasSubstr("unknown type"));
  EXPECT_THAT(edited("/accessors/0/type", 5), HasSubstr("unknown type"));
  EXPECT_THAT(edited("/buffers/0/uri", "a.bin"), HasSubstr("another file"));
}

TEST(GlbFile, AStrideTimesACountCannotOverflow) {
  const uint32_t count = 8388609;  // 2^40 times one less is 2^63
  std::string bytes = Edited([&](nlohmann::json& json) {
    json["accessors"][0] = {{"componentType", 5121}, {"type", "SCALAR"}, {"count", count}, {"bufferView", 0}};
    json["bufferViews"][0] = {{"buffer", 0}, {"byteLength", count}, {"byteStride", 1099511627776}};
  });
  const size_t bin = bytes.find("BIN") - 4;  // where the length of that chunk stands
  bytes.resize(bin + 8 + count + 3);
  StoreLittle(bytes.data() + bin, count + 3);
  EXPECT_THAT(MessageOf<InputError>([&] { GlbFile(bytes, "x.glb").Floats(0, 1); }), HasSubstr("bytes apart"));
}

TEST(GlbFile, AStrideOfZeroMeansNoGaps) {
  const std::string bytes = Edited([](nlohmann::json& json) { json["bufferViews"][0]["byteStride"] = 0; });
  EXPECT_EQ(GlbFile(bytes, "x.glb").Floats(0, 3), GlbFile(Edited([](nlohmann::json&) {}), "x.glb").Floats(0, 3));
}

}  // namespace
}  // namespace oraclegs
