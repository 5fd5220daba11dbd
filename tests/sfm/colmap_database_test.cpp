#include "oraclegs/sfm/colmap_database.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sqlite3.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "oraclegs/core/error.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Pair;
using testing::StartsWith;
using testing::UnorderedElementsAre;

/// The tables of colmap 3.8 that the code touches, columns and constraints as `colmap database_creator` makes them.
constexpr char kTables[] = R"(
  CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, model INTEGER NOT NULL,
    width INTEGER NOT NULL, height INTEGER NOT NULL, params BLOB, prior_focal_length INTEGER NOT NULL);
  CREATE TABLE images (image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, name TEXT NOT NULL UNIQUE,
    camera_id INTEGER NOT NULL, CONSTRAINT image_id_check CHECK(image_id >= 0 and image_id < 2147483647),
    FOREIGN KEY(camera_id) REFERENCES cameras(camera_id));
  CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL,
    data BLOB, FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
  CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL,
    data BLOB, FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
)";

/// Tables that matching adds, with the columns that colmap makes.
constexpr char kMatchTables[] = R"(
  CREATE TABLE matches (pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB);
  CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL,
    cols INTEGER NOT NULL, data BLOB, config INTEGER NOT NULL, F BLOB, E BLOB, H BLOB, qvec BLOB, tvec BLOB);
)";

/// Two cameras; b, c, a as colmap's threads may have finished them. `rows` shows whose keypoints they are.
constexpr char kThreeImages[] = R"(
  INSERT INTO cameras VALUES (1, 0, 10, 20, x'00', 0), (4, 0, 10, 20, x'00', 0);
  INSERT INTO images VALUES (1, 'camera0/b.png', 1), (2, 'camera1/c.png', 4), (7, 'camera0/a.png', 1);
  INSERT INTO keypoints VALUES (1, 100, 6, x'0b'), (2, 200, 6, x'0c'), (7, 300, 6, x'0a');
  INSERT INTO descriptors VALUES (1, 100, 128, x'0b'), (2, 200, 128, x'0c'), (7, 300, 128, x'0a');
)";

/// A connection of the test's own, beside the one of the code under test.
class Sqlite {
 public:
  explicit Sqlite(const fs::path& path) {
    sqlite3* raw = nullptr;
    EXPECT_EQ(sqlite3_open(path.c_str(), &raw), SQLITE_OK);
    handle_.reset(raw);
  }

