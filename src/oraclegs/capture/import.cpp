#include "oraclegs/capture/import.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "oraclegs/capture/free_names.h"
#include "oraclegs/capture/video.h"
#include "oraclegs/capture/zip_photos.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/capture_layout.h"
#include "oraclegs/scene/photo_folder.h"
#include "oraclegs/scene/photo_kind.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kManifest[] = ".import.json";  // hidden: no photo
constexpr char kHalf[] = ".oraclegs-photos.tmp";
// A folder of one's own, so that nothing that is imported is taken for the images/, masks/ or sparse/ of a scene.
constexpr char kImages[] = "images";

enum class InputKind { kFolder, kPhoto, kVideo, kZip };

/// True also of a photo that is left out of folders for its name: photo.jpg.bak.
bool CanBeRead(const fs::path& photo) {
  try {
    ReadImageInfo(photo);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

InputKind KindOf(const fs::path& input) {
  std::error_code error;
  if (fs::is_directory(input, error)) return InputKind::kFolder;
  if (!fs::exists(input, error)) throw InputError("{}: no such file or folder", input.string());
  if (!fs::is_regular_file(input, error)) throw InputError("{}: is neither a file nor a folder", input.string());
  if (IsZip(input)) return InputKind::kZip;
  if (HasImageExtension(input) || IsPhotoByContent(input)) return InputKind::kPhoto;
  if (LooksLikeVideo(input)) return InputKind::kVideo;
  if (const std::string why = WhyNotRead(input); !why.empty()) throw InputError("{}: {}", input.string(), why);
  if (CanBeRead(input)) return InputKind::kPhoto;
  throw InputError("{}: is neither a photo, a video, a zip of photos nor a folder; name one of these", input.string());
}

/// The name of a photo, with an extension by its content where it has none of a photo: by that it is found again.
fs::path WithImageExtension(const fs::path& photo) {
  if (HasImageExtension(photo)) return photo.filename();
  return photo.filename() += ReadImageInfo(photo).extension;
}

/// Bytes that JSON and file systems of others can hold.
std::string PlainText(const fs::path& path) {
  const std::string text = OneLine(path.string());
  return IsUtf8(text) ? text : EscapeBytes(text);
}

json Stamp(const fs::path& file) {
  std::error_code error;
  const auto time = fs::last_write_time(file, error).time_since_epoch();
  return {{"path", PlainText(fs::absolute(file))},
          {"bytes", fs::file_size(file, error)},
          {"changed", std::chrono::duration_cast<std::chrono::nanoseconds>(time).count()}};
}

json ManifestOf(const std::vector<fs::path>& inputs, int frames) {
  json files = json::array();
  for (const fs::path& input : inputs) {
    if (KindOf(input) != InputKind::kFolder) {
      files.push_back(Stamp(input));
      continue;
    }
    for (const fs::path& photo : FindPhotos(input, Silent())) files.push_back(Stamp(photo));
  }
  return {{"format", 1}, {"frames", frames}, {"files", files}};
}

/// Waits until a file or folder is on the disk.
void FlushToDisk(const fs::path& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  int error = fd < 0 || fsync(fd) != 0 ? errno : 0;
  if (fd >= 0) close(fd);
  if (error == EINVAL || error == ENOTSUP) error = 0;  // file systems that cannot do it for folders
  if (error != 0) throw RunError("{}: cannot flush to disk: {}", OneLine(path.string()), SystemReason(error));
}

/// Sizes of all files below `dir`, which are on the disk by then: a manifest must not outlive what it vouches for.
json FlushedSizes(const fs::path& dir) {
  json sizes = json::object();
  for (const auto& entry : fs::recursive_directory_iterator(dir)) {
    FlushToDisk(entry.path());
    if (!entry.is_directory()) sizes[PlainText(entry.path().lexically_relative(dir))] = entry.file_size();
  }
  FlushToDisk(dir);
  return sizes;
}

/// True when each photo has the size that the manifest says, and none is missing.
bool AreWhole(const fs::path& images, const json& sizes) {
  size_t whole = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator it(images, error), end; !error && it != end; it.increment(error)) {
    if (it->is_directory(error)) continue;
    const auto size = sizes.find(PlainText(it->path().lexically_relative(images)));
    whole += size != sizes.end() && *size == fs::file_size(it->path(), error);
  }
  return !error && sizes.is_object() && whole == sizes.size();
}

bool IsImported(const fs::path& dir, const json& manifest) {
  std::error_code error;
  if (!fs::is_regular_file(dir / kManifest, error)) return false;
  json found = ParseJsonOrDiscard(ReadFile(dir / kManifest));
  if (!found.is_object() || !found.contains("photos") || !AreWhole(dir / kImages, found["photos"])) return false;
  found.erase("photos");
  return found == manifest;
}

/// Copies and unpacks into one folder.
class Importer {
 public:
  Importer(fs::path dir, int frames, const Listener& listener)
      : dir_(std::move(dir)), frames_(frames), listener_(listener) {}

  void Add(const fs::path& input, bool alone) {
    ThrowIfInterrupted();
    switch (KindOf(input)) {
      case InputKind::kPhoto:
        return Copy(input, FreeName(WithImageExtension(input)));
      case InputKind::kZip:
        return UnpackPhotos(input, alone ? dir_ : dir_ / FreeName(input.stem()), listener_);
      case InputKind::kVideo:
        return ExtractFrames(input, frames_, alone ? dir_ : dir_ / FreeName(input.stem()), listener_);
      case InputKind::kFolder: {
        const fs::path folder = FreeName(fs::weakly_canonical(input).filename());
        if (std::error_code error; fs::is_directory(input / "masks", error)) {
          listener_(Warning{fmt::format(
              "{}: masks are used where the folder is the only input; name it alone, or make one folder of all photos",
              (input / "masks").string())});
        }
        if (const std::string poses = DescribeScenePoses(input); !poses.empty()) {
          listener_(Note{fmt::format("{}: {}", OneLine(input.string()), poses)});
        }
        for (const fs::path& photo : FindPhotos(input, listener_))
          Copy(photo, names_.Take(folder / PathOf(photo.lexically_relative(input))));
        return;
      }
    }
  }

 private:
  /// A name at the top of the folder that is not taken: IMG_1.jpg, then IMG_1-2.jpg.
  fs::path FreeName(const fs::path& wanted) {
    std::string name = PlainText(wanted);
    if (name.empty() || name[0] == '.' || IsHelperFolder(PlainText(wanted.stem()))) name = "_" + name;
    return names_.Take(name);
  }

  /// A path below a folder by which the photo is found again.
  static fs::path PathOf(const fs::path& relative) {
    fs::path path;
    for (const fs::path& part : relative.parent_path()) {
      std::string name = part.string();
      if (IsHelperFolder(name)) name.insert(name.begin(), '_');
      path /= name;
    }
    return path / relative.filename();
  }

  void Copy(const fs::path& from, const fs::path& name) const {
    const fs::path to = dir_ / name;
    std::error_code error;
    fs::create_directories(to.parent_path(), error);
    if (!error) fs::copy_file(from, to, error);
    if (!error) return;
    std::error_code ignored;  // a full disk is reported in many ways
    const bool is_full = fs::space(dir_, ignored).available < fs::file_size(from, ignored);
    throw RunError(
        "{}: cannot be copied to {}: {}", OneLine(from.string()), OneLine(to.string()),
        is_full ? "no space is left on the disk; make room there, or choose another -o" : SystemReason(error));
  }

  fs::path dir_;
  int frames_;
  const Listener& listener_;
  FreeNames names_;
};

}  // namespace

