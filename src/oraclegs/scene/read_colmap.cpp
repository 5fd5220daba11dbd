#include "oraclegs/scene/read_colmap.h"

#include <algorithm>
#include <unordered_map>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/scene/colmap_files.h"
#include "oraclegs/scene/named_files.h"
#include "oraclegs/scene/point_views.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// dir/STEM.bin, or dir/STEM.txt, or empty.
fs::path FindPart(const fs::path& dir, const char* stem) {
  for (const char* extension : {".bin", ".txt"}) {
    fs::path path = dir / (std::string(stem) + extension);
    if (IsFile(path)) return path;
  }
  return {};
}

fs::path RequirePart(const fs::path& dir, const char* stem) {
  fs::path path = FindPart(dir, stem);
  if (path.empty()) {
    throw InputError("{}: has neither {}.bin nor {}.txt; a COLMAP model needs cameras, images and points3D",
                     dir.string(), stem, stem);
  }
  return path;
}

/// Parses a part with the parser of its encoding.
template <class Binary, class Text>
auto ParsePart(const fs::path& path, Binary binary, Text text) {
  const std::string bytes = ReadFile(path);
  return path.extension() == ".bin" ? binary(bytes, path.string()) : text(bytes, path.string());
}

/// The views of a model's images, in their order.
std::vector<SceneView> MakeViews(const fs::path& model_dir, const fs::path& image_dir,
                                 const std::vector<ColmapImage>& images, bool allow_outside, const Listener& listener) {
  const fs::path cameras_path = RequirePart(model_dir, "cameras");
  const ColmapCameras cameras = ReadColmapCameras(model_dir);
  NamedFilesQuery query{model_dir.string(), image_dir, {}, 1, allow_outside};
  for (const ColmapImage& image : images) query.written.push_back(image.name);
  const std::vector<NamedFile> files = FindNamedFiles(query, listener);
  std::vector<SceneView> views;
  views.reserve(images.size());
  for (size_t i = 0; i < images.size(); ++i) {
    const ColmapImage& image = images[i];
    const auto camera = cameras.find(image.camera_id);
    if (camera == cameras.end()) {
      throw InputError("{}: lacks camera {}, which image '{}' was taken with; the files belong to different models",
                       cameras_path.string(), image.camera_id, image.name);
    }
    SceneView view;
    view.name =
        files[i].name.empty() ? ViewName(files[i].path.empty() ? WithSlashes(image.name) : image.name) : files[i].name;
    view.intrinsics = camera->second;
    view.cam_from_world = image.cam_from_world;
    view.as_stored = true;  // colmap ignores the EXIF orientation
    view.image_path = files[i].path;
    views.push_back(std::move(view));
  }
  return views;
}

/// Image ids as indices of scene.views; images that were left out have none. `names`: of the images' views.
std::unordered_map<uint32_t, int> ViewOfImage(const Scene& scene, const std::vector<ColmapImage>& images,
                                              const std::vector<std::string>& names, const std::string& source) {
  std::unordered_map<std::string, int> view_of_name;
  for (size_t i = 0; i < scene.views.size(); ++i) view_of_name[scene.views[i].name] = static_cast<int>(i);
  std::unordered_map<uint32_t, int> view_of_image;
  for (size_t i = 0; i < images.size(); ++i) {
    const auto view = view_of_name.find(names[i]);
    const int index = view == view_of_name.end() ? -1 : view->second;
    if (!view_of_image.emplace(images[i].id, index).second) {
      throw InputError("{}: image id {} is there twice", source, images[i].id);
    }
  }
  return view_of_image;
}

struct KeptPoints {
  std::vector<ScenePoint> points;
  size_t not_finite = 0;
  size_t unseen = 0;     ///< by a photo that is here
  size_t untracked = 0;  ///< nothing says which photos saw them, so all count into whose image they fall
};

KeptPoints MakePoints(const std::vector<ColmapPoint>& points, const std::unordered_map<uint32_t, int>& view_of_image,
                      const Scene& scene) {
  KeptPoints kept;
  kept.points.reserve(points.size());
  std::vector<size_t> untracked;
  for (const ColmapPoint& point : points) {
    if (!point.xyz.allFinite()) {
      ++kept.not_finite;
      continue;
    }
    ScenePoint made;
    made.xyz = point.xyz;
    made.rgb = point.rgb;
    for (const uint32_t id : point.image_ids) {
      const auto view = view_of_image.find(id);
      if (view != view_of_image.end() && view->second >= 0) made.views.push_back(view->second);
    }
    if (point.image_ids.empty()) untracked.push_back(kept.points.size());
    std::sort(made.views.begin(), made.views.end());
    made.views.erase(std::unique(made.views.begin(), made.views.end()), made.views.end());
    kept.points.push_back(std::move(made));
  }
  kept.untracked = untracked.size();
  FindViewsOfPoints(untracked, scene, &kept.points);
  kept.unseen = std::erase_if(kept.points, [](const ScenePoint& point) { return point.views.empty(); });
  return kept;
}

}  // namespace

bool IsColmapModel(const fs::path& dir) {
  return !FindPart(dir, "cameras").empty() && !FindPart(dir, "images").empty();
}

ColmapCameras ReadColmapCameras(const fs::path& model_dir) {
  return ParsePart(RequirePart(model_dir, "cameras"), ParseCamerasBinary, ParseCamerasText);
}

std::vector<ColmapPoint> ReadColmapPoints(const fs::path& model_dir) {
  const fs::path path = FindPart(model_dir, "points3D");
  if (path.empty()) return {};
  return ParsePart(path, ParsePointsBinary, ParsePointsText);
}

std::vector<ColmapImage> ReadColmapImages(const fs::path& model_dir) {
  const fs::path path = RequirePart(model_dir, "images");
  std::vector<ColmapImage> images = ParsePart(path, ParseImagesBinary, ParseImagesText);
  for (const ColmapImage& image : images) {
    if (ViewName(image.name).empty()) throw InputError("{}: image {} has no name", path.string(), image.id);
  }
  return images;
}

Scene ReadColmapScene(const fs::path& model_dir, const fs::path& image_dir, const Listener& listener,
                      bool allow_outside) {
  Scene scene;
  scene.root = model_dir;
  scene.format = SceneFormat::kColmap;
  const std::vector<ColmapImage> images = ReadColmapImages(model_dir);
  const std::string source = model_dir.string();
  std::vector<SceneView> views = MakeViews(model_dir, image_dir, images, allow_outside, listener);
  std::vector<std::string> names;
  for (const SceneView& view : views) names.push_back(view.name);
  KeepViewsWithImages(std::move(views), source, image_dir.string(), listener, &scene);
  if (FindPart(model_dir, "points3D").empty()) {
    if (IsFile(model_dir / "points3D.ply")) {
      scene.point_file = model_dir / "points3D.ply";
    } else {
      listener(Warning{fmt::format("{}: has no points3D file, so its points are not used", source)});
    }
  }
  const std::vector<ColmapPoint> points = ReadColmapPoints(model_dir);
  KeptPoints kept = MakePoints(points, ViewOfImage(scene, images, names, source), scene);
  ReportUntracked(source, kept.untracked, points.size(), listener);
  ReportPointsLeftOut(source, kept.not_finite + kept.unseen, points.size(), listener);
  scene.points = std::move(kept.points);
  return scene;
}

}  // namespace oraclegs