  void Execute(const std::string& sql) const {
    EXPECT_EQ(sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(handle_.get());
  }

  /// The rows of a query, columns joined by "|".
  std::vector<std::string> Rows(const std::string& sql) const {
    std::vector<std::string> rows;
    const auto add = [](void* out, int columns, char** values, char**) {
      std::string row;
      for (int i = 0; i < columns; ++i) row += (i > 0 ? "|" : "") + std::string(values[i] ? values[i] : "NULL");
      static_cast<std::vector<std::string>*>(out)->push_back(row);
      return 0;
    };
    EXPECT_EQ(sqlite3_exec(handle_.get(), sql.c_str(), add, &rows, nullptr), SQLITE_OK);
    return rows;
  }

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  std::unique_ptr<sqlite3, Close> handle_;
};

using Rows = std::vector<std::string>;

fs::path WriteDatabase(const TempDir& dir, const std::string& sql = std::string(kTables) + kThreeImages) {
  Sqlite(dir / "database.db").Execute("PRAGMA synchronous = OFF; BEGIN;" + sql + "COMMIT;");
  return dir / "database.db";
}

const Intrinsics kOpenCvIntrinsics{CameraModel::kOpenCv, 640, 480, {500.5, 501.25, 320, 1. / 3, .1, -.2, 1e-300, -0.}};

/// Every function must name the database, say what is wrong and what mends it.
void ExpectRefused(const fs::path& database, const std::string& reason) {
  const auto message =
      AllOf(StartsWith(database.string() + ": "), HasSubstr(reason), HasSubstr("run the same command again"));
  EXPECT_THAT(MessageOf<RunError>([&] { ReadDatabaseImages(database); }), message);
  EXPECT_THAT(MessageOf<RunError>([&] { SetDatabaseCameras(database, {{1, kOpenCvIntrinsics}}); }), message);
  EXPECT_THAT(MessageOf<RunError>([&] { NumberImagesByName(database); }), message);
  EXPECT_THAT(MessageOf<RunError>([&] { ReadFeatureCounts(database); }), message);
  EXPECT_THAT(MessageOf<RunError>([&] { ReadMatchedPairs(database); }),
              AllOf(StartsWith(database.string() + ": "), HasSubstr("run the same command again")));
  EXPECT_THAT(MessageOf<RunError>([&] { SetFocalGuess(database, 1); }), message);
}

MATCHER_P2(HasIds, image_id, camera_id, "") { return arg.image_id == image_id && arg.camera_id == camera_id; }

TEST(ReadDatabaseImages, ListsIdsByName) {
  const TempDir dir;
  EXPECT_THAT(ReadDatabaseImages(WriteDatabase(dir)),
              UnorderedElementsAre(Pair("camera0/a.png", HasIds(7u, 1u)), Pair("camera0/b.png", HasIds(1u, 1u)),
                                   Pair("camera1/c.png", HasIds(2u, 4u))));
}

TEST(ReadDatabaseImages, AcceptsNoImages) {
  const TempDir dir;
  EXPECT_TRUE(ReadDatabaseImages(WriteDatabase(dir, kTables)).empty());
}

TEST(ReadDatabaseImages, KeepsTheLargestIds) {
  const TempDir dir;
  const auto images = ReadDatabaseImages(
      WriteDatabase(dir, std::string(kTables) + "INSERT INTO images VALUES (2147483646, 'z', 4294967295);"));
  EXPECT_THAT(images, UnorderedElementsAre(Pair("z", HasIds(2147483646u, 4294967295u))));
}

TEST(SetDatabaseCameras, StoresIntrinsicsExactly) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  SetDatabaseCameras(path, {{4, kOpenCvIntrinsics}, {99, kOpenCvIntrinsics}});  // there is no camera 99: none is added
  std::string bytes(kOpenCvIntrinsics.params.size() * sizeof(double), '\0');
  std::memcpy(bytes.data(), kOpenCvIntrinsics.params.data(), bytes.size());
  std::string hex;
  for (const char c : bytes) hex += fmt::format("{:02X}", static_cast<unsigned char>(c));
  EXPECT_EQ(Sqlite(path).Rows("SELECT camera_id, model, width, height, hex(params), prior_focal_length FROM cameras"),
            (Rows{"1|0|10|20|00|0", "4|4|640|480|" + hex + "|1"}));
}

int64_t PairId(int64_t first, int64_t second) { return 2147483647 * first + second; }

std::string Hex(const std::vector<double>& numbers) {
  std::string bytes(numbers.size() * sizeof(double), '\0'), hex;
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  for (const char c : bytes) hex += fmt::format("{:02X}", static_cast<unsigned char>(c));
  return hex;
}

/// Matches of the pairs 1-2 (verified, one homography), 1-7 (not verified) and 2-7 (verified, no homography).
std::string Matches() {
  const std::string map = Hex({1, 2, 3, 4, 5, 6, 7, 8, 9});
  const auto geometry = [&](int64_t id, int rows, int config) {
    return fmt::format("INSERT INTO two_view_geometries VALUES ({}, {}, 2, x'', {}, x'', x'', x'{}', x'', x'');", id,
                       rows, config, map);
  };
  return std::string(kTables) + kThreeImages + kMatchTables +
         fmt::format("INSERT INTO matches VALUES ({}, 90, 2, x''), ({}, 5, 2, x''), ({}, 80, 2, x'');", PairId(1, 2),
                     PairId(1, 7), PairId(2, 7)) +
         geometry(PairId(1, 2), 60, 6) + geometry(PairId(2, 7), 40, 3);
}

TEST(ReadFeatureCounts, IsZeroWithoutAnEntry) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  Sqlite(path).Execute("DELETE FROM keypoints WHERE image_id = 2");
  EXPECT_THAT(ReadFeatureCounts(path), UnorderedElementsAre(Pair(1u, 100), Pair(2u, 0), Pair(7u, 300)));
}

