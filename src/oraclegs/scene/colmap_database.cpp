#include "oraclegs/scene/colmap_database.h"

#include <sqlite3.h>

#include <memory>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// An open database; its errors name the file.
class Database {
 public:
  explicit Database(const fs::path& path) : path_(path) {
    sqlite3* raw = nullptr;
    const int code = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READWRITE, nullptr);
    handle_.reset(raw);
    if (code != SQLITE_OK) Fail();
  }

  [[noreturn]] void Fail() const {
    throw RunError("{}: {}; delete it, colmap makes it anew", path_.string(),
                   handle_ ? sqlite3_errmsg(handle_.get()) : "cannot be opened");
  }

  void Execute(const char* sql) const {
    if (sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) Fail();
  }

  sqlite3* get() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  fs::path path_;
  std::unique_ptr<sqlite3, Close> handle_;
};

class Statement {
 public:
  Statement(const Database& database, const char* sql) : database_(database) {
    sqlite3_stmt* raw = nullptr;
    if (sqlite3_prepare_v2(database.get(), sql, -1, &raw, nullptr) != SQLITE_OK) database.Fail();
    handle_.reset(raw);
  }

  /// True while there is a row.
  bool Step() const {
    const int code = sqlite3_step(handle_.get());
    if (code != SQLITE_ROW && code != SQLITE_DONE) database_.Fail();
    return code == SQLITE_ROW;
  }

  sqlite3_stmt* get() const { return handle_.get(); }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }
  };
  const Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

}  // namespace

std::map<std::string, DatabaseImage> ReadDatabaseImages(const fs::path& database) {
  const Database open(database);
  const Statement rows(open, "SELECT image_id, name, camera_id FROM images");
  std::map<std::string, DatabaseImage> images;
  while (rows.Step()) {
    const auto* name = reinterpret_cast<const char*>(sqlite3_column_text(rows.get(), 1));
    if (name == nullptr) continue;
    images[name] = {static_cast<uint32_t>(sqlite3_column_int64(rows.get(), 0)),
                    static_cast<uint32_t>(sqlite3_column_int64(rows.get(), 2))};
  }
  return images;
}

void SetDatabaseCameras(const fs::path& database, const std::map<uint32_t, Lens>& cameras) {
  const Database open(database);
  open.Execute("BEGIN");
  for (const auto& [id, lens] : cameras) {
    const Statement update(open,
                           "UPDATE cameras SET model = ?1, width = ?2, height = ?3, params = ?4, "
                           "prior_focal_length = 1 WHERE camera_id = ?5");
    sqlite3_bind_int(update.get(), 1, static_cast<int>(lens.model));
    sqlite3_bind_int(update.get(), 2, lens.width);
    sqlite3_bind_int(update.get(), 3, lens.height);
    sqlite3_bind_blob(update.get(), 4, lens.params.data(), static_cast<int>(lens.params.size() * sizeof(double)),
                      SQLITE_STATIC);
    sqlite3_bind_int64(update.get(), 5, id);
    update.Step();
  }
  open.Execute("COMMIT");
}

void NumberImagesByName(const fs::path& database) {
  constexpr int64_t kOutOfTheWay = int64_t{1} << 30;  // colmap allows ids up to 2^31 - 2
  const auto images = ReadDatabaseImages(database);
  const Database open(database);
  open.Execute("BEGIN");
  for (const char* table : {"images", "keypoints", "descriptors"}) {
    open.Execute(fmt::format("UPDATE {} SET image_id = image_id + {}", table, kOutOfTheWay).c_str());
    int64_t number = 0;
    for (const auto& [name, image] : images) {
      open.Execute(
          fmt::format("UPDATE {} SET image_id = {} WHERE image_id = {}", table, ++number, image.image_id + kOutOfTheWay)
              .c_str());
    }
  }
  open.Execute("COMMIT");
}

}  // namespace oraclegs
