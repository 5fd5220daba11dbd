#include "oraclegs/scene/photo_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/capture_layout.h"
#include "oraclegs/scene/photo_kind.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxOptionsBytes = 16 << 20;
constexpr int64_t kMaxMaterialBytes = 1 << 20;

/// A result of this program: its images are renders, not photos.
bool IsRunFolder(const fs::path& dir) {
  try {
    return ReadFile(dir / "options.json", kMaxOptionsBytes).find("\"program\": \"oraclegs\"") != std::string::npos;
  } catch (const Error&) {  // there is none
    return false;
  }
}

std::string Below(const fs::path& dir, const fs::path& path) { return path.lexically_relative(dir).generic_string(); }

/// Empty when links do not lead there.
fs::path RealPath(const fs::path& path) {
  std::error_code error;
  return fs::weakly_canonical(path, error);
}

/// Finds the photos of a folder and what is to be said of its other files.
class PhotoSearch {
 public:
  explicit PhotoSearch(const fs::path& root) : root_(root), real_root_(RealPath(root)) {
    Visit(root);
    FollowLinks();
    if (photos_.empty()) TakeHelper();
    std::erase_if(photos_, [&](const fs::path& path) {
      if (textures_.count(path) > 0) companions_.push_back(Below(root_, path));
      return textures_.count(path) > 0;
    });
    for (const fs::path& path : TakeCompanions(&photos_)) companions_.push_back(Below(root_, path));
    std::sort(photos_.begin(), photos_.end());
  }

  const std::vector<fs::path>& photos() const { return photos_; }

  void Report(const Listener& listener) {
    for (auto& [why, names] : skipped_) listener(Warning{fmt::format("{}: {}", Shown(&names), why)});
    std::vector<std::string> helpers;
    for (const fs::path& dir : helpers_) helpers.push_back(Below(root_, dir) + "/");
    if (!helpers.empty()) {
      listener(
          Note{fmt::format("{}: passed over, as a folder of masks, depth maps or the like; masks are read from masks/; "
                           "name it itself if it holds photos",
                           Shown(&helpers))});
    }
    if (!companions_.empty()) {
      listener(
          Note{fmt::format("{}: passed over, as masks, depth maps, textures or the like; masks are read from masks/",
                           Shown(&companions_))});
    }
    if (!by_content_.empty()) {
      listener(Note{fmt::format("{}: read as photos, whatever the names say", Shown(&by_content_))});
    }
    for (const std::string& note : notes_) listener(Note{note});
    if (!poses_.empty() && !photos_.empty()) listener(Note{poses_});
  }

 private:
  static std::string Shown(std::vector<std::string>* names) {
    std::sort(names->begin(), names->end(), NaturalLess);
    for (std::string& name : *names) name = OneLine(name);
    return SomeNames(*names);
  }

  /// After the folders themselves, so that these keep their names.
  void FollowLinks() {
    follows_links_ = true;
    while (!links_.empty()) {
      std::vector<fs::path> links;
      links.swap(links_);
      std::sort(links.begin(), links.end());
      for (const fs::path& link : links) {
        if (!HoldsRoot(link) && !IsRunFolder(link)) Visit(link);
      }
    }
  }

  /// Takes the photos of the only folder that has images, whatever it is called; not of masks/, which is read as such,
  /// nor beside photos that are not read.
  void TakeHelper() {
    helpers_.insert(helpers_.end(), usual_helpers_.begin(), usual_helpers_.end());
    if (helpers_.size() != 1 || IsMaskFolder(helpers_.front()) || !skipped_.empty()) return;
    const fs::path folder = helpers_.front();
    helpers_.clear();
    notes_.push_back(
        fmt::format("{}/: its images are taken for the photos, as there are no others", OneLine(Below(root_, folder))));
    Visit(folder);
    FollowLinks();
  }

  static bool IsMaskFolder(const fs::path& dir) { return dir.filename() == "masks" || dir.filename() == "mask"; }

  /// A link to a folder around the one that was named would lead to everything beside it.
  bool HoldsRoot(const fs::path& link) const {
    std::error_code error;
    const fs::path target = fs::canonical(link, error);
    return error ||
           std::mismatch(target.begin(), target.end(), real_root_.begin(), real_root_.end()).first == target.end();
  }

  /// Without links no folder comes twice, whatever numbers its file system gives to folders.
  bool WasVisited(const fs::path& dir) {
    struct stat info;
    if (stat(dir.c_str(), &info) != 0) return false;
    return !visited_.insert({info.st_dev, info.st_ino}).second && follows_links_;
  }

