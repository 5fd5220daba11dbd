#include "oraclegs/sfm/database_file.h"

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {

DatabaseFile::DatabaseFile(const std::filesystem::path& path) : path_(path) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READWRITE, nullptr);
  handle_.reset(raw);
  if (code != SQLITE_OK) Fail();
}

void DatabaseFile::Fail() const {
  std::error_code ignored;
  if (!std::filesystem::exists(path_, ignored)) {
    throw RunError("{}: was not written by colmap; see that colmap works, and run the same command again",
                   path_.string());
  }
  const int code = handle_ ? sqlite3_errcode(handle_.get()) : SQLITE_CANTOPEN;
  const bool is_damaged = code == SQLITE_CORRUPT || code == SQLITE_NOTADB || code == SQLITE_ERROR;
  throw RunError("{}: {}; {}run the same command again", path_.string(),
                 handle_ ? sqlite3_errmsg(handle_.get()) : "cannot be opened",
                 code == SQLITE_FULL ? "make room on the disk, and "
                 : is_damaged        ? "colmap makes it anew: "
                                     : "check the disk, make room there, see the rights of the folder, and ");
}

void DatabaseFile::Execute(const char* sql) const {
  if (sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) Fail();
}

DatabaseStatement::DatabaseStatement(const DatabaseFile& database, const char* sql) : database_(database) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database.get(), sql, -1, &raw, nullptr) != SQLITE_OK) database.Fail();
  handle_.reset(raw);
}

bool DatabaseStatement::Step() const {
  const int code = sqlite3_step(handle_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_.Fail();
  return code == SQLITE_ROW;
}

void RemoveDatabase(const std::filesystem::path& database) {
  for (const char* end : {"", "-wal", "-shm", "-journal"}) {
    std::error_code error;
    std::filesystem::remove(database.string() + end, error);
    if (error) throw RunError("{}: cannot be removed: {}", database.string(), SystemReason(error));
  }
}

void CopyDatabase(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, error);
  if (error) throw RunError("{}: cannot be copied to {}: {}", from.string(), to.string(), SystemReason(error));
}

}  // namespace oraclegs
