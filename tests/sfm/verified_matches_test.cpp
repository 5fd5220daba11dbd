#include "oraclegs/sfm/verified_matches.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sqlite3.h>

#include <fstream>
#include <string>

#include "oraclegs/core/error.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

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
