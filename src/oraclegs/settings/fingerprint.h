#pragma once
// Fingerprints of everything that a stage's result depends on: equal fingerprints, equal results.

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
  /// Adds the content of a file. Throws InputError naming it.
  Fingerprint& AddFile(const std::filesystem::path& path);
  /// Adds metadata, names, types and shapes of a file of weights, and 64 bytes at each end of each tensor. Reading all
  /// of its gigabytes would take too long.
  Fingerprint& AddTensors(const SafetensorsFile& file);
  std::string Hex() const { return hash_.Hex(); }

 private:
  Sha256 hash_;
};

/// Hashes of the content of files that a run only reads, as they were when they were first asked for: what changes
/// meanwhile is noticed by the next run.
class FileHashes {
 public:
  /// Reads the files not yet known, on all threads. Throws InputError naming a file that cannot be read.
  void Read(const std::vector<std::filesystem::path>& files);
  const std::string& Of(const std::filesystem::path& file);
  /// Hash of all files together; "" for an empty list.
  std::string OfAll(const std::vector<std::filesystem::path>& files);

 private:
  std::map<std::filesystem::path, std::string> known_;
};

/// Fingerprint of the scene's format, and of these views: names, images (the files that LoadViews opens with these
/// options), masks, intrinsics and poses.
std::string ViewsFingerprint(const Scene& scene, const std::vector<int>& views, const ImageOptions& images,
                             FileHashes* files);

}  // namespace oraclegs
