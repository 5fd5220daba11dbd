#include "oraclegs/pipeline/workspace/fingerprint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

Fingerprint& Fingerprint::Add(std::string_view bytes) {
  constexpr uint64_t kPrime = 0x100000001b3ull;
  for (const char c : bytes) hash_ = (hash_ ^ static_cast<uint8_t>(c)) * kPrime;
  // The length ends the item, so that ("ab", "c") differs from ("a", "bc").
  for (uint64_t length = bytes.size(), i = 0; i < 8; ++i, length >>= 8) hash_ = (hash_ ^ (length & 0xff)) * kPrime;
  return *this;
}

Fingerprint& Fingerprint::Add(double value) {
  char bytes[sizeof(value)];
  std::memcpy(bytes, &value, sizeof(value));
  return Add(std::string_view(bytes, sizeof(bytes)));
}

Fingerprint& Fingerprint::AddFile(const std::filesystem::path& path) { return Add(ReadFile(path)); }

Fingerprint& Fingerprint::AddTensors(const SafetensorsFile& file) {
  constexpr size_t kSampled = 64;
  for (const auto& [key, value] : file.metadata()) Add(key).Add(value);
  for (const auto& [tensor, entry] : file.tensors()) {
    Add(tensor).Add(entry.dtype);
    for (const int64_t size : entry.shape) Add(static_cast<double>(size));
    const size_t sampled = std::min(kSampled, entry.bytes.size());
    Add(entry.bytes.substr(0, sampled)).Add(entry.bytes.substr(entry.bytes.size() - sampled));
  }
  return *this;
}

std::string Fingerprint::Hex() const { return fmt::format("{:016x}", hash_); }

std::string FileFingerprint(const std::filesystem::path& path) { return Fingerprint().AddFile(path).Hex(); }

std::string ViewsFingerprint(const Scene& scene, const std::vector<int>& views, int downscale) {
  std::vector<std::string> parts(views.size());
  ParallelFor(static_cast<int64_t>(views.size()), [&](int64_t i) {
    const SceneView& view = scene.views[static_cast<size_t>(views[static_cast<size_t>(i)])];
    Fingerprint print;
    print.Add(view.name).Add(view.as_stored).AddFile(ImageFile(view, downscale));
    if (!view.mask_path.empty()) print.AddFile(view.mask_path);
    print.Add(CameraModelName(view.lens.model)).Add(view.lens.width).Add(view.lens.height);
    for (const double p : view.lens.params) print.Add(p);
    if (view.cam_from_world) {
      const Eigen::Matrix4d m = view.cam_from_world->matrix();
      for (int k = 0; k < 16; ++k) print.Add(m(k / 4, k % 4));
    }
    parts[static_cast<size_t>(i)] = print.Hex();
  });
  Fingerprint all;
  all.Add(static_cast<double>(scene.format));  // it says what an alpha channel means
  for (const std::string& part : parts) all.Add(part);
  return all.Hex();
}

}  // namespace oraclegs
