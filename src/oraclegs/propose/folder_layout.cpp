#include "oraclegs/propose/folder_layout.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/transforms_frame.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kOutside = "the image lies outside the folder; move it there";
constexpr const char* kNoFile = "no image file is there; make it, or remove the frame";
constexpr const char* kNoPose = "transforms.json has no frame for them; add one with the pose";
constexpr const char* kNoView = "no view of the scene has their name; name each after the view whose pose it has";
constexpr const char* kSeveralViews = "several views of the scene have their name; use the whole path, a/b.jpg as a_b";
constexpr const char* kTwice = "another image has their name, too; remove one of the two";
constexpr const char* kDistorted = "their camera model is no pinhole; remove the distortion";
constexpr const char* kTestName =
    "they have the name of a test view, whose image must stay unseen; remove them, or rename them when they show "
    "another pose";

bool IsBelow(const fs::path& dir, const fs::path& file) {
  const fs::path relative = file.lexically_normal().lexically_relative(dir);
  return !relative.empty() && *relative.begin() != "..";
}

/// Sorted paths of what stands in a folder.
std::vector<fs::path> Entries(const fs::path& dir) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator it(dir, error), end; !error && it != end; it.increment(error)) paths.push_back(*it);
  if (error) throw InputError("{}: cannot be listed: {}", dir.string(), error.message());
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::vector<fs::path> ImagesIn(const fs::path& dir) {
  std::vector<fs::path> images;
  for (const fs::path& path : Entries(dir)) {
    if (HasImageExtension(path) && IsFile(path)) images.push_back(path);
  }
  return images;
}

