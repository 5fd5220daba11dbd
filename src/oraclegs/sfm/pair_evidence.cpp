#include "oraclegs/sfm/pair_evidence.h"

#include <algorithm>
#include <array>
#include <map>

#include "oraclegs/image/read_image.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/homography.h"
#include "oraclegs/sfm/matched_features.h"

namespace oraclegs {
namespace {

constexpr int kMinInliersOfLink = 30;         // of images that share nothing, weak features gave 20 at most
constexpr int kMinInliersOfWeakLink = 15;     // what colmap verifies at all
constexpr double kMinShareOfWeakLink = .35;   // of the matches; by chance it was .15
constexpr double kMaxRotationResidual = .02;  // a step aside by a fiftieth of the distance, about one degree

struct Stored {
  std::string name;
  std::array<int, 2> size{};
};

}  // namespace

bool PairEvidence::IsLink() const {
  return inliers >= kMinInliersOfLink || (inliers >= kMinInliersOfWeakLink && inliers >= kMinShareOfWeakLink * matches);
}

std::vector<PairEvidence> ReadPairEvidence(const std::filesystem::path& database, const std::filesystem::path& images) {
  std::map<uint32_t, Stored> stored;
  for (const auto& [name, image] : ReadDatabaseImages(database)) stored[image.image_id].name = name;
  const auto size_of = [&](Stored* image) {
    if (image->size[0] == 0) ReadImageSize(images / image->name, &image->size[0], &image->size[1]);
    return image->size;
  };
  std::vector<PairEvidence> pairs;
  for (const MatchedPair& pair : ReadMatchedPairs(database)) {
    const auto a = stored.find(pair.first), b = stored.find(pair.second);
    if (pair.inliers == 0 || a == stored.end() || b == stored.end()) continue;
    const bool pure_rotation =
        pair.homography &&
        RotationResidual(RefitHomography(*pair.homography, ReadInliers(database, pair.first, pair.second)),
                         size_of(&a->second), size_of(&b->second)) < kMaxRotationResidual;
    pairs.push_back({a->second.name, b->second.name, pair.matches, pair.inliers, pure_rotation});
  }
  return pairs;
}

bool AreFromOnePoint(const std::vector<PairEvidence>& pairs) {
  const auto is_link = [](const PairEvidence& pair) { return pair.IsLink(); };
  const auto turns = [](const PairEvidence& pair) { return !pair.IsLink() || pair.pure_rotation; };
  return std::any_of(pairs.begin(), pairs.end(), is_link) && std::all_of(pairs.begin(), pairs.end(), turns);
}

}  // namespace oraclegs
