#include "oraclegs/formats/glb_file.h"

#include <algorithm>
#include <limits>

#include "oraclegs/core/error.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/formats/gltf_layout.h"
#include "oraclegs/formats/values.h"

namespace oraclegs {
namespace {

constexpr int64_t kMostInteger = int64_t{1} << 40;  // sums of a few stay within 64 bits
constexpr int64_t kMostStride = 252;                // bytes; the bound of glTF itself

/// Bytes of a number; 0 for an unknown type.
int NumberSize(int64_t type) {
  if (type == kGltfByte || type == kGltfUnsignedByte) return 1;
  if (type == kGltfShort || type == kGltfUnsignedShort) return 2;
  return type == kGltfFloat ? 4 : 0;
}

template <class T>
float LoadScaled(std::string_view bytes, size_t at, bool normalized) {
  const auto value = static_cast<float>(LoadLittle<T>(bytes, at));
  if (!normalized) return value;
  return std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.f);
}

float LoadGltfNumber(std::string_view bytes, size_t at, int type, bool normalized) {
  switch (type) {
    case kGltfByte:
      return LoadScaled<int8_t>(bytes, at, normalized);
    case kGltfUnsignedByte:
      return LoadScaled<uint8_t>(bytes, at, normalized);
    case kGltfShort:
      return LoadScaled<int16_t>(bytes, at, normalized);
    case kGltfUnsignedShort:
      return LoadScaled<uint16_t>(bytes, at, normalized);
    default:
      return LoadLittle<float>(bytes, at);
  }
}

}  // namespace

GlbFile::GlbFile(std::string_view bytes, std::string file) : file_(std::move(file)) {
  if (bytes.size() < kGlbHeader || LoadLittle<uint32_t>(bytes, 0) != kGlbMagic ||
      LoadLittle<uint32_t>(bytes, 4) != kGlbVersion) {
    throw InputError("{}: is not binary glTF of version 2; export it again", file_);
  }
  bool has_json = false;
  size_t at = kGlbHeader;
  while (bytes.size() - at >= kGlbChunkHeader) {
    const auto length = LoadLittle<uint32_t>(bytes, at), kind = LoadLittle<uint32_t>(bytes, at + 4);
    at += kGlbChunkHeader;
    if (length > bytes.size() - at) {
      throw InputError("{}: a chunk of it has {} bytes, and {} are left; copy it again", file_, length,
                       bytes.size() - at);
    }
    const std::string_view chunk = bytes.substr(at, length);
    if (kind == kGlbJsonChunk && !has_json) {
      json_ = ParseUniqueJson(chunk, file_, "the JSON chunk");
      has_json = true;
    } else if (kind == kGlbBinChunk && bin_.empty()) {
      bin_ = chunk;
    }
    at += length;
  }
  if (!has_json || !json_.is_object()) throw InputError("{}: has no JSON chunk; export it again", file_);
}

void GlbFile::Fail(const std::string& what) const { throw InputError("{}: {}; export it again", file_, what); }

const nlohmann::json& GlbFile::Item(const char* list, int64_t index) const {
  const auto found = json_.find(list);
  if (found == json_.end() || !found->is_array() || index < 0 || index >= static_cast<int64_t>(found->size()) ||
      !(*found)[index].is_object()) {
    Fail(fmt::format("has no item {} in '{}'", index, list));
  }
  return (*found)[index];
}

int64_t GlbFile::Integer(const nlohmann::json& object, const char* key, int64_t absent) const {
  const auto found = object.find(key);
  if (found == object.end()) return absent;
  if (!found->is_number_integer() || *found < 0 || *found > kMostInteger)
    Fail(fmt::format("'{}' is no valid number", key));
  return found->get<int64_t>();
}

std::string_view GlbFile::View(int64_t index) const {
  const nlohmann::json& view = Item("bufferViews", index);
  const nlohmann::json& buffer = Item("buffers", Integer(view, "buffer", -1));
  if (Integer(view, "buffer", -1) != 0 || buffer.contains("uri")) {
    Fail("keeps its numbers in another file, which is not read; pack it into one .glb");
  }
  const int64_t offset = Integer(view, "byteOffset", 0), length = Integer(view, "byteLength", -1);
  if (length < 0 || offset + length > static_cast<int64_t>(bin_.size())) {
    Fail(fmt::format("buffer view {} has bytes {} to {}, and the file holds {}", index, offset, offset + length,
                     bin_.size()));
  }
  return bin_.substr(offset, length);
}

GlbFile::Layout GlbFile::LayoutOf(int64_t index) const {
  const nlohmann::json& accessor = Item("accessors", index);
  if (accessor.contains("sparse")) Fail("has a sparse accessor, which is not read");
  const std::string type = accessor.value("type", nlohmann::json()).dump();
  Layout layout{};
  for (int n = 1; n <= 4; ++n) {
    if (type == (n == 1 ? "\"SCALAR\"" : fmt::format("\"VEC{}\"", n))) layout.components = n;
  }
  layout.type = static_cast<int>(Integer(accessor, "componentType", 0));
  layout.count = Integer(accessor, "count", 0);
  layout.normalized = accessor.value("normalized", nlohmann::json()) == true;
  const int64_t size = NumberSize(layout.type) * layout.components;
  if (size == 0) Fail(fmt::format("accessor {} has numbers of an unknown type", index));
  if (!accessor.contains("bufferView")) Fail(fmt::format("accessor {} has no bytes", index));
  const int64_t view = Integer(accessor, "bufferView", -1), offset = Integer(accessor, "byteOffset", 0);
  layout.bytes = View(view);
  const int64_t stride = Integer(Item("bufferViews", view), "byteStride", 0);
  layout.stride = stride == 0 ? size : stride;
  if (layout.stride < size || layout.stride > kMostStride) {
    Fail(fmt::format("items of accessor {} lie {} bytes apart, expected {} to {}", index, stride, size, kMostStride));
  }
  const auto bytes = static_cast<int64_t>(layout.bytes.size());
  // Divided and not multiplied: no count, however large, may overflow here.
  const bool fits =
      offset <= bytes &&
      (layout.count == 0 || (size <= bytes - offset && layout.count - 1 <= (bytes - offset - size) / layout.stride));
  if (!fits) Fail(fmt::format("accessor {} promises {} items, more than its bytes hold", index, layout.count));
  layout.bytes.remove_prefix(offset);
  return layout;
}

int64_t GlbFile::Count(int64_t accessor) const { return LayoutOf(accessor).count; }

std::vector<float> GlbFile::Floats(int64_t accessor, int components) const {
  const Layout layout = LayoutOf(accessor);
  if (layout.components != components) {
    Fail(fmt::format("accessor {} has {} numbers an item, expected {}", accessor, layout.components, components));
  }
  const int size = NumberSize(layout.type);
  std::vector<float> floats(static_cast<size_t>(layout.count * components));
  for (int64_t i = 0; i < layout.count; ++i) {
    for (int c = 0; c < components; ++c) {
      floats[i * components + c] =
          LoadGltfNumber(layout.bytes, i * layout.stride + c * size, layout.type, layout.normalized);
    }
  }
  return floats;
}

}  // namespace oraclegs
