#include "oraclegs/weights/checkpoint/zip_directory.h"

#include <algorithm>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

// Sizes of the records, and the numbers that stand for "see the wide one".
constexpr uint64_t kEndBytes = 22, kLocatorBytes = 20, kWideEndBytes = 56, kEntryBytes = 46, kHeaderBytes = 30;
constexpr uint64_t kMaxComment = 65'535, kSeeWide16 = 0xffff, kSeeWide32 = 0xffffffff;
constexpr std::string_view kEndMark("PK\5\6", 4), kLocatorMark("PK\6\7", 4), kWideEndMark("PK\6\6", 4),
    kEntryMark("PK\1\2", 4), kHeaderMark("PK\3\4", 4);
constexpr uint64_t kWideExtra = 1;  // the id of the extra field that holds the wide numbers

}  // namespace

ZipDirectory::ZipDirectory(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {
  const Table table = FindTable();
  uint64_t at = table.begin;
  for (uint64_t i = 0; i < table.entries; ++i) ReadEntry(&at, table.begin + table.bytes);
}

std::vector<std::string> ZipDirectory::Names() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : entries_) names.push_back(name);
  return names;
}

void ZipDirectory::Damaged() const { throw InputError("{}: is a damaged zip; get the file again", file_); }

uint64_t ZipDirectory::Number(uint64_t at, size_t width) const {
  if (at > bytes_.size() || width > bytes_.size() - at) Damaged();
  uint64_t number = 0;
  for (size_t i = 0; i < width; ++i) number |= uint64_t{static_cast<uint8_t>(bytes_[at + i])} << (8 * i);
  return number;
}

ZipDirectory::Table ZipDirectory::FindTable() const {
  // The record at the end is followed by a comment, so it is looked for from the back.
  const uint64_t size = bytes_.size();
  if (size < kEndBytes) Damaged();
  uint64_t end = size - kEndBytes;
  const uint64_t first = end > kMaxComment ? end - kMaxComment : 0;
  while (bytes_.substr(end, 4) != kEndMark || Number(end + 20, 2) != size - end - kEndBytes) {
    if (end == first) throw InputError("{}: is a zip that is cut off; get the file again", file_);
    --end;
  }
  Table table{Number(end + 16, 4), Number(end + 12, 4), Number(end + 10, 2)};
  uint64_t disk = Number(end + 4, 2);
  uint64_t limit = end;
  const uint64_t locator = end - std::min(end, kLocatorBytes);
  if (end >= kLocatorBytes && bytes_.substr(locator, 4) == kLocatorMark) {
    const uint64_t wide = Number(locator + 8, 8);
    if (wide > locator || locator - wide < kWideEndBytes || bytes_.substr(wide, 4) != kWideEndMark) Damaged();
    table = {Number(wide + 48, 8), Number(wide + 40, 8), Number(wide + 32, 8)};
    disk = Number(wide + 16, 4);
    limit = wide;
  }
  if (disk != 0 && disk != kSeeWide16) throw InputError("{}: is one part of a divided zip; join the parts", file_);
  if (table.begin > limit || table.bytes > limit - table.begin || table.entries > table.bytes / kEntryBytes) Damaged();
  return table;
}

void ZipDirectory::ReadEntry(uint64_t* at, uint64_t end) {
  if (end - *at < kEntryBytes || bytes_.substr(*at, 4) != kEntryMark) Damaged();
  const uint64_t flags = Number(*at + 8, 2), method = Number(*at + 10, 2);
  Entry entry{Number(*at + 42, 4), Number(*at + 20, 4), Number(*at + 24, 4), method == 0 && (flags & 1) == 0};
  const uint64_t name_bytes = Number(*at + 28, 2), extra_bytes = Number(*at + 30, 2);
  const uint64_t name_at = *at + kEntryBytes, next = name_at + name_bytes + extra_bytes + Number(*at + 32, 2);
  if (next > end) Damaged();
  uint64_t extra = name_at + name_bytes;
  const uint64_t extra_end = extra + extra_bytes;
  while (extra_end - extra >= 4) {
    const uint64_t id = Number(extra, 2), length = Number(extra + 2, 2);
    extra += 4;
    if (length > extra_end - extra) Damaged();
    // Only the numbers that the entry has no room for are here, in this order.
    uint64_t wide = extra;
    for (uint64_t* number : {&entry.size, &entry.stored, &entry.header}) {
      if (id != kWideExtra || *number != kSeeWide32) continue;
      if (extra + length - wide < 8) Damaged();
      *number = Number(wide, 8);
      wide += 8;
    }
    extra += length;
  }
  const std::string name(bytes_.substr(name_at, name_bytes));
  if (!entries_.emplace(name, entry).second) {
    throw InputError("{}: is a zip with two parts '{}'; get the file again", file_, Printable(name, 60));
  }
  *at = next;
}

std::string_view ZipDirectory::Content(const std::string& name) const {
  const auto it = entries_.find(name);
  if (it == entries_.end()) {
    throw InputError("{}: lacks its part '{}'; the file is incomplete, get it again", file_, Printable(name, 60));
  }
  const Entry& entry = it->second;
  const bool fits = entry.header <= bytes_.size() && bytes_.size() - entry.header >= kHeaderBytes &&
                    bytes_.substr(entry.header, 4) == kHeaderMark;
  if (!fits || !entry.plain || entry.stored != entry.size) {
    throw InputError("{}: its part '{}' is compressed or damaged; save the file with PyTorch again", file_,
                     Printable(name, 60));
  }
  const uint64_t begin = entry.header + kHeaderBytes + Number(entry.header + 26, 2) + Number(entry.header + 28, 2);
  if (begin > bytes_.size() || entry.size > bytes_.size() - begin) {
    throw InputError("{}: its part '{}' is cut off; get the file again", file_, Printable(name, 60));
  }
  return bytes_.substr(begin, entry.size);
}

}  // namespace oraclegs
