#include "oraclegs/app/uploads.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "oraclegs/app/library.h"
#include "oraclegs/capture/video.h"
#include "oraclegs/capture/zip_photos.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/photo_kind.h"
#include "oraclegs/web/file_below.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kChunk = 1 << 18;
constexpr uint64_t kMaxDrained = 64 << 20;
constexpr size_t kMaxNameBytes = 150;  // leaves room for what keeps two names apart
constexpr const char* kHidden = ".upload-";

/// The name alone, without a folder, control characters or a dot at its beginning; the end stays when it is cut.
std::string SafeName(const std::string& given) {
  std::string name = given.substr(given.find_last_of("/\\") + 1);
  name = IsUtf8(name) ? OneLine(name) : EscapeBytes(name);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '?' || c == '\\' || c == '/' || c == ':'; }, '_');
  name.erase(0, name.find_first_not_of(". "));
  if (name.size() > kMaxNameBytes) {
    const std::string end = fs::path(name).extension().string();
    std::string stem = name.substr(0, kMaxNameBytes - std::min(end.size(), kMaxNameBytes / 2));
    while (!stem.empty() && !IsUtf8(stem)) stem.pop_back();
    name = stem + (end.size() < kMaxNameBytes / 2 ? end : "");
  }
  return IsPlainPath(name) ? name : "photo";
}

/// Bytes of a request's body that nobody has taken yet.
class Body {
 public:
  explicit Body(const WebRequest& request) : read_(request.read), left_(request.content_length.value_or(0)) {}

  uint64_t left() const { return left_; }
  /// The next bytes; 0 where the client sends no more.
  size_t Read(std::vector<char>* to) {
    const ptrdiff_t n = left_ == 0 || !read_ ? 0 : read_(to->data(), std::min<uint64_t>(to->size(), left_));
    if (n <= 0) return 0;
    left_ -= static_cast<uint64_t>(n);
    return static_cast<size_t>(n);
  }
  [[noreturn]] void Refuse(int status, const std::string& reason) {
    std::vector<char> rest(kChunk);
    if (left_ <= kMaxDrained) {
      while (left_ > 0 && Read(&rest) > 0) continue;
    }
    throw UploadRefusal{status, reason};
  }

 private:
  const std::function<ptrdiff_t(char*, size_t)>& read_;
  uint64_t left_;
};

/// A new file under a hidden name, removed unless it was given its own.
class HiddenFile {
 public:
  explicit HiddenFile(const fs::path& folder) : path_((folder / kHidden).string() + "XXXXXX") {
    fd_ = mkostemp(path_.data(), O_CLOEXEC);
    if (fd_ < 0) throw RunError("{}: cannot be written: {}", folder.string(), SystemReason(errno));
  }
  ~HiddenFile() {
    close(fd_);
    if (!named_) unlink(path_.c_str());
  }
  HiddenFile(const HiddenFile&) = delete;
  HiddenFile& operator=(const HiddenFile&) = delete;

  fs::path path() const { return path_; }
  /// False where the disk takes no more.
  bool Write(const char* bytes, size_t count) const {
    while (count > 0) {
      const ssize_t n = write(fd_, bytes, count);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      bytes += n, count -= static_cast<size_t>(n);
    }
    return true;
  }
  /// Gives it `name` in `folder`, or that with a number where one is taken.
  fs::path Name(const fs::path& folder, const std::string& name) {
    const fs::path plain(name);
    for (int i = 1;; ++i) {
      fs::path target =
          folder / (i == 1 ? name : fmt::format("{} ({}){}", plain.stem().string(), i, plain.extension().string()));
      if (link(path_.c_str(), target.c_str()) == 0) {
        unlink(path_.c_str());
      } else if (errno == EEXIST) {
        continue;
      } else if (std::error_code error; fs::exists(target, error) || rename(path_.c_str(), target.c_str()) != 0) {
        throw RunError("{}: cannot be written: {}", target.string(), SystemReason(errno));  // no links there
      }
      named_ = true;
      return target;
    }
  }

 private:
  std::string path_;
  int fd_ = -1;
  bool named_ = false;
};

