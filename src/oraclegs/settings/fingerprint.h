#pragma once
// Short names of everything a stage's result depends on: the same name, the same result.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/safetensors.h"
#include "oraclegs/core/sha256.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// SHA-256 of a list of items.
class Fingerprint {
 public:
  Fingerprint& Add(std::string_view bytes);
  Fingerprint& Add(double value);
  /// The content of a file. Throws InputError naming it.
  Fingerprint& AddFile(const std::filesystem::path& path);
  /// Metadata, names, types and shapes of a file of weights, and 64 bytes at each end of each tensor: gigabytes would
  /// be read for nothing else.
  Fingerprint& AddTensors(const SafetensorsFile& file);
  std::string Hex() const { return hash_.Hex(); }

 private:
  Sha256 hash_;
};

/// Hashes of the content of files that a run does not write: each is read once.
class FileHashes {
 public:
  /// Reads those not yet known, on all threads. Throws InputError naming a file that cannot be read.
  void Read(const std::vector<std::filesystem::path>& files);
  const std::string& Of(const std::filesystem::path& file);
  /// Of all of them; "" for none.
  std::string OfAll(const std::vector<std::filesystem::path>& files);

 private:
  std::map<std::filesystem::path, std::string> known_;
};

/// The scene's format, and of these views names, images (the files that LoadViews opens with these options), masks,
/// intrinsics and poses.
std::string ViewsFingerprint(const Scene& scene, const std::vector<int>& views, const ImageOptions& images,
                             FileHashes* files);

}  // namespace oraclegs
