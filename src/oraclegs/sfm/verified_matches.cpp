#include "oraclegs/sfm/verified_matches.h"

#include <algorithm>
#include <map>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/sfm/matched_features.h"

namespace oraclegs {
namespace {

std::map<uint32_t, std::string> NamesById(const std::filesystem::path& database) {
  std::map<uint32_t, std::string> names;
  for (const auto& [name, image] : ReadDatabaseImages(database)) names[image.image_id] = name;
  return names;
}

}  // namespace

std::vector<VerifiedPair> ReadVerifiedMatches(const std::filesystem::path& database, int min_matches) {
  const std::map<uint32_t, std::string> names = NamesById(database);
  std::vector<VerifiedPair> verified;
  for (const MatchedPair& pair : ReadMatchedPairs(database)) {
    if (pair.inliers < std::max(1, min_matches)) continue;
    const auto first = names.find(pair.first), second = names.find(pair.second);
    std::vector<PointMatch> matches = ReadInliers(database, pair.first, pair.second);
    if (first == names.end() || second == names.end() || matches.empty()) {
      throw RunError("{}: the matches of images {} and {} are damaged; delete it, colmap makes it anew",
                     database.string(), pair.first, pair.second);
    }
    verified.push_back({first->second, second->second, pair.config, std::move(matches)});
  }
  return verified;
}

}  // namespace oraclegs