TEST(ReadMatchedPairs, ReadsMatchesInliersAndHomography) {
  const TempDir dir;
  const auto pairs = ReadMatchedPairs(WriteDatabase(dir, Matches()));
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_EQ(pairs[0].first, 1u);
  EXPECT_EQ(pairs[0].second, 2u);
  EXPECT_EQ(pairs[0].matches, 90);
  EXPECT_EQ(pairs[0].inliers, 60);
  EXPECT_EQ(pairs[0].config, TwoViewConfig::kPlanarOrPanoramic);
  ASSERT_TRUE(pairs[0].homography.has_value());
  EXPECT_EQ((*pairs[0].homography)(0, 2), 3) << "row by row";
  EXPECT_EQ(pairs[1].second, 7u);
  EXPECT_EQ(pairs[1].matches, 5);
  EXPECT_EQ(pairs[1].inliers, 0);
  EXPECT_EQ(pairs[1].config, TwoViewConfig::kUndefined);
  EXPECT_FALSE(pairs[1].homography.has_value());
  EXPECT_EQ(pairs[2].inliers, 40);
  EXPECT_FALSE(pairs[2].homography.has_value()) << "one was fitted, but does not explain what was found";
}

TEST(ReadMatchedPairs, TakesUnknownWordsForUndefined) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir, Matches());
  for (const int word : {-1, 9, 1000}) {
    Sqlite(path).Execute(fmt::format("UPDATE two_view_geometries SET config = {}", word));
    EXPECT_EQ(ReadMatchedPairs(path)[0].config, TwoViewConfig::kUndefined) << word;
  }
}

TEST(ReadMatchedPairs, RefusesAnInvalidPair) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir, Matches());
  for (const std::string& map : {std::string("00"), Hex(std::vector<double>(9, 0)), Hex(std::vector<double>(9, NAN))}) {
    Sqlite(path).Execute(fmt::format("UPDATE two_view_geometries SET H = x'{}'", map));
    EXPECT_FALSE(ReadMatchedPairs(path)[0].homography.has_value());
  }
  for (const int64_t id : {int64_t{-1}, int64_t{0}, PairId(7, 1), PairId(5, 5)}) {
    Sqlite(path).Execute(fmt::format("DELETE FROM matches; INSERT INTO matches VALUES ({}, 1, 2, x'')", id));
    EXPECT_THAT(MessageOf<RunError>([&] { ReadMatchedPairs(path); }),
                AllOf(StartsWith(path.string()), HasSubstr("is not the number of a pair")));
  }
}

TEST(AppendKeypoints, StandBehindThoseOfColmap) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  const Sqlite database(path);
  // One of six columns (an affine shape), one of two; the third image has none yet.
  database.Execute(
      "UPDATE keypoints SET rows = 1, data = zeroblob(24) WHERE image_id = 1;"
      "UPDATE keypoints SET rows = 2, cols = 2, data = zeroblob(16) WHERE image_id = 2;"
      "DELETE FROM keypoints WHERE image_id = 7;");
  EXPECT_EQ(AppendKeypoints(path, 1, {{1, 2}}), 1);
  EXPECT_EQ(AppendKeypoints(path, 2, {{1, 2}, {2, 1}}), 2);
  EXPECT_EQ(AppendKeypoints(path, 7, {}), 0);
  const std::string zero = "00000000", one = "0000803F", two = "00000040";
  EXPECT_EQ(database.Rows("SELECT rows, cols, hex(data) FROM keypoints ORDER BY image_id"),
            (Rows{"2|6|" + std::string(48, '0') + one + two + one + zero + zero + one,
                  "4|2|" + std::string(32, '0') + one + two + two + one, "0|6|"}));
}

TEST(AppendKeypoints, RefusesADamagedList) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  EXPECT_THAT(MessageOf<RunError>([&] {
                AppendKeypoints(path, 1, {{1, 2}});
              }),
              AllOf(StartsWith(path.string()), HasSubstr("the keypoints of image 1 are damaged")));
}

