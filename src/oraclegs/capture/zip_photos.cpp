#include "oraclegs/capture/zip_photos.h"

#include <zip.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "oraclegs/capture/free_names.h"
#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/photo_folder.h"
#include "oraclegs/scene/photo_kind.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

// Photos are compressed already; images without compression shrink some.
constexpr uint64_t kMaxGrowth = 4, kGrowthAllowance = uint64_t{64} << 20;
constexpr uint64_t kMaxEntryBytes = uint64_t{1} << 31;  // as of an image file
constexpr size_t kMaxNameBytes = 1024;
constexpr size_t kPieceBytes = size_t{1} << 16;
constexpr char kHelperReason[] =
    "masks, depth maps and smaller copies are not taken out of archives; unpack the archive and name its folder";

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

struct ZipPhoto {
  fs::path path;
  zip_uint64_t index;
  uint64_t bytes;  ///< as the archive says
};

using Skipped = std::map<std::string, std::vector<std::string>>;  ///< names by reason

/// True when an entry is no photo by its content or, where it cannot be opened, by its name.
bool IsNoImage(zip_t* zip, const ZipPhoto& photo) {
  const std::unique_ptr<zip_file_t, CloseArchive> file(zip_fopen_index(zip, photo.index, 0));
  std::string head(kImageHeadBytes, '\0');
  const zip_int64_t read = file ? zip_fread(file.get(), head.data(), head.size()) : -1;
  if (read < 0) return !HasImageExtension(photo.path);
  return !IsPhotoByContent(photo.path, std::string_view(head).substr(0, static_cast<size_t>(read)));
}

void RefuseTooMany(const fs::path& archive, size_t photos) {
  if (photos <= static_cast<size_t>(kMaxPhotos)) return;
  throw InputError(
      "{}: holds {} photos, and at most {} without poses can be put together; unpack it and copy some of them to a "
      "folder of their own",
      archive.string(), photos, kMaxPhotos);
}

[[noreturn]] void RefuseGrowth(const fs::path& archive, uint64_t packed) {
  throw InputError(
      "{}: unpacks to more than {:.1f} GB, though it has {:.1f} MB; if you trust it, unpack it and name "
      "the folder",
      archive.string(), Gigabytes(static_cast<int64_t>(kMaxGrowth * packed + kGrowthAllowance)),
      1e-6 * static_cast<double>(packed));
}

/// Gives each a place of its own: another name where two have the same, or a folder has it.
void GiveFreeNames(std::vector<ZipPhoto>* photos) {
  FreeNames names;
  for (const ZipPhoto& photo : *photos) {
    for (fs::path at = photo.path.parent_path(); !at.empty(); at = at.parent_path()) names.Block(at);
  }
  for (ZipPhoto& photo : *photos) photo.path = names.Take(photo.path);
}

/// The one folder at the top that all photos lie in, by their names; else empty.
fs::path SharedTop(zip_t* zip) {
  fs::path top;
  const zip_int64_t count = zip_get_num_entries(zip, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(zip, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_GUESS);
    if (name == nullptr || std::string_view(name).size() > kMaxNameBytes) continue;
    const fs::path path = SafePath(name);
    if (!HasImageExtension(path)) continue;
    if (!path.has_parent_path() || (!top.empty() && *path.begin() != top)) return {};
    top = *path.begin();
  }
  return top;
}

/// The archive's photos by where they go. Files that are not read are noted by reason.
std::vector<ZipPhoto> ListPhotos(const fs::path& archive, zip_t* zip, Skipped* skipped) {
  std::vector<ZipPhoto> photos;
  size_t named = 0;
  const zip_int64_t count = zip_get_num_entries(zip, 0);
  const fs::path top = SharedTop(zip);
  const bool renames_top = IsHelperFolder(top.string());
  for (zip_int64_t i = 0; i < count; ++i) {
    ThrowIfInterrupted();
    zip_stat_t stat;
    const char* name = zip_get_name(zip, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_GUESS);
    if (name == nullptr || *name == '\0' || std::string_view(name).ends_with('/')) continue;
    if (std::string_view(name).size() > kMaxNameBytes || zip_stat_index(zip, static_cast<zip_uint64_t>(i), 0, &stat)) {
      continue;
    }
    fs::path path = SafePath(name);
    if (path.empty()) continue;
    if (renames_top && *path.begin() == top) path = "_" + path.native();  // found again by that, whatever it is called
    if (std::any_of(path.begin(), std::prev(path.end()),
                    [](const fs::path& p) { return IsHelperFolder(p.string()); })) {
      (*skipped)[kHelperReason].push_back(OneLine(path.generic_string()));
      continue;
    }
    named += HasImageExtension(path);
    photos.push_back({path, stat.index, (stat.valid & ZIP_STAT_SIZE) != 0 ? stat.size : 0});
  }
  RefuseTooMany(archive, named);
  std::erase_if(photos, [&](const ZipPhoto& photo) {
    ThrowIfInterrupted();
    if (!IsNoImage(zip, photo)) return false;
    std::string why = WhyNotRead(photo.path);
    if (HasImageExtension(photo.path)) why = "is no image, whatever its name says; it is left out";
    if (!why.empty()) (*skipped)[why].push_back(OneLine(photo.path.generic_string()));
    return true;
  });
  RefuseTooMany(archive, photos.size());
  GiveFreeNames(&photos);
  return photos;
}

