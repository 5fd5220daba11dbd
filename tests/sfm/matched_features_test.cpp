#include "oraclegs/sfm/matched_features.h"
#include "support/errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sqlite3.h>

#include <fstream>
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

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

void RunSql(const fs::path& path, const std::string& sql) {
  sqlite3* open = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &open), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(open, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(open);
  sqlite3_close(open);
}

std::string AsHex(const void* bytes, size_t size) {
  std::string hex;
  for (size_t i = 0; i < size; ++i) hex += fmt::format("{:02x}", static_cast<const unsigned char*>(bytes)[i]);
  return hex;
}

/// Images 1 "a.png", 2 "b.png" and 3 "c.png" with two keypoints each. Verified: 1-2 with both, 1-3 with one.
fs::path WriteMatches(const TempDir& dir) {
  const fs::path path = dir / "database.db";
  const float keypoints[] = {1.5f, 2, 0, 30, 40, 0};
  const uint32_t both[] = {0, 1, 1, 0}, one[] = {1, 1};
  const auto pair_id = [](int64_t a, int64_t b) { return 2147483647 * a + b; };
  std::string sql = R"(PRAGMA synchronous = OFF; BEGIN;
    CREATE TABLE images (image_id INTEGER, name TEXT, camera_id INTEGER);
    CREATE TABLE keypoints (image_id INTEGER, rows INTEGER, cols INTEGER, data BLOB);
    CREATE TABLE matches (pair_id INTEGER, rows INTEGER, cols INTEGER, data BLOB);
    CREATE TABLE two_view_geometries (pair_id INTEGER, rows INTEGER, cols INTEGER, data BLOB, config INTEGER, H BLOB);
    INSERT INTO images VALUES (1, 'a.png', 1), (2, 'b.png', 1), (3, 'c.png', 1);)";
  for (int i = 1; i <= 3; ++i)
    sql += fmt::format("INSERT INTO keypoints VALUES ({}, 2, 3, x'{}');", i, AsHex(keypoints, sizeof(keypoints)));
  for (const int64_t id : {pair_id(1, 2), pair_id(1, 3), pair_id(2, 3)})
    sql += fmt::format("INSERT INTO matches VALUES ({}, 9, 2, x'');", id);
  sql += fmt::format("INSERT INTO two_view_geometries VALUES ({}, 2, 2, x'{}', 2, x''), ({}, 1, 2, x'{}', 7, x'');",
                     pair_id(1, 2), AsHex(both, sizeof(both)), pair_id(1, 3), AsHex(one, sizeof(one)));
  RunSql(path, sql + "COMMIT;");
  return path;
}

TEST(ReadVerifiedMatches, ReadsPairsByName) {
  const TempDir dir;
  const auto pairs = ReadVerifiedMatches(WriteMatches(dir));
  ASSERT_EQ(pairs.size(), 2u) << "2-3 was matched, but not verified";
  EXPECT_EQ(pairs[0].first, "a.png");
  EXPECT_EQ(pairs[0].second, "b.png");
  EXPECT_EQ(pairs[0].config, TwoViewConfig::kCalibrated);
  ASSERT_EQ(pairs[0].matches.size(), 2u);
  EXPECT_EQ(pairs[0].matches[0].a, Eigen::Vector2d(1.5, 2));
  EXPECT_EQ(pairs[0].matches[0].b, Eigen::Vector2d(30, 40));
  EXPECT_EQ(pairs[1].second, "c.png");
  EXPECT_EQ(pairs[1].config, TwoViewConfig::kWatermark);
}

TEST(ReadVerifiedMatches, LeavesOutPairsWithFewMatches) {
  const TempDir dir;
  EXPECT_EQ(ReadVerifiedMatches(WriteMatches(dir), 2).size(), 1u);
}

TEST(ReadVerifiedMatches, NamesADamagedDatabase) {
  for (const char* damage :
       {"UPDATE two_view_geometries SET rows = 2000000000", "DELETE FROM images WHERE image_id = 2",
        "UPDATE keypoints SET rows = 1", "UPDATE keypoints SET data = x'00'", "DROP TABLE two_view_geometries"}) {
    const TempDir dir;
    const fs::path path = WriteMatches(dir);
    RunSql(path, damage);
    EXPECT_THAT(MessageOf<RunError>([&] { ReadVerifiedMatches(path); }),
                AllOf(StartsWith(path.string() + ": "), testing::Not(HasSubstr("\n"))))
        << damage;
  }
  const TempDir dir;
  std::ofstream(dir / "database.db") << "this is no database at all, only a text that stands in its place";
  EXPECT_THAT(MessageOf<RunError>([&] { ReadVerifiedMatches(dir / "database.db"); }), HasSubstr("database.db: "));
}

}  // namespace

}  // namespace oraclegs
