#include "oraclegs/scene/read_scene.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/photo_folder.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/scene/transforms.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

bool IsFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

/// What a folder holds, sorted; empty when it is not a folder.
std::vector<fs::path> ListFolder(const fs::path& dir) {
  if (!IsFolder(dir)) return {};
  std::vector<fs::path> entries;
  std::error_code error;
  fs::directory_iterator it(dir, error);
  for (; !error && it != fs::directory_iterator(); it.increment(error)) entries.push_back(it->path());
  if (error) throw InputError("{}: cannot be listed ({}); check its permissions", dir.string(), error.message());
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// Throws unless the folder that the user named exists.
void RequireFolder(const fs::path& path, const char* fix) {
  if (IsFolder(path)) return;
  std::error_code error;
  throw InputError("{}: {}; {}", path.string(), fs::exists(path, error) ? "is not a folder" : "no such folder", fix);
}

bool IsNumber(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c); });
}

/// The folder of the COLMAP model with the most images, empty when there is none. COLMAP numbers the pieces it could
/// not join: sparse/0, sparse/1, ...
fs::path FindModel(const fs::path& root, const Listener& listener) {
  std::vector<fs::path> models;
  for (const fs::path& dir : ListFolder(root / "sparse")) {
    if (IsNumber(dir.filename().string()) && IsColmapModel(dir)) models.push_back(dir);
  }
  if (models.empty()) {
    for (const fs::path& dir : {root / "sparse", root}) {
      if (IsColmapModel(dir)) return dir;
    }
    return {};
  }
  if (models.size() == 1) return models.front();
  fs::path best;
  size_t most = 0, total = 0;
  for (const fs::path& dir : models) {
    const size_t count = ReadColmapImages(dir).size();
    total += count;
    if (!best.empty() && count <= most) continue;
    best = dir;
    most = count;
  }
  listener(Note{fmt::format("{}: the largest of {} models is used, with {} of their {} images", best.string(),
                            models.size(), most, total)});
  return best;
}

/// The named image folder, or images/ when there is one, unless the model's names fit the scene folder itself.
fs::path FindImageFolder(const fs::path& root, const fs::path& model_dir, const SceneReadOptions& options) {
  if (!options.images.empty()) return root / options.images;
  const fs::path usual = root / "images";
  if (!IsFolder(usual)) return root;
  const std::vector<ColmapImage> images = ReadColmapImages(model_dir);
  const auto any_in = [&](const fs::path& dir) {
    return std::any_of(images.begin(), images.end(), [&](const ColmapImage& i) { return IsFile(dir / i.name); });
  };
  return !any_in(usual) && any_in(root) ? root : usual;
}

bool LiesIn(const fs::path& folder, const fs::path& path) {
  const fs::path outer = fs::absolute(folder / "").lexically_normal(), inner = fs::absolute(path).lexically_normal();
  const auto last = std::prev(outer.end());  // the empty name after the slash
  return std::mismatch(outer.begin(), last, inner.begin(), inner.end()).first == last;
}

/// What the scene's own files name lies in its folder, or in the one that the user named. Links are followed wherever
/// they lead: a file's text cannot make one.
void RequireInside(const Scene& scene, const fs::path& root, const SceneReadOptions& options) {
  if (options.allow_outside) return;
  for (const SceneView& view : scene.views) {
    for (const fs::path& path : {view.image_path, view.mask_path}) {
      if (path.empty() || LiesIn(root, path)) continue;
      if (!options.images.empty() && LiesIn(root / options.images, path)) continue;
      throw InputError(
          "{}: names {}, which lies outside the scene's folder; move it there, or add --allow-outside if you trust the "
          "scene",
          root.string(), OneLine(path.string()));
    }
  }
}

Scene ReadPhotoFolder(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  Scene scene;
  scene.format = SceneFormat::kPhotos;
  scene.views = ReadPhotos(options.images.empty() ? root / "images" : root / options.images, listener);
  if (scene.views.empty() && options.images.empty()) scene.views = ReadPhotos(root, listener);
  if (scene.views.empty()) {
    throw InputError(
        "{}: no scene found; expected a COLMAP model (sparse/0), transforms.json, transforms_train.json, or photos "
        "(JPEG, PNG, HEIC, AVIF, WebP, TIFF) here or in images/",
        (options.images.empty() ? root : root / options.images).string());
  }
  return scene;
}

}  // namespace

Scene ReadScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  RequireFolder(root, "name the folder that holds the scene");
  if (!options.images.empty())
    RequireFolder(root / options.images, "--images takes a folder, from the scene's or absolute");
  const fs::path model_dir = FindModel(root, listener);
  Scene scene;
  if (!model_dir.empty()) {
    scene = ReadColmapScene(model_dir, FindImageFolder(root, model_dir, options), listener);
  } else if (IsFile(root / "transforms.json")) {
    scene = ReadTransformsScene(root, options, listener);
  } else if (IsFile(root / "transforms_train.json")) {
    scene = ReadBlenderScene(root, options, listener);
  } else {
    scene = ReadPhotoFolder(root, options, listener);
  }
  if (scene.HasPoses()) RequireInside(scene, root, options);
  scene.root = root;
  RequireUtf8Names(scene);
  AttachMasks(root / "masks", listener, &scene);
  return scene;
}

}  // namespace oraclegs
