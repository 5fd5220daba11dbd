#pragma once
// Which attempts are made to find the cameras of photographs, in which order, and when it is enough. Data and decisions
// alone: nothing here runs colmap.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/sfm/colmap_quality.h"
#include "oraclegs/sfm/colmap_runner.h"

namespace oraclegs {

/// How a model is sought among the matches of one set of features.
struct MapperTry {
  std::string name;
  ColmapOptions options;
  double focal_guess = 0;  ///< where the focal length starts, in longer sides of the picture; 0 = colmap's guess (1.2)
};

/// One way of finding and matching features; each works on a database of its own.
struct FeatureSet {
  std::string name;
  ColmapOptions extraction, matching;
  std::vector<MapperTry> tries;
  int for_few = 0;  ///< it costs too much for more photographs than this, unless hardly any could be registered
};

inline constexpr int kFewPhotographs = 24;   ///< up to here every photograph is worth another attempt
inline constexpr int kFewestFeatures = 30;   ///< a photograph with fewer cannot be matched whatever is tried
inline constexpr int kMostPairsAgain = 150;  ///< matched anew with known lenses, about a second each

/// Cheap before expensive, strict before relaxed: colmap's own thresholds; relaxed ones; an initial pair of small angle
/// or forward motion, also from a wide lens; more and weaker features; affine ones; and, slowest, pooled ones.
/// The thresholds are from trials on 3 to 12 photographs of a scene; the first set is the only one for many.
const std::vector<FeatureSet>& RegistrationLadder();

/// Thresholds for registering what is left over into a model that stands.
const ColmapOptions& LeftOverOptions();
/// For matching photographs anew once the lens is known: alike in less, but held to one motion of that lens.
const ColmapOptions& MatchAgainOptions();

/// True when no further mapper run is called for: a sound model has all photographs or, of more than
/// kFewPhotographs, half of them.
bool IsEnough(const ModelQuality& best, int photographs);

/// True when `set` is to be tried after `best` was found without it.
bool IsWorthTrying(const FeatureSet& set, const ModelQuality& best, int photographs);

/// True when a photograph that is missing in `best` has features enough to be matched. `feature_counts` by name.
bool CanMatchMissing(const std::map<std::string, int>& feature_counts, const ModelQuality& best);

/// Of `names`, those `best` lacks, each paired with every other photograph (a pair once): what is worth matching again.
/// Empty when the pairs are more than kMostPairsAgain.
std::vector<std::pair<std::string, std::string>> PairsOfMissing(const std::vector<std::string>& names,
                                                                const ModelQuality& best);

}  // namespace oraclegs
