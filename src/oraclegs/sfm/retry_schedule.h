#pragma once
// Which attempts are made to find the cameras of images, in which order, and when it is enough. Data and decisions
// alone: nothing here runs colmap.

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/sfm/colmap_quality.h"
#include "oraclegs/sfm/colmap_runner.h"

namespace oraclegs {

/// How the mapper looks for a model in the matches of one set of features.
struct MapperAttempt {
  std::string name;
  ColmapOptions options;
  double focal_guess = 0;  ///< where the focal length starts, in longer sides of the image; 0 = colmap's guess, 1.2
};

/// One way of finding and matching features; each works on a database of its own.
struct FeatureSet {
  std::string name;
  ColmapOptions extraction, matching;
  std::vector<MapperAttempt> attempts;
  int max_images = 0;       ///< too slow for more images than this
  bool needs_link = false;  ///< costly: useless where no links make a model (LinksMakeAModel), and the last tried where
                            ///< it adds no image to one of more than kMaxImagesForAllFeatures
  bool is_learned = false;  ///< the first set's features and a network's
};

/// Signs in the matches so far that images which are not registered can be.
struct MatchEvidence {
  int links = 0;           ///< links of such an image to another (pair_evidence.h)
  bool one_place = false;  ///< all links, of any images, are pure rotations of the camera
  int group = 0;           ///< images of the largest group with such an image, joined by links or by the best model
};

using ImageLinks = std::set<std::pair<std::string, std::string>>;  ///< by names

/// The evidence of links about the images that `best` lacks.
MatchEvidence EvidenceOf(const ImageLinks& links, const ModelQuality& best, bool one_place);

inline constexpr int kMaxImagesForRetries = 24;     ///< up to here every image is worth another attempt
inline constexpr int kMaxImagesForAllFeatures = 6;  ///< so few that no set of features is too costly
inline constexpr int kMinFeaturesToMatch = 30;      ///< an image with fewer cannot be matched in any attempt
inline constexpr int kMaxPairsToRematch = 150;      ///< matched again with known intrinsics, about a second each

/// Cheap before expensive, strict before relaxed: colmap's own thresholds; relaxed ones; an initial pair of small angle
/// or forward motion, also with a wide-angle lens; a network's features, where there is one; affine features of small
/// images, which say whether anything links the images at all; more and weaker features; affine ones; and, slowest,
/// pooled ones. The thresholds are from trials on 3 to 12 images of a scene; the first set is the only one for more
/// than kMaxImagesForRetries. Few and coarse features come before it where there are more than kMaxImagesToMatchAll:
/// they are plenty where each place is in many images.
const std::vector<FeatureSet>& RegistrationSchedule(int images);

/// Thresholds for registering the remaining images into an existing model.
const ColmapOptions& RemainingImagesOptions();
/// For matching images again once the intrinsics are known: weaker matches, but consistent with one motion of that
/// camera.
const ColmapOptions& RematchOptions();

/// True when no further mapper run is called for: a sound model has all images; of more than kMaxImagesForRetries, half
/// of them; of more than kMaxImagesToMatchAll, nine tenths.
bool IsEnough(const ModelQuality& best, int images);

/// True when links join more than two images, one of them missing; of three images, two.
bool LinksMakeAModel(const MatchEvidence& evidence, int images);

/// True when `set` is to be tried after `best` was found without it, by matches that show `evidence`.
bool IsWorthTrying(const FeatureSet& set, const ModelQuality& best, int images, const MatchEvidence& evidence);

/// True when an image that is missing in `best` has features enough to be matched. `feature_counts` by name.
bool CanMatchMissing(const std::map<std::string, int>& feature_counts, const ModelQuality& best);

/// Pairs that are worth matching again: each of `names` that `best` lacks with every other image, a pair once. Empty
/// when they are more than kMaxPairsToRematch.
std::vector<std::pair<std::string, std::string>> PairsOfMissing(const std::vector<std::string>& names,
                                                                const ModelQuality& best);

}  // namespace oraclegs
