#pragma once
// The table of contents of a zip whose parts are stored as they are, which is the container of PyTorch's checkpoints.
// Our own, because what is wanted is where in the mapped file a part's bytes lie: libzip does not say that, minizip
// only of a part that it has opened, through functions for reading a file that would be as long as this reader.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

class ZipDirectory {
 public:
  /// `bytes`: the whole file, which must outlive this; `file`: its name for errors. Reads zip and zip64. No number of
  /// the file is believed before it is compared with the file's length. Throws InputError.
  ZipDirectory(std::string_view bytes, const std::string& file);

  bool Has(const std::string& name) const { return entries_.count(name) > 0; }
  /// The names, in their order.
  std::vector<std::string> Names() const;
  /// The bytes of a part. Throws InputError when it is missing, compressed, encrypted or cut off.
  std::string_view Content(const std::string& name) const;

 private:
  struct Entry {
    uint64_t header = 0, stored = 0, size = 0;  ///< place of its own header, bytes in the file, bytes of the content
    bool plain = false;                         ///< neither compressed nor encrypted
  };
  struct Table {
    uint64_t begin = 0, bytes = 0, entries = 0;
  };
  [[noreturn]] void Damaged() const;
  uint64_t Number(uint64_t at, size_t width) const;
  Table FindTable() const;
  /// Reads the entry at `*at`, which moves behind it.
  void ReadEntry(uint64_t* at, uint64_t end);

  std::string_view bytes_;
  std::string file_;
  std::map<std::string, Entry> entries_;
};

}  // namespace oraclegs
