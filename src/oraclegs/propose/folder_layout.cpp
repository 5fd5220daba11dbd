#include "oraclegs/propose/folder_layout.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/scene/transforms_frame.h"
#include "oraclegs/scene/scene_validation.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kNoFile = "no picture file is there; make it, or remove the frame";
constexpr const char* kNoPose = "transforms.json has no frame for them; add one with the pose";
constexpr const char* kNoView = "no view of the scene has their name; name each after the view whose pose it has";
constexpr const char* kSeveralViews = "several views of the scene have their name; use the whole path, a/b.jpg as a_b";
constexpr const char* kTwice = "another picture has their name, too; remove one of the two";
constexpr const char* kLens = "their lens is no pinhole; remove the distortion";
constexpr const char* kTestName =
    "they have the name of a test view, whose picture must stay unseen; remove them, or rename them when they show "
    "another pose";

bool IsFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

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

std::vector<fs::path> Pictures(const fs::path& dir) {
  std::vector<fs::path> pictures;
  for (const fs::path& path : Entries(dir)) {
    if (HasImageExtension(path) && IsFile(path)) pictures.push_back(path);
  }
  return pictures;
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
  if (Pictures(dir).empty()) {
    throw InputError("{}: has no pictures; give a folder with pictures and transforms.json, or synthetic_N",
                     dir.string());
  }
  throw InputError(
      "{}: has pictures but no transforms.json with their poses; add it, or name the folder synthetic_N "
      "when its pictures are named like the scene's views",
      dir.string());
}

using Views = std::vector<const Target*>;

std::string Stem(const std::string& view) { return FileName(fs::path(view).filename().string()); }

/// What a picture's name says about the scene's views.
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

  /// A file name that a test view has, too, is one: only the whole path tells train/r_0.png from test/r_0.png.
  bool IsTest(const std::string& picture) const {
    return test_.count(FileName(picture)) > 0 ||
           (dataset_.count(FileName(picture)) == 0 && test_stems_.count(Stem(picture)) > 0);
  }
  /// Views by whole path if one has that, or else by file name alone.
  Views Dataset(const std::string& picture) const {
    const auto whole = dataset_.find(FileName(picture)), stem = dataset_stems_.find(Stem(picture));
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
    const fs::path found = FindFrameImage(confidence_dir, name.string());
    if (!found.empty()) return found;
  }
  return {};
}

/// Adds the pictures that transforms.json names.
void AddFrames(const fs::path& dir, const ViewNames& views, FolderContent* content) {
  const fs::path path = dir / "transforms.json";
  const json file = ReadTransformsFile(path);
  std::set<std::string> names;
  std::set<fs::path> used, folders{dir};
  int index = 0;
  for (const json& entry : file["frames"]) {
    const auto [frame, file_path] = NamedFrame(file, entry, path, index++);
    FolderPicture picture{FileName(file_path), file_path, FindFrameImage(dir, file_path), {}, {}};
    picture.confidence = FindConfidence(content->confidence_dir, file_path);
    const auto leave_out = [&, shown = file_path](const char* why) { content->left_out[why].push_back(shown); };
    if (picture.file.empty()) {
      leave_out(kNoFile);
      continue;
    }
    used.insert(picture.file.lexically_normal());
    if (IsBelow(dir, picture.file)) folders.insert(picture.file.parent_path().lexically_normal());
    try {  // a lens without w and h takes the picture's size; that is the picture's fault, not the file's
      int width = 0, height = 0;
      ReadImageSize(picture.file, &width, &height);
    } catch (const InputError&) {
      leave_out(kUnreadablePicture);
      continue;
    }
    const Intrinsics lens = ReadTransformsLens(frame, picture.file);
    picture.camera = {lens.width, lens.height, lens.fx(), lens.fy(), lens.cx(), lens.cy(), ReadTransformsPose(frame)};
    if (lens.model != CameraModel::kPinhole) {
      leave_out(kLens);
    } else if (views.IsTest(file_path)) {
      leave_out(kTestName);
    } else if (!names.insert(picture.name).second) {
      leave_out(kTwice);
    } else {
      content->pictures.push_back(std::move(picture));
    }
  }
  for (const fs::path& folder : folders) {
    for (const fs::path& stray : Pictures(folder)) {
      if (used.count(stray) == 0) content->left_out[kNoPose].push_back(stray.lexically_relative(dir).string());
    }
  }
}

/// Adds the pictures that are named like views.
void AddNamedLikeViews(const fs::path& dir, const ViewNames& views, FolderContent* content) {
  const std::vector<fs::path> files = Pictures(dir);
  if (files.empty()) throw InputError("{}: has no pictures; put the proposals there as PNG or JPEG", dir.string());
  std::set<std::string> names;
  for (const fs::path& file : files) {
    const std::string shown = file.filename().string();
    FolderPicture picture{FileName(shown), shown, file, FindConfidence(content->confidence_dir, shown), {}};
    const Views fitting = views.Dataset(shown);
    const auto leave_out = [&](const char* why) { content->left_out[why].push_back(shown); };
    if (views.IsTest(shown)) {
      leave_out(kTestName);
    } else if (fitting.size() != 1) {
      leave_out(fitting.empty() ? kNoView : kSeveralViews);
    } else if (!names.insert(picture.name).second) {
      leave_out(kTwice);
    } else {
      picture.camera = fitting[0]->camera;
      content->pictures.push_back(std::move(picture));
    }
  }
}

fs::path IfFolder(const fs::path& dir) { return IsFolder(dir) ? dir : fs::path(); }

}  // namespace

FolderContent FindFolderPictures(const fs::path& given, const FolderRequest& request) {
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
    content.pictures_dir = dir;
    content.confidence_dir = IfFolder(dir / "confidence");
    AddFrames(dir, views, &content);
  } else {
    content.pictures_dir = SyntheticFolder(dir);
    content.confidence_dir = IfFolder(content.pictures_dir.string() + "_attention_maps");
    AddNamedLikeViews(content.pictures_dir, views, &content);
  }
  return content;
}

}  // namespace oraclegs
