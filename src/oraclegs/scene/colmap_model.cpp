#include "oraclegs/scene/colmap_model.h"

#include <algorithm>
#include <unordered_map>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/scene/colmap_binary.h"
#include "oraclegs/scene/colmap_text.h"
#include "oraclegs/scene/scene_validation.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// dir/STEM.bin, or dir/STEM.txt, or empty.
fs::path FindPart(const fs::path& dir, const char* stem) {
  for (const char* extension : {".bin", ".txt"}) {
    const fs::path path = dir / (std::string(stem) + extension);
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

std::vector<SceneView> MakeViews(const fs::path& model_dir, const fs::path& image_dir,
                                 const std::vector<ColmapImage>& images) {
  const fs::path cameras_path = RequirePart(model_dir, "cameras");
  const ColmapCameras cameras = ReadColmapCameras(model_dir);
  std::vector<SceneView> views;
  views.reserve(images.size());
  for (const ColmapImage& image : images) {
    const auto camera = cameras.find(image.camera_id);
    if (camera == cameras.end()) {
      throw InputError("{}: lacks camera {}, which image '{}' was taken with; the files belong to different models",
                       cameras_path.string(), image.camera_id, image.name);
    }
    SceneView view;
    view.name = ViewName(image.name);
    view.lens = camera->second;
    view.cam_from_world = image.cam_from_world;
    view.as_stored = true;  // colmap ignores the EXIF orientation
    if (IsFile(image_dir / image.name)) view.image_path = image_dir / image.name;
    views.push_back(std::move(view));
  }
  return views;
}

/// Image ids as indices of scene.views; images that were left out have none.
std::unordered_map<uint32_t, int> ViewOfImage(const Scene& scene, const std::vector<ColmapImage>& images,
                                              const std::string& source) {
  std::unordered_map<std::string, int> view_of_name;
  for (size_t i = 0; i < scene.views.size(); ++i) view_of_name[scene.views[i].name] = static_cast<int>(i);
  std::unordered_map<uint32_t, int> view_of_image;
  for (const ColmapImage& image : images) {
    const auto view = view_of_name.find(ViewName(image.name));
    const int index = view == view_of_name.end() ? -1 : view->second;
    if (!view_of_image.emplace(image.id, index).second) {
      throw InputError("{}: image id {} is there twice", source, image.id);
    }
  }
  return view_of_image;
}

std::vector<ScenePoint> MakePoints(const std::vector<ColmapPoint>& points,
                                   const std::unordered_map<uint32_t, int>& view_of_image) {
  std::vector<ScenePoint> kept;
  kept.reserve(points.size());
  for (const ColmapPoint& point : points) {
    if (!point.xyz.allFinite()) continue;
    ScenePoint made;
    made.xyz = point.xyz;
    made.rgb = point.rgb;
    for (const uint32_t id : point.image_ids) {
      const auto view = view_of_image.find(id);
      if (view != view_of_image.end() && view->second >= 0) made.views.push_back(view->second);
    }
    if (made.views.empty()) continue;
    std::sort(made.views.begin(), made.views.end());
    made.views.erase(std::unique(made.views.begin(), made.views.end()), made.views.end());
    kept.push_back(std::move(made));
  }
  return kept;
}

/// The points as lines of points3D.txt, and the keypoints that their tracks refer to. Ids begin at 1.
class Tracks {
 public:
  explicit Tracks(const std::vector<ColmapTrack>& points) {
    for (size_t p = 0; p < points.size(); ++p) {
      const ColmapTrack& point = points[p];
      points_ += fmt::format("{} {} {} {} {} {} {} 0", p + 1, point.xyz.x(), point.xyz.y(), point.xyz.z(), point.rgb[0],
                             point.rgb[1], point.rgb[2]);
      for (const ColmapSight& sight : point.sights) {
        Lines& lines = by_image_[sight.image_id];
        points_ += fmt::format(" {} {}", sight.image_id, lines.count++);
        lines.text += fmt::format("{}{} {} {}", lines.text.empty() ? "" : " ", sight.pixel.x(), sight.pixel.y(), p + 1);
      }
      points_ += "\n";
    }
  }

  const std::string& points() const { return points_; }
  std::string Keypoints(uint32_t image) const {
    const auto it = by_image_.find(image);
    return it == by_image_.end() ? "" : it->second.text;
  }

 private:
  struct Lines {
    size_t count = 0;
    std::string text;
  };
  std::map<uint32_t, Lines> by_image_;
  std::string points_;
};

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

Scene ReadColmapScene(const fs::path& model_dir, const fs::path& image_dir, const Listener& listener) {
  Scene scene;
  scene.root = model_dir;
  scene.format = SceneFormat::kColmap;
  const std::vector<ColmapImage> images = ReadColmapImages(model_dir);
  const std::string source = model_dir.string();
  KeepViewsWithImages(MakeViews(model_dir, image_dir, images), source, image_dir.string(), listener, &scene);
  if (FindPart(model_dir, "points3D").empty()) {
    listener(Warning{fmt::format("{}: has no points3D file, so its points are not used", source)});
  }
  const std::vector<ColmapPoint> points = ReadColmapPoints(model_dir);
  scene.points = MakePoints(points, ViewOfImage(scene, images, source));
  const size_t dropped = points.size() - scene.points.size();
  if (dropped > 0) {
    listener(Warning{fmt::format("{}: {} of {} points are left out: not finite, or seen by no photograph that is here",
                                 source, dropped, points.size())});
  }
  return scene;
}

void WriteColmapText(const fs::path& dir, const ColmapCameras& cameras, const std::vector<ColmapImage>& images,
                     const std::vector<ColmapTrack>& points) {
  const Tracks tracks(points);
  std::string text = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
  for (const auto& [id, lens] : cameras) {
    text += fmt::format("{} {} {} {} {}\n", id, CameraModelName(lens.model), lens.width, lens.height,
                        fmt::join(lens.params, " "));
  }
  WriteFileAtomically(dir / "cameras.txt", text);

  text = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then a line of keypoints\n";
  for (const ColmapImage& image : images) {
    if (image.name.empty() || image.name.find_first_of(" \t\r\n\v\f") != std::string::npos) {
      throw InputError("{}: COLMAP's text format cannot hold the image name '{}'; rename the photograph without blanks",
                       (dir / "images.txt").string(), image.name);
    }
    Eigen::Quaterniond q(image.cam_from_world.linear());
    q.normalize();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    const Eigen::Vector3d t = image.cam_from_world.translation();
    text += fmt::format("{} {} {} {} {} {} {} {} {} {}\n{}\n", image.id, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(),
                        t.z(), image.camera_id, image.name, tracks.Keypoints(image.id));
  }
  WriteFileAtomically(dir / "images.txt", text);
  WriteFileAtomically(dir / "points3D.txt", "# POINT3D_ID X Y Z R G B ERROR TRACK[]\n" + tracks.points());
}

Eigen::Isometry3d PoseFromQuaternion(const std::array<double, 4>& wxyz, const Eigen::Vector3d& translation,
                                     const std::string& file, const std::string& image) {
  constexpr double kSmallestNorm = 1e-9;  // below it the direction is rounding noise
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!q.coeffs().allFinite() || !translation.allFinite()) {
    throw InputError("{}: the pose of image '{}' is not finite; remove the image from the model or register it again",
                     file, image);
  }
  const double norm = q.coeffs().stableNorm();
  if (!(norm > kSmallestNorm) || !std::isfinite(norm)) {
    throw InputError(
        "{}: the rotation of image '{}' is not one (its quaternion has length {}); register the image again", file,
        image, norm);
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(q.coeffs() / norm).normalized().toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

}  // namespace oraclegs
