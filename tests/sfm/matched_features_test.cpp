#include "oraclegs/sfm/matched_features.h"

#include <gtest/gtest.h>

#include <sqlite3.h>

#include <string>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/sfm/database_file.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

std::string HexBytes(const void* bytes, size_t size) {
  std::string hex;
  for (size_t i = 0; i < size; ++i) hex += fmt::format("{:02x}", static_cast<const unsigned char*>(bytes)[i]);
  return hex;
}

void Execute(const fs::path& path, const std::string& sql) { DatabaseFile(path).Execute(sql.c_str()); }

/// Three keypoints of images 1 and 2; inliers (10, 11) - (40, 41) and (30, 31) - (60, 61), and of what looks alike,
/// besides, (20, 21) - (50, 51). The third descriptor of image 1 is of the largest feature, the first of the smallest.
fs::path WriteFeatures(const TempDir& dir) {
  const fs::path path = dir / "database.db";
  sqlite3* raw = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &raw), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(raw, "CREATE TABLE begun (a INTEGER)", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(raw);
  const float first[] = {10, 11, 1, 20, 21, 2, 30, 31, 3}, second[] = {40, 41, 50, 51, 60, 61};
  const uint32_t inliers[] = {0, 0, 2, 2}, alike[] = {0, 0, 1, 1, 2, 2};
  std::string descriptors;
  for (const char* value : {"01", "02", "ff"}) {
    for (int k = 0; k < 128; ++k) descriptors += value;
  }
  Execute(path,
          fmt::format("CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);"
                      "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);"
                      "CREATE TABLE matches (pair_id INTEGER PRIMARY KEY, rows INTEGER, data BLOB);"
                      "CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY, rows INTEGER, data BLOB);"
                      "INSERT INTO keypoints VALUES (1, 3, 3, x'{}'), (2, 3, 2, x'{}');"
                      "INSERT INTO descriptors VALUES (1, 3, 128, x'{}');"
                      "INSERT INTO matches VALUES ({}, 3, x'{}');"
                      "INSERT INTO two_view_geometries VALUES ({}, 2, x'{}');",
                      HexBytes(first, sizeof(first)), HexBytes(second, sizeof(second)), descriptors, PairId(1, 2),
                      HexBytes(alike, sizeof(alike)), PairId(1, 2), HexBytes(inliers, sizeof(inliers))));
  return path;
}

TEST(ReadInliers, ReadsPixelsOfBothImages) {
  const TempDir dir;
  const fs::path path = WriteFeatures(dir);
  const auto matches = ReadInliers(path, 1, 2);
  ASSERT_EQ(matches.size(), 2u);
  EXPECT_EQ(matches[0].a, Eigen::Vector2d(10, 11));
  EXPECT_EQ(matches[0].b, Eigen::Vector2d(40, 41));
  EXPECT_EQ(matches[1].a, Eigen::Vector2d(30, 31));
  EXPECT_EQ(matches[1].b, Eigen::Vector2d(60, 61));
  EXPECT_TRUE(ReadInliers(path, 1, 7).empty()) << "not verified";
}

TEST(ReadInliers, IgnoresInconsistentLists) {
  for (const char* damage : {"UPDATE two_view_geometries SET rows = 2000000000", "UPDATE keypoints SET rows = 2",
                             "UPDATE keypoints SET cols = 0", "UPDATE keypoints SET cols = 1, rows = 9",
                             "UPDATE keypoints SET data = x'00'", "DELETE FROM keypoints WHERE image_id = 2",
                             "UPDATE two_view_geometries SET data = x'00000000ffffffff', rows = 1"}) {
    const TempDir dir;
    const fs::path path = WriteFeatures(dir);
    Execute(path, damage);
    EXPECT_TRUE(ReadInliers(path, 1, 2).empty()) << damage;
  }
}

TEST(ReadOutliers, ReadsWhatIsNoInlier) {
  const TempDir dir;
  const fs::path path = WriteFeatures(dir);
  const auto matches = ReadOutliers(path, 1, 2);
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].a, Eigen::Vector2d(20, 21));
  EXPECT_EQ(matches[0].b, Eigen::Vector2d(50, 51));
  EXPECT_TRUE(ReadOutliers(path, 1, 7).empty());
}

TEST(ReadLargestDescriptors, SortsBySize) {
  const TempDir dir;
  const fs::path path = WriteFeatures(dir);
  const DescriptorMatrix largest = ReadLargestDescriptors(path, 1, 2);
  ASSERT_EQ(largest.rows(), 2);
  EXPECT_EQ(largest(0, 127), 255);
  EXPECT_EQ(largest(1, 0), 2);
  EXPECT_EQ(ReadLargestDescriptors(path, 2, 9).rows(), 0);
  Execute(path, "UPDATE descriptors SET cols = 64");
  EXPECT_EQ(ReadLargestDescriptors(path, 1, 9).rows(), 0);
}

}  // namespace
}  // namespace oraclegs