TEST(ReadMatches, AreIndicesOfBothImages) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir, Matches());
  Sqlite(path).Execute(
      fmt::format("UPDATE matches SET rows = 2, data = x'01000000020000000300000004000000' WHERE "
                  "pair_id = {}",
                  PairId(1, 2)));
  EXPECT_THAT(ReadMatches(path, 1, 2), testing::ElementsAre(FeatureMatch{1, 2}, FeatureMatch{3, 4}));
  EXPECT_TRUE(ReadMatches(path, 1, 7).empty()) << "damaged";
  EXPECT_TRUE(ReadMatches(path, 3, 4).empty());
}

TEST(RemoveMatches, RemovesPairsInEitherOrder) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir, Matches());
  RemoveMatches(path, {{2, 1}, {1, 7}});
  const auto pairs = ReadMatchedPairs(path);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].second, 7u);
  EXPECT_EQ(Sqlite(path).Rows("SELECT rows FROM two_view_geometries"), (Rows{"40"}));
}

TEST(SetFocalGuess, ChangesUnknownFocalLengthsOnly) {
  const TempDir dir;
  const std::string intrinsics = Hex({12, 5, 10, .25});
  const fs::path path = WriteDatabase(
      dir, kTables + fmt::format("INSERT INTO cameras VALUES (1, 2, 10, 20, x'{0}', 0), (2, 2, 10, 20, x'{0}', 1), "
                                 "(3, 0, 10, 20, x'{0}', 0), (4, 2, 10, 20, x'00', 0);",
                                 intrinsics));
  EXPECT_EQ(SetFocalGuess(path, .75), 1) << "known, of another model, and damaged ones stay";
  EXPECT_EQ(Sqlite(path).Rows("SELECT hex(params) FROM cameras ORDER BY camera_id"),
            (Rows{Hex({15, 5, 10, .25}), intrinsics, intrinsics, "00"}));
}

TEST(SetFocalPriors, MarksTheFocalLengthsAsKnown) {
  const TempDir dir;
  const std::string intrinsics = Hex({12, 5, 10, .25});
  const fs::path path = WriteDatabase(
      dir, kTables + fmt::format("INSERT INTO cameras VALUES (1, 2, 10, 20, x'{0}', 0), (2, 2, 10, 20, x'{0}', 0), "
                                 "(3, 0, 10, 20, x'{0}', 0);"
                                 "INSERT INTO images VALUES (1, 'a', 1), (2, 'b', 2), (3, 'c', 3);",
                                 intrinsics));
  SetFocalPriors(path, {{"a", 15}, {"c", 15}, {"unknown", 99}});
  EXPECT_EQ(Sqlite(path).Rows("SELECT hex(params), prior_focal_length FROM cameras ORDER BY camera_id"),
            (Rows{Hex({15, 5, 10, .25}) + "|1", intrinsics + "|0", intrinsics + "|0"}));
}

TEST(NumberImagesByName, RenumbersImagesAndFeatures) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  for (int time = 0; time < 2; ++time) {  // a second time changes nothing
    NumberImagesByName(path);
    const Sqlite database(path);
    EXPECT_EQ(database.Rows("SELECT image_id, name, camera_id FROM images ORDER BY image_id"),
              (Rows{"1|camera0/a.png|1", "2|camera0/b.png|1", "3|camera1/c.png|4"}));
    EXPECT_EQ(database.Rows("SELECT image_id, rows, hex(data) FROM keypoints ORDER BY image_id"),
              (Rows{"1|300|0A", "2|100|0B", "3|200|0C"}));
    EXPECT_EQ(database.Rows("SELECT image_id, rows, hex(data) FROM descriptors ORDER BY image_id"),
              (Rows{"1|300|0A", "2|100|0B", "3|200|0C"}));
  }
}

