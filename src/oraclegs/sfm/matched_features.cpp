#include "oraclegs/sfm/matched_features.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/sfm/database_file.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kDescriptorSize = 128;

/// Pixel positions of an image's features.
std::vector<Eigen::Vector2d> ReadKeypoints(const DatabaseFile& open, uint32_t image_id) {
  const DatabaseStatement rows(open, "SELECT rows, cols, data FROM keypoints WHERE image_id = ?1");
  sqlite3_bind_int64(rows.get(), 1, image_id);
  std::vector<Eigen::Vector2d> points;
  if (!rows.Step()) return points;
  const int columns = GetCount(rows.get(), 1);  // x, y, and the feature's shape
  if (columns < 2) return points;
  const auto values = GetList<float>(rows.get(), 2, GetCount(rows.get(), 0), columns);
  for (size_t i = 0; i < values.size(); i += static_cast<size_t>(columns))
    points.emplace_back(values[i], values[i + 1]);
  return points;
}

using FeaturePair = std::pair<uint32_t, uint32_t>;
using FeaturePairs = std::vector<FeaturePair>;

/// The pairs of features that a table has of two images; empty when it has none, or a damaged list.
FeaturePairs ReadPairList(const DatabaseFile& open, const char* table, uint32_t first, uint32_t second) {
  const DatabaseStatement rows(open, fmt::format("SELECT rows, data FROM {} WHERE pair_id = ?1", table).c_str());
  sqlite3_bind_int64(rows.get(), 1, PairId(first, second));
  if (!rows.Step()) return {};
  const auto indices = GetList<uint32_t>(rows.get(), 1, GetCount(rows.get(), 0), 2);
  FeaturePairs pairs;
  for (size_t i = 0; i < indices.size(); i += 2) pairs.emplace_back(indices[i], indices[i + 1]);
  return pairs;
}

/// Where they lie; empty when an image has no such feature.
std::vector<PointMatch> PointsAt(const DatabaseFile& open, uint32_t first, uint32_t second, const FeaturePairs& pairs) {
  const std::vector<Eigen::Vector2d> a = ReadKeypoints(open, first), b = ReadKeypoints(open, second);
  std::vector<PointMatch> matches;
  for (const auto& [i, j] : pairs) {
    if (i >= a.size() || j >= b.size()) return {};
    matches.push_back({a[i], b[j]});
  }
  return matches;
}

/// How large each feature is, as the square root of its area; ones where the table does not say.
std::vector<float> ReadScales(const DatabaseFile& open, uint32_t image_id) {
  const DatabaseStatement rows(open, "SELECT rows, cols, data FROM keypoints WHERE image_id = ?1");
  sqlite3_bind_int64(rows.get(), 1, image_id);
  if (!rows.Step()) return {};
  const int columns = GetCount(rows.get(), 1);
  const int count = GetCount(rows.get(), 0);
  const auto values = GetList<float>(rows.get(), 2, count, columns);
  std::vector<float> scales;
  for (size_t i = 0; i < values.size(); i += static_cast<size_t>(columns)) {
    const float* shape = &values[i] + 2;  // scale and angle, or an affine 2x2 matrix
    scales.push_back(columns >= 6   ? std::sqrt(std::abs(shape[0] * shape[3] - shape[1] * shape[2]))
                     : columns >= 3 ? shape[0]
                                    : 1);
  }
  return scales;
}

std::map<uint32_t, std::string> NamesById(const std::filesystem::path& database) {
  std::map<uint32_t, std::string> names;
  for (const auto& [name, image] : ReadDatabaseImages(database)) names[image.image_id] = name;
  return names;
}

}  // namespace

std::vector<PointMatch> ReadInliers(const fs::path& database, uint32_t first, uint32_t second) {
  const DatabaseFile open(database);
  return PointsAt(open, first, second, ReadPairList(open, "two_view_geometries", first, second));
}

std::vector<PointMatch> ReadOutliers(const fs::path& database, uint32_t first, uint32_t second) {
  const DatabaseFile open(database);
  const FeaturePairs inliers = ReadPairList(open, "two_view_geometries", first, second);
  FeaturePairs outliers = ReadPairList(open, "matches", first, second);
  const std::set<FeaturePair> taken(inliers.begin(), inliers.end());
  std::erase_if(outliers, [&](const FeaturePair& pair) { return taken.count(pair) > 0; });
  return PointsAt(open, first, second, outliers);
}

DescriptorMatrix ReadLargestDescriptors(const fs::path& database, uint32_t image_id, int most) {
  const DatabaseFile open(database);
  const DatabaseStatement rows(open, "SELECT rows, cols, data FROM descriptors WHERE image_id = ?1");
  sqlite3_bind_int64(rows.get(), 1, image_id);
  if (!rows.Step() || GetCount(rows.get(), 1) != kDescriptorSize) return DescriptorMatrix(0, kDescriptorSize);
  const auto values = GetList<uint8_t>(rows.get(), 2, GetCount(rows.get(), 0), kDescriptorSize);
  const std::vector<float> scales = ReadScales(open, image_id);
  std::vector<size_t> order(values.size() / kDescriptorSize);
  std::iota(order.begin(), order.end(), size_t{0});
  if (scales.size() == order.size()) {
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return scales[a] > scales[b]; });
  }
  order.resize(std::min(order.size(), static_cast<size_t>(most)));
  DescriptorMatrix descriptors(static_cast<Eigen::Index>(order.size()), kDescriptorSize);
  for (size_t i = 0; i < order.size(); ++i) {
    for (int k = 0; k < kDescriptorSize; ++k) {
      descriptors(static_cast<Eigen::Index>(i), k) = values[order[i] * kDescriptorSize + static_cast<size_t>(k)];
    }
  }
  return descriptors;
}

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
