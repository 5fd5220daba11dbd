#pragma once
// Does a stage have to run again? A short name of everything its result depends on answers that.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/safetensors.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// 64-bit FNV-1a, as 16 hexadecimal digits. Tells changed inputs from unchanged ones; no defence against forgery.
class Fingerprint {
 public:
  Fingerprint& Add(std::string_view bytes);
  Fingerprint& Add(double value);
  /// The content of a file. Throws InputError naming it.
  Fingerprint& AddFile(const std::filesystem::path& path);
  /// Metadata, names, types and shapes of a file of weights, and 64 bytes at each end of each tensor: gigabytes would
  /// be read for nothing else.
  Fingerprint& AddTensors(const SafetensorsFile& file);
  std::string Hex() const;

 private:
  uint64_t hash_ = 0xcbf29ce484222325ull;
};

/// The scene's format, and of these views names, photographs (the bytes of the files that LoadViews opens at this
/// downscale), masks, lenses and poses.
std::string ViewsFingerprint(const Scene& scene, const std::vector<int>& views, int downscale = 1);

/// The content of a file.
std::string FileFingerprint(const std::filesystem::path& path);

}  // namespace oraclegs