bool IsSyntheticName(const std::string& name) {
  constexpr std::string_view kStart = "synthetic_";
  return name.starts_with(kStart) && name.size() > kStart.size() &&
         std::all_of(name.begin() + kStart.size(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The folder synthetic_N that is meant.
fs::path SyntheticFolder(const fs::path& dir) {
  if (IsSyntheticName(dir.filename().string())) return dir;
  std::vector<std::string> found;
  for (const fs::path& path : Entries(dir)) {
    if (IsSyntheticName(path.filename().string()) && IsFolder(path)) found.push_back(path.filename().string());
  }
  if (found.size() == 1) return dir / found[0];
  if (found.size() > 1) {
    throw InputError("{}: has several folders of proposals, {}; name one of them", dir.string(), SomeNames(found));
  }
  if (ImagesIn(dir).empty()) {
    throw InputError("{}: has no images; give a folder with images and transforms.json, or synthetic_N", dir.string());
  }
  throw InputError(
      "{}: has images but no transforms.json with their poses; add it, or name the folder synthetic_N "
      "when its images are named like the scene's views",
      dir.string());
}

using Views = std::vector<const Target*>;

std::string Stem(const std::string& view) { return FileName(fs::path(view).filename().string()); }

/// Which of the scene's views an image's name stands for.
class ViewNames {
 public:
  explicit ViewNames(const FolderRequest& request) {
    for (const Target& view : request.test) {
      test_.insert(FileName(view.name));
      test_stems_.insert(Stem(view.name));
    }
    for (const Target& view : request.dataset) {
      dataset_[FileName(view.name)].push_back(&view);
      dataset_stems_[Stem(view.name)].push_back(&view);
    }
  }

  /// A file name that a test view has, too, is one: only the whole path distinguishes train/r_0.png and test/r_0.png.
  bool IsTest(const std::string& image) const {
    return test_.count(FileName(image)) > 0 ||
           (dataset_.count(FileName(image)) == 0 && test_stems_.count(Stem(image)) > 0);
  }
  /// Views by whole path if one has that, or else by file name alone.
  Views Dataset(const std::string& image) const {
    const auto whole = dataset_.find(FileName(image)), stem = dataset_stems_.find(Stem(image));
    if (whole != dataset_.end()) return whole->second;
    return stem != dataset_stems_.end() ? stem->second : Views();
  }

 private:
  std::set<std::string> test_, test_stems_;
  std::map<std::string, Views> dataset_, dataset_stems_;
};

/// confidence_dir/NAME.png, with NAME the path below the folder or the file's name alone; empty when there is none.
fs::path FindConfidence(const fs::path& confidence_dir, const std::string& shown) {
  if (confidence_dir.empty()) return {};
  fs::path whole = ViewName(shown);
  if (HasImageExtension(whole)) whole.replace_extension();
  for (const fs::path& name : {whole, whole.filename(), fs::path(FileName(shown))}) {
    fs::path found = FindFrameImage(confidence_dir, name.string());
    if (!found.empty()) return found;
  }
  return {};
}

/// Adds the images that transforms.json names.
void AddFrames(const fs::path& dir, const ViewNames& views, const Similarity& placement, FolderContent* content) {
  const fs::path path = dir / "transforms.json";
  const json file = ReadTransformsFile(path);
  std::set<std::string> names;
  std::set<fs::path> used, folders{dir};
  int index = 0;
  for (const json& entry : file["frames"]) {
    const auto [frame, file_path] = NamedFrame(file, entry, path, index++);
    FolderImage image{FileName(file_path), file_path, FindFrameImage(dir, file_path), {}, {}};
    image.confidence = FindConfidence(content->confidence_dir, file_path);
    const auto skip = [&, shown = file_path](const char* why) { content->skipped[why].push_back(shown); };
    if (image.file.empty()) {
      skip(kNoFile);
      continue;
    }
    if (!IsBelow(dir, image.file)) {
      skip(kOutside);
      continue;
    }
    used.insert(image.file.lexically_normal());
    folders.insert(image.file.parent_path().lexically_normal());
    try {  // intrinsics without w and h take the image's size; the image is at fault then, not transforms.json
      int width = 0, height = 0;
      ReadImageSize(image.file, &width, &height);
    } catch (const InputError&) {
      skip(kUnreadableImage);
      continue;
    }
    const Intrinsics intrinsics = ReadTransformsIntrinsics(frame, image.file);
    image.camera = {intrinsics.width,
                    intrinsics.height,
                    intrinsics.fx(),
                    intrinsics.fy(),
                    intrinsics.cx(),
                    intrinsics.cy(),
                    Moved(ReadTransformsPose(frame).cam_from_world, placement)};
    if (intrinsics.model != CameraModel::kPinhole) {
      skip(kDistorted);
    } else if (views.IsTest(file_path)) {
      skip(kTestName);
    } else if (!names.insert(image.name).second) {
      skip(kTwice);
    } else {
      content->images.push_back(std::move(image));
    }
  }
  for (const fs::path& folder : folders) {
    for (const fs::path& stray : ImagesIn(folder)) {
      if (used.count(stray) == 0) content->skipped[kNoPose].push_back(stray.lexically_relative(dir).string());
    }
  }
}

/// Adds the images that are named like views.
void AddNamedLikeViews(const fs::path& dir, const ViewNames& views, FolderContent* content) {
  const std::vector<fs::path> files = ImagesIn(dir);
  if (files.empty()) throw InputError("{}: has no images; put the proposals there as PNG or JPEG", dir.string());
  std::set<std::string> names;
  for (const fs::path& file : files) {
    const std::string shown = file.filename().string();
    FolderImage image{FileName(shown), shown, file, FindConfidence(content->confidence_dir, shown), {}};
    const Views fitting = views.Dataset(shown);
    const auto skip = [&](const char* why) { content->skipped[why].push_back(shown); };
    if (views.IsTest(shown)) {
      skip(kTestName);
    } else if (fitting.size() != 1) {
      skip(fitting.empty() ? kNoView : kSeveralViews);
    } else if (!names.insert(image.name).second) {
      skip(kTwice);
    } else {
      image.camera = fitting[0]->camera;
      content->images.push_back(std::move(image));
    }
  }
}

fs::path IfFolder(const fs::path& dir) { return IsFolder(dir) ? dir : fs::path(); }

}  // namespace

FolderContent FindFolderImages(const fs::path& given, const FolderRequest& request) {
  // "synthetic_12/" and "." have names, too.
  std::error_code error;
  fs::path dir = fs::absolute(given, error).lexically_normal();
  if (!dir.has_filename()) dir = dir.parent_path();
  if (error || given.empty() || !IsFolder(dir)) {
    throw InputError("{}: is not a folder; give the one that holds the proposals", given.string());
  }
  const ViewNames views(request);
  FolderContent content;
  if (IsFile(dir / "transforms.json")) {
    content.images_dir = dir;
    content.confidence_dir = IfFolder(dir / "confidence");
    AddFrames(dir, views, request.placement, &content);
  } else {
    content.images_dir = SyntheticFolder(dir);
    content.confidence_dir = IfFolder(content.images_dir.string() + "_attention_maps");
    AddNamedLikeViews(content.images_dir, views, &content);
  }
  return content;
}

}  // namespace oraclegs
