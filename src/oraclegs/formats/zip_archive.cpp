#include "oraclegs/formats/zip_archive.h"

#include <zip.h>

#include <algorithm>
#include <memory>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr uint16_t kZipDate = (2020 - 1980) << 9 | 1 << 5 | 1;  // of every file: the bytes must not depend on the clock
constexpr size_t kMostGrowth = 4, kFreeGrowth = size_t{1} << 22;  // images and short texts shrink by no more
constexpr size_t kZipFileHeader = 30, kZipFieldHeader = 4;        // before a file's name, and before its extra field
constexpr uint16_t kZipPadding = 0x1986;                          // a field that means nothing
constexpr size_t kZipStep = size_t{1} << 16;

struct DiscardZip {
  void operator()(zip_t* zip) const { zip_discard(zip); }
};
struct CloseZipFile {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
struct FreeZipSource {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};
using ZipPointer = std::unique_ptr<zip_t, DiscardZip>;
using ZipFilePointer = std::unique_ptr<zip_file_t, CloseZipFile>;
using ZipSourcePointer = std::unique_ptr<zip_source_t, FreeZipSource>;

[[noreturn]] void FailToWrite() { throw RunError("libzip: cannot write the archive; is there enough memory?"); }

}  // namespace

std::string WriteZip(const std::vector<std::pair<std::string, std::string>>& files, size_t alignment) {
  const ZipSourcePointer memory(zip_source_buffer_create(nullptr, 0, 0, nullptr));
  if (memory == nullptr) FailToWrite();
  zip_source_keep(memory.get());  // one more owner: the archive gives its own up when it is closed
  ZipPointer zip(zip_open_from_source(memory.get(), ZIP_TRUNCATE, nullptr));
  if (zip == nullptr) {
    zip_source_free(memory.get());
    FailToWrite();
  }
  size_t written = 0;
  for (const auto& [name, bytes] : files) {
    zip_source_t* source = zip_source_buffer(zip.get(), bytes.data(), bytes.size(), 0);
    const zip_int64_t index = source == nullptr ? -1 : zip_file_add(zip.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) zip_source_free(source);
    const auto entry = static_cast<zip_uint64_t>(index);
    if (index < 0 || zip_set_file_compression(zip.get(), entry, ZIP_CM_STORE, 0) != 0 ||
        zip_file_set_dostime(zip.get(), entry, 0, kZipDate, 0) != 0) {
      FailToWrite();
    }
    if (alignment > 1) {
      written += kZipFileHeader + name.size() + kZipFieldHeader;
      const std::string padding((alignment - written % alignment) % alignment, '\0');
      if (zip_file_extra_field_set(zip.get(), entry, kZipPadding, ZIP_EXTRA_FIELD_NEW,
                                   reinterpret_cast<const zip_uint8_t*>(padding.data()),
                                   static_cast<zip_uint16_t>(padding.size()), ZIP_FL_LOCAL) != 0) {
        FailToWrite();
      }
      written += padding.size() + bytes.size();
    }
  }
  if (zip_close(zip.get()) != 0) FailToWrite();
  (void)zip.release();  // closed
  std::string archive;
  zip_stat_t stat;
  if (zip_source_stat(memory.get(), &stat) != 0 || zip_source_open(memory.get()) != 0) FailToWrite();
  archive.resize(stat.size);
  const bool whole = zip_source_read(memory.get(), archive.data(), stat.size) == static_cast<zip_int64_t>(stat.size);
  zip_source_close(memory.get());
  if (!whole) FailToWrite();
  return archive;
}

std::map<std::string, std::string> ReadZip(std::string_view bytes, int64_t max_files, const std::string& archive) {
  if (bytes.empty())
    throw InputError("{}: is empty; copy or export it again", archive);  // libzip takes it for an archive
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, nullptr);
  if (source == nullptr) throw OutOfMemory("{}: no memory to read it", archive);
  const ZipPointer zip(zip_open_from_source(source, ZIP_RDONLY, nullptr));
  if (zip == nullptr) {
    zip_source_free(source);
    throw InputError("{}: is not a zip archive, or is cut short; copy or export it again", archive);
  }
  const zip_int64_t count = zip_get_num_entries(zip.get(), 0);
  if (count > max_files) {
    throw InputError("{}: has {} files, expected at most {}; is it a splat?", archive, count, max_files);
  }
  std::map<std::string, std::string> files;
  size_t left = kMostGrowth * bytes.size() + kFreeGrowth;
  std::string piece(kZipStep, '\0');
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(zip.get(), static_cast<zip_uint64_t>(i), 0);
    const ZipFilePointer file(name == nullptr ? nullptr : zip_fopen_index(zip.get(), static_cast<zip_uint64_t>(i), 0));
    if (file == nullptr) throw InputError("{}: its file {} cannot be unpacked; export it again", archive, i);
    std::string& content = files[name];
    content.clear();
    zip_int64_t read = 0;
    while ((read = zip_fread(file.get(), piece.data(), piece.size())) > 0) {
      if (static_cast<size_t>(read) > left) {
        throw InputError("{}: is many times larger unpacked than packed; it is no splat", archive);
      }
      left -= static_cast<size_t>(read);
      content.append(piece.data(), static_cast<size_t>(read));
    }
    if (read < 0) throw InputError("{}: its file '{}' is damaged; copy or export it again", archive, name);
  }
  return files;
}

}  // namespace oraclegs
