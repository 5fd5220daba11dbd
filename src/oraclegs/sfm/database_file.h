#pragma once
// COLMAP's SQLite database, opened: statements, and blobs as lists of numbers.

#include <sqlite3.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

namespace oraclegs {

inline constexpr int64_t kPairBase = 2147483647;  ///< colmap's pair id is kPairBase * first + second, first < second

inline int64_t PairId(uint32_t a, uint32_t b) { return kPairBase * std::min(a, b) + std::max(a, b); }

/// An open database; its errors name the file.
class DatabaseFile {
 public:
  /// Throws RunError.
  explicit DatabaseFile(const std::filesystem::path& path);

  /// Throws the RunError of the last call.
  [[noreturn]] void Fail() const;
  void Execute(const char* sql) const;
  sqlite3* get() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  std::filesystem::path path_;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// A statement of it, with the parameters ?1, ?2, ... that sqlite3_bind_* sets.
class DatabaseStatement {
 public:
  DatabaseStatement(const DatabaseFile& database, const char* sql);

  /// True while there is a row.
  bool Step() const;
  sqlite3_stmt* get() const { return handle_.get(); }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }
  };
  const DatabaseFile& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

/// Column `column`, a blob, as a list of `rows` x `columns` numbers; empty when it has another size.
template <class T>
std::vector<T> GetList(sqlite3_stmt* row, int column, int64_t rows, int64_t columns) {
  const void* bytes = sqlite3_column_blob(row, column);
  const int64_t size = sqlite3_column_bytes(row, column);
  if (bytes == nullptr || rows <= 0 || columns <= 0 || columns > size || rows > size ||
      size != rows * columns * static_cast<int64_t>(sizeof(T))) {
    return {};
  }
  std::vector<T> list(static_cast<size_t>(rows * columns));
  std::memcpy(list.data(), bytes, static_cast<size_t>(size));
  return list;
}

/// A count in a column; what cannot be one is brought to the nearest that can.
inline int GetCount(sqlite3_stmt* row, int column) {
  return static_cast<int>(std::clamp<int64_t>(sqlite3_column_int64(row, column), 0, kPairBase));
}

/// Removes a database with what SQLite keeps beside it, where it is. Throws RunError.
void RemoveDatabase(const std::filesystem::path& database);

/// Copies a database that nobody has open over what is at `to`. Throws RunError.
void CopyDatabase(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace oraclegs