/// Bytes of the archive. Throws InputError when its photos, by what it says, are larger than photos can be.
uint64_t CheckedSize(const fs::path& archive, const std::vector<ZipPhoto>& photos) {
  std::error_code error;
  const uint64_t packed = fs::file_size(archive, error);
  uint64_t left = kMaxGrowth * packed + kGrowthAllowance;
  for (const ZipPhoto& photo : photos) {
    if (photo.bytes > std::min(left, kMaxEntryBytes)) RefuseGrowth(archive, packed);
    left -= photo.bytes;
  }
  return packed;
}

/// Throws RunError unless the disk has room for all photos.
void RequireRoom(const fs::path& dir, const std::vector<ZipPhoto>& photos) {
  uint64_t needed = 0;
  for (const ZipPhoto& photo : photos) needed += photo.bytes;
  std::error_code error;
  const fs::space_info space = fs::space(dir, error);
  if (error || space.available >= needed) return;
  throw RunError("{}: the photos take {:.1f} GB, and {:.1f} GB are free; make room there, or choose another -o",
                 dir.string(), Gigabytes(static_cast<int64_t>(needed)),
                 Gigabytes(static_cast<int64_t>(space.available)));
}

}  // namespace

bool IsZip(const fs::path& path) {
  const std::string head = ReadHead(path, 4);
  return head == std::string("PK\3\4", 4) || head == std::string("PK\5\6", 4);
}

int CountZipPhotos(const fs::path& path) {
  const Archive archive = OpenArchive(path);
  Skipped skipped;
  const std::vector<ZipPhoto> photos = ListPhotos(path, archive.get(), &skipped);
  if (photos.empty()) {
    throw InputError("{}: holds no photos{}; expected JPEG, PNG, HEIC, AVIF, WebP or TIFF files", path.string(),
                     skipped.empty() ? "" : fmt::format(" ({})", skipped.begin()->first));
  }
  for (const ZipPhoto& photo : photos) {
    zip_stat_t stat;
    const bool known = zip_stat_index(archive.get(), photo.index, 0, &stat) == 0;
    if (known && (stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE) {
      throw InputError("{}: is encrypted; unpack it and name the folder", path.string());
    }
  }
  CheckedSize(path, photos);
  return static_cast<int>(photos.size());
}

void UnpackPhotos(const fs::path& path, const fs::path& dir, const Listener& listener) {
  const Archive archive = OpenArchive(path);
  Skipped skipped;
  const std::vector<ZipPhoto> photos = ListPhotos(path, archive.get(), &skipped);
  const uint64_t packed = CheckedSize(path, photos);
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw RunError("{}: cannot be made: {}", dir.string(), SystemReason(error));
  RequireRoom(dir, photos);
  uint64_t left = kMaxGrowth * packed + kGrowthAllowance;  // what the archive says of sizes may be wrong
  size_t unpacked = 0;
  std::string piece(kPieceBytes, '\0');
  for (const ZipPhoto& photo : photos) {
    const std::unique_ptr<zip_file_t, CloseArchive> file(zip_fopen_index(archive.get(), photo.index, 0));
    if (!file) {
      throw InputError("{}: {} cannot be unpacked; copy the archive again, or unpack it and name the folder",
                       path.string(), OneLine(photo.path.string()));
    }
    const fs::path target = dir / photo.path;
    fs::create_directories(target.parent_path(), error);
    if (error) throw RunError("{}: cannot be made: {}", target.parent_path().string(), SystemReason(error));
    AtomicFile out(target);
    zip_int64_t read = 0;
    while ((read = zip_fread(file.get(), piece.data(), piece.size())) > 0) {
      ThrowIfInterrupted();
      if (static_cast<uint64_t>(read) > left) RefuseGrowth(path, packed);
      left -= static_cast<uint64_t>(read);
      out.Append(std::string_view(piece.data(), static_cast<size_t>(read)));
    }
    if (read < 0) {
      throw InputError("{}: {} is damaged in it; copy the archive again", path.string(), OneLine(photo.path.string()));
    }
    out.FinishUnflushed();
    try {
      ReadImageInfo(target);
      ++unpacked;
    } catch (const InputError& damage) {
      fs::remove(target, error);
      const std::string why = std::string(damage.what()).substr(target.string().size() + 2);
      skipped[why + "; it is left out"].push_back(OneLine(photo.path.generic_string()));
    }
  }
  if (unpacked == 0) {
    throw InputError("{}: holds no photos that can be read ({})", path.string(),
                     skipped.empty() ? "" : skipped.begin()->first);
  }
  for (const auto& [why, names] : skipped) {
    listener(Warning{fmt::format("{}: {}: {}", path.string(), SomeNames(names), why)});
  }
}

}  // namespace oraclegs