bool IsUsedInPlace(const std::vector<fs::path>& inputs) {
  std::error_code error;
  return inputs.size() == 1 && (fs::is_directory(inputs[0], error) || !fs::exists(inputs[0], error));
}

void CheckInputs(const std::vector<fs::path>& inputs) {
  size_t photos = 0;
  for (const fs::path& input : inputs) {
    switch (KindOf(input)) {
      case InputKind::kPhoto:
        ReadImageInfo(input);
        ++photos;
        break;
      case InputKind::kVideo:
        ProbeVideo(input);
        break;
      case InputKind::kZip:
        photos += static_cast<size_t>(CountZipPhotos(input));
        break;
      case InputKind::kFolder: {
        const size_t found = FindPhotos(input, Silent()).size();
        if (found == 0) throw InputError("{}: holds no photos that can be read", input.string());
        photos += found;
        break;
      }
    }
  }
  if (photos > static_cast<size_t>(kMaxPhotos)) {
    throw InputError("{}: with the others {} photos, and at most {} without poses can be put together; name fewer",
                     inputs.front().string(), photos, kMaxPhotos);
  }
}

void ImportPhotos(const std::vector<fs::path>& inputs, int frames, const fs::path& dir, const Listener& listener) {
  json manifest = ManifestOf(inputs, frames);
  if (IsImported(dir, manifest)) return;
  listener(StageStarted{"import"});
  const auto start = std::chrono::steady_clock::now();
  const fs::path half = dir.parent_path() / kHalf;
  std::error_code error;
  fs::remove_all(half, error);
  fs::create_directories(half / kImages, error);
  if (error) throw RunError("{}: cannot be made: {}", half.string(), SystemReason(error));
  Importer importer(half / kImages, frames, listener);
  try {
    for (const fs::path& input : inputs) importer.Add(input, inputs.size() == 1);
    manifest["photos"] = FlushedSizes(half / kImages);
    WriteFileAtomically(half / kManifest, manifest.dump(1) + "\n");
  } catch (...) {
    fs::remove_all(half, error);
    throw;
  }
  fs::remove_all(dir, error);
  if (!error) fs::rename(half, dir, error);
  if (error) throw RunError("{}: cannot be renamed to {}: {}", half.string(), dir.string(), SystemReason(error));
  FlushToDisk(dir.parent_path());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  listener(StageFinished{"import", seconds.count()});
}

}  // namespace oraclegs
