// COLMAP's database.db: a file of SQLite as it is, or rows of the tables that are read, out of the bytes.

#include <sqlite3.h>

#include "fuzz/fuzz.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/matched_features.h"

namespace {

using oraclegs::fuzz::Bytes;

constexpr const char* kColmapTables =
    "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;"
    "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY, model, width, height, params, prior_focal_length);"
    "CREATE TABLE images (image_id INTEGER PRIMARY KEY, name, camera_id);"
    "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows, cols, data);"
    "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY, rows, cols, data);"
    "CREATE TABLE matches (pair_id INTEGER PRIMARY KEY, rows, cols, data);"
    "CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY, rows, cols, data, config, F, E, H);";

struct ColmapInsert {
  const char* sql;
  int columns;
};
constexpr ColmapInsert kColmapInserts[] = {
    {"INSERT OR IGNORE INTO cameras VALUES (?1, ?2, ?3, ?4, ?5, ?6)", 6},
    {"INSERT OR IGNORE INTO images VALUES (?1, ?2, ?3)", 3},
    {"INSERT OR IGNORE INTO keypoints VALUES (?1, ?2, ?3, ?4)", 4},
    {"INSERT OR IGNORE INTO matches VALUES (?1, ?2, ?3, ?4)", 4},
    {"INSERT OR IGNORE INTO two_view_geometries VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)", 8}};

/// A small number, any number, a real number, a text, a blob, or nothing.
void BindColmapValue(sqlite3_stmt* row, int column, Bytes* bytes) {
  const auto kind = bytes->Take<uint8_t>();
  switch (kind % 6) {
    case 0:
      sqlite3_bind_int(row, column, kind / 6);
      break;
    case 1:
      sqlite3_bind_int64(row, column, bytes->Take<int64_t>());
      break;
    case 2:
      sqlite3_bind_double(row, column, bytes->Take<double>());
      break;
    case 3:
    case 4: {
      const std::string_view text = bytes->Text(bytes->Take<uint8_t>());
      const auto size = static_cast<int>(text.size());
      if (kind % 6 == 3) sqlite3_bind_text(row, column, text.data(), size, SQLITE_TRANSIENT);
      if (kind % 6 == 4) sqlite3_bind_blob(row, column, text.data(), size, SQLITE_TRANSIENT);
      break;
    }
    default:
      sqlite3_bind_null(row, column);
  }
}

void FillColmapDatabase(const std::filesystem::path& path, std::string_view rows) {
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  sqlite3_exec(database, kColmapTables, nullptr, nullptr, nullptr);
  sqlite3_exec(database, "BEGIN", nullptr, nullptr, nullptr);
  Bytes bytes(rows);
  for (int i = 0; i < 64 && !bytes.empty(); ++i) {
    const ColmapInsert& insert = kColmapInserts[bytes.Take<uint8_t>() % std::size(kColmapInserts)];
    sqlite3_stmt* row = nullptr;
    sqlite3_prepare_v2(database, insert.sql, -1, &row, nullptr);
    for (int column = 1; column <= insert.columns; ++column) BindColmapValue(row, column, &bytes);
    sqlite3_step(row);
    sqlite3_finalize(row);
  }
  sqlite3_exec(database, "COMMIT", nullptr, nullptr, nullptr);
  sqlite3_close(database);
}

template <class Body>
void TryDatabase(const Body& body) {
  oraclegs::fuzz::Try<oraclegs::RunError>(body);
}

}  // namespace

ORACLEGS_FUZZ_TARGET(database) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  const bool is_file = bytes.starts_with("SQLite format 3");
  const auto path = folder.Put("database.db", is_file ? bytes : std::string_view());
  if (!is_file) FillColmapDatabase(path, bytes);
  TryDatabase([&] { ReadDatabaseImages(path); });
  TryDatabase([&] { ReadFeatureCounts(path); });
  TryDatabase([&] {
    for (const MatchedPair& pair : ReadMatchedPairs(path)) ReadInliers(path, pair.first, pair.second);
  });
  TryDatabase([&] { ReadVerifiedMatches(path); });
  if (is_file) return;  // what writes goes through the disk several times
  TryDatabase([&] { SetFocalPriors(path, {{"a.jpg", 100.}}); });
  TryDatabase([&] { SetFocalGuess(path, 1.2); });
}
