#pragma once
// Doubts about poses that were found: each is a line that says what to do.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/sfm/two_motions.h"

namespace oraclegs {

/// The motions in a pair of photos that are linked.
struct PairMotions {
  std::string first, second;  ///< names for people
  MotionCounts counts;
  bool pure_rotation = false;
};

/// The focal length of one camera, in pixels.
struct FocalLength {
  std::vector<std::string> photos;  ///< names for people
  double found = 0, by_exif = 0;    ///< 0 = not known
};

inline constexpr char kPosesDoubtful[] = "the poses are doubtful: ";  ///< begins each doubt

/// One line for each: focal lengths far from EXIF's; things that stand still, or that move on their own; photos that
/// share nothing but a plane. Empty when nothing speaks against the poses.
std::vector<std::string> PoseDoubts(const std::vector<PairMotions>& pairs, const std::vector<FocalLength>& focals);

/// The motions of every linked pair of a database, with its names. `images` is the folder that the names are below.
/// Throws RunError naming the database, InputError for an image that cannot be read.
std::vector<PairMotions> ReadPairMotions(const std::filesystem::path& database, const std::filesystem::path& images);

}  // namespace oraclegs