TEST(NumberImagesByName, KeepsTheFramesOfColmap4WithTheirImages) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  const Rows names{"1|camera0/b.png", "2|camera1/c.png", "7|camera0/a.png"};
  ASSERT_EQ(Sqlite(path).Rows("SELECT image_id, name FROM images ORDER BY image_id"), names);
  Sqlite(path).Execute(
      "CREATE TABLE frame_data (frame_id INTEGER, data_id INTEGER, sensor_id INTEGER, sensor_type INTEGER);"
      "CREATE UNIQUE INDEX frame_sensor_assignment ON frame_data(data_id, sensor_type);"
      "INSERT INTO frame_data VALUES (1, 1, 1, 0), (2, 2, 4, 0), (3, 7, 1, 0);"
      "CREATE TABLE frames (frame_id INTEGER PRIMARY KEY, rig_id INTEGER);"
      "INSERT INTO frames VALUES (1, 11), (2, 12), (3, 13);"
      "CREATE TABLE pose_priors (pose_prior_id INTEGER, corr_data_id INTEGER, corr_sensor_type INTEGER);"
      "INSERT INTO pose_priors VALUES (9, 7, 0);");
  NumberImagesByName(path);
  EXPECT_EQ(Sqlite(path).Rows("SELECT frame_id, name FROM frame_data JOIN images ON data_id = image_id ORDER BY 1"),
            (Rows{"1|camera0/a.png", "2|camera0/b.png", "3|camera1/c.png"}));
  EXPECT_EQ(Sqlite(path).Rows("SELECT frame_id, rig_id FROM frames ORDER BY 1"), (Rows{"1|13", "2|11", "3|12"}));
  EXPECT_EQ(Sqlite(path).Rows("SELECT name FROM pose_priors JOIN images ON corr_data_id = image_id"),
            (Rows{"camera0/a.png"}));
}

TEST(NumberImagesByName, KeepsNumbersOnFailure) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  Sqlite(path).Execute("DROP TABLE descriptors");  // found missing after images and keypoints have new numbers
  EXPECT_THAT(MessageOf<RunError>([&] { NumberImagesByName(path); }), HasSubstr("no such table: descriptors"));
  EXPECT_EQ(Sqlite(path).Rows("SELECT image_id FROM images ORDER BY name"), (Rows{"7", "1", "2"}));
  EXPECT_EQ(Sqlite(path).Rows("SELECT image_id FROM keypoints ORDER BY rows"), (Rows{"1", "2", "7"}));
}

TEST(ColmapDatabase, RefusesAMissingFile) {
  const TempDir dir;
  ExpectRefused(dir / "database.db", "was not written by colmap");
  EXPECT_FALSE(fs::exists(dir / "database.db"));
}

TEST(ColmapDatabase, RefusesAFileOfAnotherKind) {
  const TempDir dir;
  std::ofstream(dir / "database.db") << std::string(5000, 'x');
  ExpectRefused(dir / "database.db", "not a database");
  fs::create_directories(dir / "folder");
  ExpectRefused(dir / "folder", "unable to open");
}

TEST(ColmapDatabase, RefusesAnEmptyFile) {
  const TempDir dir;
  std::ofstream(dir / "database.db").flush();
  ExpectRefused(dir / "database.db", "no such table");
}

TEST(ColmapDatabase, RefusesATruncatedFile) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  fs::resize_file(path, 3000);
  ExpectRefused(path, "malformed");
}

TEST(ColmapDatabase, RefusesDamage) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  const auto size = fs::file_size(path);
  ASSERT_GT(size, 4096u);  // the first page holds the schema
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(4096);
  file << std::string(size - 4096, '\xEE');
  file.close();
  ExpectRefused(path, "malformed");
}

TEST(ColmapDatabase, RefusesALockedFile) {
  const TempDir dir;
  const fs::path path = WriteDatabase(dir);
  {
    const Sqlite other(path);
    other.Execute("BEGIN EXCLUSIVE");
    ExpectRefused(path, "locked");
    other.Execute("ROLLBACK");
  }
  EXPECT_EQ(ReadDatabaseImages(path).size(), 3u) << "unlocked, and as it was";
  EXPECT_EQ(Sqlite(path).Rows("SELECT model FROM cameras"), (Rows{"0", "0"}));
}

}  // namespace
}  // namespace oraclegs
