#include "oraclegs/sfm/pose_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/matched_features.h"
#include "oraclegs/sfm/pair_evidence.h"

namespace oraclegs {
namespace {

constexpr double kMaxFocalRatio = 1.4;    // found against EXIF's, which is right within a tenth
constexpr double kMinShareOfPairs = .25;  // with two motions: a chance agreement of one pair is no doubt
constexpr double kMinPlanarPairs = .9;    // of the pairs

std::string FocalDoubt(const FocalLength& focal) {
  if (!(focal.found > 0 && focal.by_exif > 0)) return "";
  const double ratio = std::max(focal.found / focal.by_exif, focal.by_exif / focal.found);
  if (ratio <= kMaxFocalRatio) return "";
  return fmt::format(
      "{}the focal length that was found for {} is {:.0f} pixels, {:.1f} times {} than the {:.0f} of EXIF; use photos "
      "as "
      "the camera wrote them (not cropped), and mask a background that does not turn with the object (masks/NAME.png)",
      kPosesDoubtful, SomeNames(focal.photos), focal.found, ratio, focal.found > focal.by_exif ? "longer" : "shorter",
      focal.by_exif);
}

/// How many pairs have it, and the one with most of it.
struct PairCount {
  int pairs = 0;
  const PairMotions* example = nullptr;

  bool IsMuch(size_t of) const {
    return pairs > 0 && pairs >= std::min<double>(2, static_cast<double>(of)) &&
           pairs >= kMinShareOfPairs * static_cast<double>(of);
  }
};

PairCount CountPairs(const std::vector<PairMotions>& pairs, bool (MotionCounts::*has)() const,
                     int MotionCounts::*amount) {
  PairCount count;
  for (const PairMotions& pair : pairs) {
    if (!(pair.counts.*has)()) continue;
    ++count.pairs;
    if (count.example == nullptr || pair.counts.*amount > count.example->counts.*amount) count.example = &pair;
  }
  return count;
}

}  // namespace

std::vector<std::string> PoseDoubts(const std::vector<PairMotions>& pairs, const std::vector<FocalLength>& focals) {
  std::vector<std::string> doubts;
  for (const FocalLength& focal : focals) {
    if (std::string doubt = FocalDoubt(focal); !doubt.empty()) doubts.push_back(std::move(doubt));
  }
  const PairCount still = CountPairs(pairs, &MotionCounts::HasStillPart, &MotionCounts::still);
  if (still.IsMuch(pairs.size())) {
    doubts.push_back(fmt::format(
        "{}something stands still in the photos while the rest moves (in {} of {}; {} points in "
        "{} and {}), as a background behind a turntable or a watermark does; mask it (masks/NAME.png, black), or move "
        "the camera instead of the object",
        kPosesDoubtful, still.pairs, Counted(pairs.size(), "pair"), still.example->counts.still, still.example->first,
        still.example->second));
  }
  const PairCount moved = CountPairs(pairs, &MotionCounts::HasMovedPart, &MotionCounts::apart);
  if (moved.IsMuch(pairs.size())) {
    doubts.push_back(
        fmt::format("{}something moved on its own between the photos (in {} of {}; {} points in {} and {}); "
                    "mask it (masks/NAME.png, black), or leave those photos out",
                    kPosesDoubtful, moved.pairs, Counted(pairs.size(), "pair"), moved.example->counts.apart,
                    moved.example->first, moved.example->second));
  }
  std::vector<PairMotions> parallax = pairs;
  std::erase_if(parallax, [](const PairMotions& pair) { return pair.pure_rotation; });
  const PairCount planar = CountPairs(parallax, &MotionCounts::IsPlanar, &MotionCounts::planar);
  const bool focal_known =
      !focals.empty() && std::all_of(focals.begin(), focals.end(), [](const FocalLength& f) { return f.by_exif > 0; });
  if (!focal_known && planar.pairs > 0 && planar.pairs >= kMinPlanarPairs * static_cast<double>(parallax.size())) {
    doubts.push_back(
        fmt::format("{}all that the photos share lies on one plane, which does not show the focal length, and EXIF "
                    "does not say it; "
                    "take photos with things before or behind that plane in view",
                    kPosesDoubtful));
  }
  return doubts;
}

std::vector<PairMotions> ReadPairMotions(const std::filesystem::path& database, const std::filesystem::path& images) {
  std::map<std::string, double> side_of;
  const auto stored = ReadDatabaseImages(database);
  for (const auto& [name, image] : stored) {
    int width = 0, height = 0;
    ReadImageSize(images / name, &width, &height);
    side_of[name] = std::max(width, height);
  }
  std::vector<PairMotions> motions;
  std::map<std::pair<uint32_t, uint32_t>, MatchedPair> matched;
  for (const MatchedPair& pair : ReadMatchedPairs(database)) matched[{pair.first, pair.second}] = pair;
  for (const PairEvidence& pair : ReadPairEvidence(database, images)) {
    if (!pair.IsLink()) continue;
    const uint32_t a = stored.at(pair.first).image_id, b = stored.at(pair.second).image_id;
    AlikeFeatures features;
    features.inliers = ReadInliers(database, a, b);
    features.outliers = ReadOutliers(database, a, b);
    features.homography = matched.at({a, b}).homography;
    features.side = std::max(side_of[pair.first], side_of[pair.second]);
    motions.push_back({pair.first, pair.second, CountMotions(features), pair.pure_rotation});
  }
  return motions;
}

}  // namespace oraclegs
