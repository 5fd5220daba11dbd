#include "oraclegs/scene/transforms.h"

#include <nlohmann/json.hpp>
#include <set>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/transforms_frame.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The image of a frame, below options.images when that is given, where the path's first folder may be left out.
fs::path FindImage(const fs::path& root, const SceneReadOptions& options, const std::string& written) {
  if (options.images.empty()) return FindFrameImage(root, written);
  const fs::path folder = root / options.images;
  fs::path whole = FindFrameImage(folder, written);
  if (!whole.empty()) return whole;
  const std::string name = ViewName(written);
  const size_t slash = name.find('/');
  return slash == std::string::npos ? fs::path() : FindFrameImage(folder, name.substr(slash + 1));
}

/// The views of one file, and the masks it names that do not exist.
struct FileViews {
  std::vector<SceneView> views;
  std::vector<std::string> missing_masks;
};

SceneView ReadView(const TransformsFrame& frame, const std::string& written, const fs::path& image_path) {
  SceneView view;
  view.image_path = image_path;
  const fs::path extension = image_path.extension();
  const bool appended = !image_path.empty() && image_path.filename() != fs::path(written).filename();
  view.name = ViewName(appended ? written + extension.string() : written);
  if (image_path.empty()) return view;  // left out, so its camera is not read
  view.intrinsics = ReadTransformsIntrinsics(frame, image_path);
  view.cam_from_world = ReadTransformsPose(frame);
  return view;
}

FileViews ReadFrames(const fs::path& path, const SceneReadOptions& options) {
  const fs::path root = path.parent_path();
  const json file = ReadTransformsFile(path);
  FileViews result;
  int index = 0;
  for (const json& entry : file["frames"]) {
    const auto [frame, name] = NamedFrame(file, entry, path, index++);
    SceneView view = ReadView(frame, name, FindImage(root, options, name));
    if (const auto mask = entry.contains("mask_path") ? frame.FindText("mask_path") : std::nullopt) {
      if (IsFile(root / *mask)) {
        view.mask_path = root / *mask;
      } else {
        result.missing_masks.push_back(*mask);
      }
    }
    result.views.push_back(std::move(view));
  }
  return result;
}

std::vector<SceneView> ReadViews(const fs::path& path, const SceneReadOptions& options, const Listener& listener) {
  FileViews read = ReadFrames(path, options);
  if (!read.missing_masks.empty()) {
    listener(Warning{fmt::format("{}: {} mask files do not exist, those views use all pixels: {}", path.string(),
                                 read.missing_masks.size(), SomeNames(read.missing_masks))});
  }
  return std::move(read.views);
}

std::string SearchedFolder(const fs::path& root, const SceneReadOptions& options) {
  return (options.images.empty() ? root : root / options.images).string();
}

}  // namespace

Scene ReadTransformsScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const fs::path path = root / "transforms.json";
  Scene scene;
  scene.root = root;
  scene.format = SceneFormat::kTransforms;
  KeepViewsWithImages(ReadViews(path, options, listener), path.string(), SearchedFolder(root, options), listener,
                      &scene);
  return scene;
}

Scene ReadBlenderScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  struct Part {
    const char* file;
    DeclaredRole role;
  };
  constexpr Part kParts[] = {{"transforms_train.json", DeclaredRole::kTrain},
                             {"transforms_test.json", DeclaredRole::kTest},
                             {"transforms_val.json", DeclaredRole::kVal}};
  std::vector<SceneView> views;
  std::set<std::string> names;
  for (const Part& part : kParts) {
    const fs::path path = root / part.file;
    if (part.role != DeclaredRole::kTrain && !IsFile(path)) {
      if (part.role == DeclaredRole::kTest) {
        listener(Warning{fmt::format("{}: has no transforms_test.json, so no view is held out", root.string())});
      }
      continue;
    }
    for (SceneView& view : ReadViews(path, options, listener)) {
      view.role = part.role;
      const bool is_new = names.insert(view.name).second;
      if (is_new || part.role != DeclaredRole::kVal) views.push_back(std::move(view));
    }
  }
  Scene scene;
  scene.root = root;
  scene.format = SceneFormat::kBlender;
  KeepViewsWithImages(std::move(views), root.string(), SearchedFolder(root, options), listener, &scene);
  return scene;
}

}  // namespace oraclegs