/// Kind of a file that is going to be called `name`; nothing for one that nobody can use.
std::optional<UploadKind> KindOf(const fs::path& file, const std::string& name) {
  if (IsPhotoByContent(name, ReadHead(file, kImageHeadBytes))) return UploadKind::kPhoto;
  if (IsZip(file)) return UploadKind::kZip;
  if (LooksLikeVideo(file)) return UploadKind::kVideo;
  return std::nullopt;
}

void AddFiles(const fs::path& folder, const char* folder_name, std::vector<Upload>* uploads) {
  std::error_code error;
  std::vector<Upload> found;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with('.') || !it->is_regular_file(error) || it->is_symlink(error)) continue;
    const bool photo = std::string(folder_name) == "photos";
    const UploadKind kind = photo ? UploadKind::kPhoto : IsZip(it->path()) ? UploadKind::kZip : UploadKind::kVideo;
    found.push_back({IdOf(std::string(folder_name) + "/" + name), it->path(), kind, it->file_size(error)});
  }
  std::sort(found.begin(), found.end(), [](const Upload& a, const Upload& b) {
    return NaturalLess(a.path.filename().string(), b.path.filename().string());
  });
  uploads->insert(uploads->end(), found.begin(), found.end());
}

/// How many files have names in a folder; cheap, since it is asked before each of ten thousand uploads.
size_t NamesIn(const fs::path& folder) {
  std::error_code error;
  size_t names = 0;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (!it->path().filename().string().starts_with('.')) ++names;
  }
  return names;
}

}  // namespace

std::vector<Upload> UploadsOf(const ProjectPaths& paths) {
  std::vector<Upload> uploads;
  AddFiles(paths.photos(), "photos", &uploads);
  AddFiles(paths.media(), "media", &uploads);
  return uploads;
}

Upload ReceiveUpload(const ProjectPaths& paths, const std::string& name, const WebRequest& request,
                     const UploadLimits& limits) {
  Body body(request);
  if (!request.content_length) throw UploadRefusal{411, "the browser does not say how large the file is"};
  const uint64_t bytes = *request.content_length;
  if (bytes == 0) throw UploadRefusal{400, "the file is empty"};
  if (bytes > limits.media_bytes) throw UploadRefusal{413, "the file is too large"};
  if (NamesIn(paths.photos()) + NamesIn(paths.media()) >= limits.files) {
    body.Refuse(413, fmt::format("a project holds at most {} files", limits.files));
  }
  std::error_code error;
  const auto room = [&] {
    const fs::space_info space = fs::space(paths.root(), error);
    return error || space.available > limits.keep_free + body.left();
  };
  if (!room()) body.Refuse(507, "the disk is full; remove something, or choose a library on another disk");
  const std::string safe = SafeName(name);
  const std::string why_not = LooksLikeVideo(safe) ? "" : WhyNotRead(safe);
  if (!why_not.empty()) body.Refuse(415, why_not);
  fs::create_directories(paths.photos(), error);
  HiddenFile file(paths.photos());
  std::vector<char> chunk(kChunk);
  while (body.left() > 0) {
    const size_t n = body.Read(&chunk);
    if (n == 0) throw UploadRefusal{400, "the file was not sent to its end"};
    if (!file.Write(chunk.data(), n)) {
      body.Refuse(507, "the disk is full; remove something, or choose a library on another disk");
    }
  }
  const std::optional<UploadKind> kind = KindOf(file.path(), safe);
  if (!kind) throw UploadRefusal{415, "is neither a photo nor a video nor a zip archive"};
  const bool photo = *kind == UploadKind::kPhoto;
  if (photo && bytes > limits.photo_bytes) throw UploadRefusal{413, "the photo is too large"};
  const fs::path folder = photo ? paths.photos() : paths.media();
  fs::create_directories(folder, error);
  const fs::path stored = file.Name(folder, safe);
  return {IdOf(folder.filename().string() + "/" + stored.filename().string()), stored, *kind, bytes};
}

void RemoveUnfinishedUploads(const ProjectPaths& paths) {
  std::error_code error;
  for (fs::directory_iterator it(paths.photos(), error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename().string().starts_with(kHidden)) fs::remove(it->path(), error);
  }
}

}  // namespace oraclegs
