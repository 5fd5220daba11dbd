#include "oraclegs/capture/zip_photos.h"

#include <zip.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/system_reason.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/photo_folder.h"
#include "oraclegs/scene/photo_kind.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxUnpacked = uint64_t{1} << 35;  // what 500 photos may have, and no bomb
constexpr size_t kPieceBytes = size_t{1} << 16;
constexpr char kHelperReason[] =
    "masks and smaller copies are not taken out of archives; unpack the archive and name its folder";

struct CloseArchive {
  void operator()(zip_t* zip) const { zip_discard(zip); }
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using Archive = std::unique_ptr<zip_t, CloseArchive>;

Archive OpenArchive(const fs::path& path) {
  int code = 0;
  Archive archive(zip_open(path.c_str(), ZIP_RDONLY, &code));
  if (!archive) {
    throw InputError("{}: is a damaged or incomplete zip archive; copy it again, or unpack it and name the folder",
                     path.string());
  }
  return archive;
}

/// The path below the target folder: no "..", no root, no hidden parts; empty when nothing is left, or for what a Mac
/// adds.
fs::path SafePath(const std::string& name) {
  fs::path safe;
  for (const std::string& part : SplitTrimmed(name, '/')) {
    if (part == "__MACOSX" || part.starts_with(".")) {
      if (part == ".." || part == ".") continue;
      return {};
    }
    std::string plain = part;
    for (char& c : plain) {
      if (c == '\\' || static_cast<unsigned char>(c) < ' ') c = '_';
    }
    safe /= plain;
  }
  return safe;
}

struct Entry {
  fs::path path;
  zip_uint64_t index;
};

/// By where they go, each to a place of its own: another name where two have the same, or a folder has it.
std::map<fs::path, zip_uint64_t> WithFreeNames(const std::vector<Entry>& entries) {
  std::set<fs::path> folders;
  for (const Entry& entry : entries) {
    for (fs::path at = entry.path.parent_path(); !at.empty(); at = at.parent_path()) folders.insert(at);
  }
  std::map<fs::path, zip_uint64_t> photos;
  for (const auto& [path, index] : entries) {
    fs::path free = path;
    for (int n = 2; folders.count(free) > 0 || !photos.emplace(free, index).second; ++n) {
      free = path.parent_path() / fmt::format("{}-{}{}", path.stem().string(), n, path.extension().string());
    }
  }
  return photos;
}

/// Indices of the archive's photos by where they go. What is not read is noted by reason.
std::map<fs::path, zip_uint64_t> ListPhotos(zip_t* zip, std::map<std::string, std::vector<std::string>>* skipped) {
  std::vector<Entry> photos;
  const zip_int64_t count = zip_get_num_entries(zip, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const auto index = static_cast<zip_uint64_t>(i);
    const char* name = zip_get_name(zip, index, ZIP_FL_ENC_GUESS);
    if (name == nullptr || *name == '\0' || std::string_view(name).ends_with('/')) continue;
    const fs::path path = SafePath(name);
    if (path.empty()) continue;
    if (std::any_of(path.begin(), std::prev(path.end()),
                    [](const fs::path& p) { return IsHelperFolder(p.string()); })) {
      (*skipped)[kHelperReason].push_back(OneLine(path.generic_string()));
      continue;
    }
    if (HasImageExtension(path)) {
      photos.push_back({path, index});
    } else if (const std::string why = WhyNotRead(path); !why.empty()) {
      (*skipped)[why].push_back(OneLine(path.generic_string()));
    }
  }
  return WithFreeNames(photos);
}

}  // namespace

bool IsZip(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string head(4, '\0');
  file.read(head.data(), 4);
  return head == std::string("PK\3\4", 4) || head == std::string("PK\5\6", 4);
}

int CountZipPhotos(const fs::path& path) {
  const Archive archive = OpenArchive(path);
  std::map<std::string, std::vector<std::string>> skipped;
  const auto photos = ListPhotos(archive.get(), &skipped);
  if (photos.empty()) {
    throw InputError("{}: holds no photos{}; expected JPEG, PNG, HEIC, AVIF, WebP or TIFF files", path.string(),
                     skipped.empty() ? "" : fmt::format(" ({})", skipped.begin()->first));
  }
  if (photos.size() > static_cast<size_t>(kMaxPhotos)) {
    throw InputError(
        "{}: holds {} photos, and at most {} without poses can be put together; unpack it and copy some of "
        "them to a folder of their own",
        path.string(), photos.size(), kMaxPhotos);
  }
  for (const auto& [name, index] : photos) {
    zip_stat_t stat;
    const bool known = zip_stat_index(archive.get(), index, 0, &stat) == 0;
    if (known && (stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE) {
      throw InputError("{}: is encrypted; unpack it and name the folder", path.string());
    }
  }
  return static_cast<int>(photos.size());
}

void UnpackPhotos(const fs::path& path, const fs::path& dir, const Listener& listener) {
  const Archive archive = OpenArchive(path);
  std::map<std::string, std::vector<std::string>> skipped;
  uint64_t left = kMaxUnpacked;
  std::string piece(kPieceBytes, '\0');
  for (const auto& [name, index] : ListPhotos(archive.get(), &skipped)) {
    const std::unique_ptr<zip_file_t, CloseArchive> file(zip_fopen_index(archive.get(), index, 0));
    if (!file) {
      throw InputError("{}: {} cannot be unpacked; copy the archive again, or unpack it and name the folder",
                       path.string(), OneLine(name.string()));
    }
    const fs::path target = dir / name;
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    if (error) throw RunError("{}: cannot be made: {}", target.parent_path().string(), SystemReason(error));
    AtomicFile out(target);
    zip_int64_t read = 0;
    while ((read = zip_fread(file.get(), piece.data(), piece.size())) > 0) {
      if (static_cast<uint64_t>(read) > left) {
        throw InputError("{}: unpacks to more than {:.0f} GB; unpack it and name a folder with fewer photos",
                         path.string(), Gigabytes(static_cast<int64_t>(kMaxUnpacked)));
      }
      left -= static_cast<uint64_t>(read);
      out.Append(std::string_view(piece.data(), static_cast<size_t>(read)));
    }
    if (read < 0) {
      throw InputError("{}: {} is damaged in it; copy the archive again", path.string(), OneLine(name.string()));
    }
    out.FinishUnflushed();
  }
  for (const auto& [why, names] : skipped) {
    listener(Warning{fmt::format("{}: {}: {}", path.string(), SomeNames(names), why)});
  }
}

}  // namespace oraclegs