  void Visit(const fs::path& dir) {
    std::error_code error;
    if (!fs::is_directory(dir, error) || WasVisited(dir)) return;
    if (const auto layout = FindCaptureLayout(dir)) {
      const std::string poses = DescribeUnreadPoses(*layout);
      notes_.push_back(fmt::format("{}: is a folder of {}; its photos are those of {}{}{}", OneLine(dir.string()),
                                   layout->program, OneLine(Below(dir, layout->photos)), poses.empty() ? "" : "; ",
                                   poses));
      return Visit(layout->photos);
    }
    if (poses_.empty()) {
      poses_ = DescribeUnreadPoses(dir);
      if (!poses_.empty()) poses_ = OneLine(dir.string()) + ": " + poses_;
    }
    fs::directory_iterator it(dir, error);
    std::vector<fs::directory_entry> entries;
    for (; !error && it != fs::directory_iterator(); it.increment(error)) entries.push_back(*it);
    std::sort(entries.begin(), entries.end());  // the poses of the first folder are named
    for (const fs::directory_entry& entry : entries) Add(entry);
    if (!error) return;
    if (!follows_links_) {
      throw InputError("{}: cannot be listed ({}); check its permissions", dir.string(), error.message());
    }
    skipped_["cannot be listed, so it is left out; check its permissions"].push_back(Below(root_, dir) + "/");
  }

  void Add(const fs::directory_entry& entry) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(".")) return;  // e.g. "._1.jpg" beside photos from a Mac
    std::error_code ignored;
    if (!entry.is_directory(ignored)) {
      AddFile(entry.path());
    } else if (IsHelperFolder(name)) {
      AddHelper(entry.path());
    } else if (entry.is_symlink(ignored)) {
      links_.push_back(entry.path());
    } else if (!IsRunFolder(entry.path())) {
      Visit(entry.path());
    }
  }

  void AddFile(const fs::path& path) {
    if (!IsFile(path)) return;
    if (path.extension() == ".mtl") AddTextures(path);
    if (HasImageExtension(path)) {
      photos_.push_back(path);
    } else if (IsPhotoByContent(path)) {
      photos_.push_back(path);
      by_content_.push_back(Below(root_, path));
    } else if (const std::string why = WhyNotRead(path); !why.empty()) {
      skipped_[why].push_back(Below(root_, path));
    }
  }

  /// Images that a mesh wears: "map_Kd texture.jpg" in its material file.
  void AddTextures(const fs::path& materials) {
    std::ifstream file(materials);
    std::string line;
    for (int64_t left = kMaxMaterialBytes; left > 0 && std::getline(file, line); left -= std::ssize(line) + 1) {
      const std::vector<std::string> words = SplitTrimmed(line, ' ');
      if (words.size() > 1 && words[0].starts_with("map_")) textures_.insert(materials.parent_path() / words.back());
    }
  }

  /// Usual folders (masks/, images_4/) are not spoken of beside photos, and those without an image never.
  void AddHelper(const fs::path& dir) {
    const std::string name = dir.filename().string();
    std::error_code error;
    if (!std::isalpha(static_cast<unsigned char>(name[0]))) return;
    const bool is_usual = IsMaskFolder(dir) || name.starts_with("images_");
    for (fs::directory_iterator it(dir, error), end; !error && it != end; it.increment(error)) {
      if (HasImageExtension(it->path())) return (is_usual ? usual_helpers_ : helpers_).push_back(dir);
    }
  }

  const fs::path root_, real_root_;
  std::set<std::pair<dev_t, ino_t>> visited_;
  std::vector<fs::path> photos_, links_, helpers_, usual_helpers_;
  std::set<fs::path> textures_;
  bool follows_links_ = false;
  std::vector<std::string> companions_, by_content_, notes_;
  std::string poses_;                                        ///< poses of the first folder that has some
  std::map<std::string, std::vector<std::string>> skipped_;  ///< names by reason
};

/// Adds to a view what EXIF says of its camera, in pixels of the image.
void AddCamera(const Exif& exif, SceneView* view) {
  view->camera = exif.make;
  if (!exif.model.empty()) view->camera += (view->camera.empty() ? "" : " ") + exif.model;
  view->gps = exif.gps;
  view->focal_prior = FocalPixels(exif, view->intrinsics.width, view->intrinsics.height).value_or(0);
}

}  // namespace

std::vector<fs::path> FindPhotos(const fs::path& dir, const Listener& listener) {
  PhotoSearch search(dir);
  search.Report(listener);
  return search.photos();
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
