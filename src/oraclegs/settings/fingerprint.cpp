#include "oraclegs/settings/fingerprint.h"

#include <algorithm>
#include <cstring>

#include "oraclegs/core/file_facts.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

namespace fs = std::filesystem;

Fingerprint& Fingerprint::Add(std::string_view bytes) {
  // The length ends the item, so that ("ab", "c") differs from ("a", "bc").
  char length[8];
  for (uint64_t rest = bytes.size(), i = 0; i < 8; ++i, rest >>= 8) length[i] = static_cast<char>(rest & 0xff);
  hash_.Add(bytes).Add({length, sizeof(length)});
  return *this;
}

Fingerprint& Fingerprint::Add(double value) {
  char bytes[sizeof(value)];
  std::memcpy(bytes, &value, sizeof(value));
  return Add(std::string_view(bytes, sizeof(bytes)));
}

Fingerprint& Fingerprint::AddFile(const fs::path& path) { return Add(ReadFile(path)); }

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

void FileHashes::Read(const std::vector<fs::path>& files) {
  std::vector<fs::path> missing;
  for (const fs::path& file : files) {
    if (known_.count(file) == 0) missing.push_back(file);
  }
  std::vector<std::string> hashes(missing.size());
  ParallelFor(static_cast<int64_t>(missing.size()), [&](int64_t i) {
    const auto f = static_cast<size_t>(i);
    hashes[f] = DigestOf(missing[f]).sha256;
  });
  for (size_t f = 0; f < missing.size(); ++f) known_[missing[f]] = std::move(hashes[f]);
}

const std::string& FileHashes::Of(const fs::path& file) {
  Read({file});
  return known_.at(file);
}

std::string FileHashes::OfAll(const std::vector<fs::path>& files) {
  if (files.empty()) return "";
  Read(files);
  Fingerprint print;
  for (const fs::path& file : files) print.Add(Of(file));
  return print.Hex();
}

std::string ViewsFingerprint(const Scene& scene, const std::vector<int>& views, const ImageOptions& images,
                             FileHashes* files) {
  std::vector<fs::path> read;
  for (const int v : views) {
    const SceneView& view = scene.views[static_cast<size_t>(v)];
    read.push_back(ImageFile(view, images));
    if (!view.mask_path.empty()) read.push_back(view.mask_path);
  }
  files->Read(read);
  Fingerprint print;
  print.Add(static_cast<double>(scene.format));  // decides the meaning of an alpha channel
  auto next = read.begin();
  for (const int v : views) {
    const SceneView& view = scene.views[static_cast<size_t>(v)];
    print.Add(view.name).Add(view.as_stored).Add(files->Of(*next++));
    print.Add(view.mask_path.empty() ? "" : files->Of(*next++));
    print.Add(CameraModelName(view.intrinsics.model)).Add(view.intrinsics.width).Add(view.intrinsics.height);
    print.Add(static_cast<double>(view.intrinsics.params.size()));
    for (const double p : view.intrinsics.params) print.Add(p);
    print.Add(view.cam_from_world.has_value());
    if (!view.cam_from_world) continue;
    const Eigen::Matrix4d m = view.cam_from_world->matrix();
    for (int k = 0; k < 16; ++k) print.Add(m(k / 4, k % 4));
  }
  return print.Hex();
}

}  // namespace oraclegs
