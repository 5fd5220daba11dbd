#pragma once
// Evidence in the matches of two images, before any camera is known.

#include <filesystem>
#include <string>
#include <vector>

namespace oraclegs {

struct PairEvidence {
  std::string first, second;   ///< names in the database
  int matches = 0;             ///< features that look alike
  int inliers = 0;             ///< matches that one motion of the camera explains
  bool pure_rotation = false;  ///< that motion is a pure rotation

  /// True when chance does not explain that so many agree on one motion.
  bool IsLink() const;
};

/// Every pair that was verified, by image id. `images` is the folder that the names are below. Throws RunError naming
/// the database, InputError for an image that cannot be read.
std::vector<PairEvidence> ReadPairEvidence(const std::filesystem::path& database, const std::filesystem::path& images);

/// True when there are links, and each of them is a pure rotation of the camera.
bool AreFromOnePoint(const std::vector<PairEvidence>& pairs);

}  // namespace oraclegs
