// glTF: a .glb as it is, or its JSON and its bytes as two parts, the second packed by gzip where the JSON names SPZ.

#include "fuzz/fuzz.h"
#include "oraclegs/formats/codecs.h"

namespace {

std::string GlbOf(std::string_view json, std::string_view bin) {
  using oraclegs::fuzz::Little;
  std::string text(json), data(bin);
  if (json.find("spz") != std::string_view::npos && !bin.starts_with("\x1f\x8b")) {
    data = oraclegs::fuzz::StoredGzip(bin);
  }
  while (text.size() % 4 != 0) text += ' ';
  while (data.size() % 4 != 0) data += '\0';
  return "glTF" + Little(2, 4) + Little(28 + text.size() + data.size(), 4) + Little(text.size(), 4) + "JSON" + text +
         Little(data.size(), 4) + std::string("BIN\0", 4) + data;
}

}  // namespace

ORACLEGS_FUZZ_TARGET(gltf) {
  using namespace oraclegs;
  const auto parts = fuzz::Parts(bytes);
  const std::string file = bytes.starts_with("glTF") ? std::string(bytes) : GlbOf(parts[0], fuzz::PartAt(parts, 1));
  fuzz::Try([&] { DecodeGltf(file, "f"); });
}
