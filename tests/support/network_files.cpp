#include "support/network_files.h"

#include <fmt/format.h>

#include "oraclegs/core/config.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// A new file each time, as a download makes it: a network that still maps the old one keeps it.
fs::path Copy(const fs::path& made, const fs::path& to) {
  WriteFileAtomically(to, ReadFile(fs::path(ORACLEGS_TINY_NETWORKS_DIR) / made));
  return to;
}

void CopyModels(const fs::path& models, std::initializer_list<const char*> names) {
  for (const char* name : names)
    Copy(fs::path("models") / name / "model.safetensors", models / name / "model.safetensors");
}

}  // namespace

bool HasNetworks() {
#if defined(ORACLEGS_NETWORKS)
  return true;
#else
  return false;
#endif
}

fs::path WriteTinyDepthAnything(const fs::path& path, uint64_t seed) {
  return Copy(fmt::format("variants/depth_anything_{}.safetensors", seed), path);
}

fs::path WriteTinyLpips(const fs::path& path, uint64_t seed) {
  return Copy(fmt::format("variants/lpips_{}.safetensors", seed), path);
}

fs::path WriteTinyAlexNetLpips(const fs::path& path) { return Copy("variants/lpips_alex.safetensors", path); }

fs::path WriteTinyAliked(const fs::path& path) { return Copy("variants/aliked.safetensors", path); }

void WriteTinySeva(const fs::path& models) { CopyModels(models, {"seva", "sd21-vae", "openclip-vith14"}); }

void WriteTinyNetworks(const fs::path& models) {
  WriteTinySeva(models);
  CopyModels(models, {"vggt", "depth-anything-v2-small", "lpips-vgg"});
}

fs::path WriteLargeWeights(const fs::path& path) {
  constexpr uintmax_t kBytes = 1'200'000'000;
  std::string header =
      fmt::format(R"({{"x":{{"dtype":"F32","shape":[{}],"data_offsets":[0,{}]}}}})", kBytes / 4, kBytes);
  header.resize((header.size() + 7) / 8 * 8, ' ');
  const uint64_t length = header.size();
  WriteFileAtomically(path, std::string(reinterpret_cast<const char*>(&length), sizeof(length)) + header);
  fs::resize_file(path, sizeof(length) + header.size() + kBytes);
  return path;
}

fs::path WriteTinyVggt(const fs::path& path, const std::function<void(TinyVggtParts*)>& change) {
  const SafetensorsFile golden = OpenGolden("vggt_tiny");
  const std::string prefix = "weights.";
  TinyVggtParts parts{{}, golden.metadata()};
  for (const auto& [name, entry] : golden.tensors()) {
    if (name.starts_with(prefix)) parts.tensors[name.substr(prefix.size())] = entry;
  }
  change(&parts);
  WriteFileAtomically(path, SerializeSafetensors(parts.tensors, parts.metadata));
  return path;
}

}  // namespace oraclegs
