#include "oraclegs/scene/photo_folder.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxOptionsBytes = 16 << 20;

struct UnreadKind {
  const char* reason;
  std::vector<std::string_view> extensions;
};

const std::vector<UnreadKind>& UnreadKinds() {
  static const std::vector<UnreadKind> kinds = {
      {"raw photos are not read; export them as JPEG",
       {".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".srf", ".sr2", ".dng", ".orf", ".rw2", ".raf", ".pef", ".srw",
        ".raw"}},
      {"videos beside photos are not read; name the video itself to take photos out of it",
       {".mp4", ".mov", ".m4v", ".avi", ".mkv", ".webm", ".mts", ".m2ts", ".3gp", ".wmv", ".mpg", ".mpeg", ".insv"}},
      {"this kind of image is not read; save it as JPEG or PNG",
       {".gif", ".bmp", ".psd", ".svg", ".pdf", ".jp2", ".jxl",  ".jxr", ".exr",  ".hdr",
        ".tga", ".ppm", ".pgm", ".eps", ".ai",  ".ico", ".jfif", ".jpe", ".insp", ".xcf"}}};
  return kinds;
}

std::string LowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// A result of this program: its images are renders, not photos.
bool IsRunFolder(const fs::path& dir) {
  try {
    return ReadFile(dir / "options.json", kMaxOptionsBytes).find("\"program\": \"oraclegs\"") != std::string::npos;
  } catch (const Error&) {  // there is none
    return false;
  }
}

std::string Below(const fs::path& dir, const fs::path& path) { return path.lexically_relative(dir).generic_string(); }

/// Calls `visit` for every file below `dir` that is not passed over.
template <class Visit>
void VisitFiles(const fs::path& dir, const Visit& visit) {
  std::error_code error;
  if (!fs::is_directory(dir, error)) return;
  fs::recursive_directory_iterator it(dir, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    const fs::path& path = it->path();
    const std::string name = path.filename().string();
    std::error_code ignored;
    const bool hidden = name.starts_with(".");  // e.g. "._1.jpg" beside photos from a Mac
    if (it->is_directory(ignored)) {
      if (hidden || IsHelperFolder(name) || IsRunFolder(path)) it.disable_recursion_pending();
    } else if (!hidden) {
      visit(path);
    }
  }
  if (error) throw InputError("{}: cannot be listed ({}); check its permissions", dir.string(), error.message());
}

/// What EXIF says of the camera, in pixels of the image.
void AddCamera(const Exif& exif, SceneView* view) {
  view->camera = exif.make;
  if (!exif.model.empty()) view->camera += (view->camera.empty() ? "" : " ") + exif.model;
  view->gps = exif.gps;
  view->focal_prior = FocalPixels(exif, view->intrinsics.width, view->intrinsics.height).value_or(0);
}

}  // namespace

bool IsHelperFolder(const std::string& name) {
  if (name == "masks") return true;
  constexpr std::string_view kSmaller = "images_";
  return name.starts_with(kSmaller) && name.size() > kSmaller.size() &&
         std::all_of(name.begin() + kSmaller.size(), name.end(), [](unsigned char c) { return std::isdigit(c); });
}

std::string WhyNotRead(const fs::path& path) {
  const std::string extension = LowerExtension(path);
  for (const UnreadKind& kind : UnreadKinds()) {
    const auto& known = kind.extensions;
    if (std::find(known.begin(), known.end(), extension) != known.end()) return kind.reason;
  }
  return "";
}

std::vector<fs::path> FindPhotos(const fs::path& dir, const Listener& listener) {
  std::vector<fs::path> photos;
  std::map<std::string, std::vector<std::string>> skipped;
  VisitFiles(dir, [&](const fs::path& path) {
    if (HasImageExtension(path) && IsFile(path)) {
      photos.push_back(path);
    } else if (const std::string why = WhyNotRead(path); !why.empty()) {
      skipped[why].push_back(Below(dir, path));
    }
  });
  std::sort(photos.begin(), photos.end());
  for (auto& [why, names] : skipped) {
    std::sort(names.begin(), names.end(), NaturalLess);
    for (std::string& name : names) name = OneLine(name);
    listener(Warning{fmt::format("{}: {}", SomeNames(names), why)});
  }
  return photos;
}

std::vector<SceneView> ReadPhotos(const fs::path& dir, const Listener& listener) {
  const std::vector<fs::path> photos = FindPhotos(dir, listener);
  if (photos.size() > static_cast<size_t>(kMaxPhotos)) {
    throw InputError(
        "{}: has {} photos, and at most {} without poses can be put together; copy some to a folder of their own "
        "(every {}th, say), sharp ones from all sides",
        dir.string(), photos.size(), kMaxPhotos, (photos.size() + 99) / 100);
  }
  std::vector<SceneView> views;
  std::vector<std::string> damage;
  for (const fs::path& path : photos) {
    SceneView view;
    view.name = Below(dir, path);
    view.image_path = path;
    try {
      const ImageInfo info = ReadImageInfo(path);
      view.intrinsics.width = info.width;
      view.intrinsics.height = info.height;
      AddCamera(info.exif, &view);
      views.push_back(std::move(view));
    } catch (const InputError& error) {
      damage.push_back(error.what());
    }
  }
  if (!damage.empty() && views.size() < kMinGoodPhotos) throw InputError("{}", damage.front());
  for (const std::string& what : damage) listener(Warning{what + "; it is left out"});
  std::sort(views.begin(), views.end(),
            [](const SceneView& a, const SceneView& b) { return NaturalLess(a.name, b.name); });
  return views;
}

}  // namespace oraclegs
