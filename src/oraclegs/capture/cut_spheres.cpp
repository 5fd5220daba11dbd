#include "oraclegs/capture/cut_spheres.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "oraclegs/camera/sphere_faces.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/file_facts.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/masks.h"
#include "oraclegs/scene/spheres.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kFacesFile[] = "faces.json";
constexpr char kHalfCut[] = ".oraclegs-faces.tmp";
constexpr int kFaceQuality = 97;  // of a JPEG: hardly a difference to the photo

json DigestJson(const fs::path& file) {
  if (file.empty()) return nullptr;
  const FileDigest digest = DigestOf(file);
  return {{"bytes", digest.bytes}, {"crc32", digest.crc32}};
}

json RotationJson(const Eigen::Matrix3d& rotation) {
  json rows = json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({rotation(r, 0), rotation(r, 1), rotation(r, 2)});
  return rows;
}

json CameraJson(const Intrinsics& camera) {
  return {{"model", CameraModelName(camera.model)},
          {"width", camera.width},
          {"height", camera.height},
          {"params", camera.params}};
}

/// The views of each sphere.
std::vector<std::vector<const SceneView*>> Spheres(const Scene& scene) {
  std::vector<std::vector<const SceneView*>> spheres;
  for (const std::vector<int>& photo : ByPhoto(scene, AllViews(scene))) {
    if (!scene.views[static_cast<size_t>(photo.front())].sphere) continue;
    spheres.emplace_back();
    for (const int v : photo) spheres.back().push_back(&scene.views[static_cast<size_t>(v)]);
  }
  return spheres;
}

json Describe(const std::vector<std::vector<const SceneView*>>& spheres) {
  json out = json::array();
  for (const auto& views : spheres) {
    const SphereSource& source = *views.front()->sphere;
    json faces = json::array();
    for (const SceneView* view : views) {
      const SphereFace& face = SphereFaces()[static_cast<size_t>(view->sphere->face)];
      faces.push_back({{"image", view->name}, {"face_from_sphere", RotationJson(face.face_from_sphere)}});
      if (source.lens) faces.back()["camera"] = CameraJson(view->intrinsics);
    }
    out.push_back({{"photo", source.name},
                   {"file", DigestJson(source.image_path)},
                   {"mask", DigestJson(source.mask_path)},
                   {"mask_white", source.mask_white},
                   {"degrees", kFaceDegrees},
                   {"faces", faces}});
    if (source.lens) {
      out.back()["lens"] = CameraJson(source.lens->intrinsics);
      out.back()["reach"] = source.lens->reach;
    } else {
      out.back()["side"] = views.front()->intrinsics.width;
    }
  }
  return {{"format", 1}, {"spheres", out}};
}

bool IsCut(const fs::path& dir, const json& wanted, const std::vector<std::vector<const SceneView*>>& spheres) {
  std::error_code error;
  if (!fs::is_regular_file(dir / kFacesFile, error)) return false;
  const json found = ParseJsonOrDiscard(ReadFile(dir / kFacesFile));
  if (!found.is_object() || found != wanted) return false;
  for (const auto& views : spheres) {
    for (const SceneView* view : views) {
      if (!IsFile(view->image_path) || (!view->mask_path.empty() && !IsFile(view->mask_path))) return false;
    }
  }
  return true;
}

void WriteImage(const fs::path& path, const Image8& image) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) throw RunError("{}: cannot be made: {}", path.parent_path().string(), SystemReason(error));
  if (path.extension() == ".jpg") {
    WriteFileAtomically(path, CompressJpeg(image, kFaceQuality));
  } else {
    WritePng(path, image);
  }
}

/// The photo that views were cut from, as it was itself a view.
SceneView PhotoOf(const SphereSource& source) {
  SceneView photo;
  photo.name = source.name;
  photo.image_path = source.image_path;
  photo.mask_path = source.mask_path;
  photo.mask_white = source.mask_white;
  photo.as_stored = source.as_stored;
  return photo;
}

/// How a fisheye photo fits its lens.
Orientation OrientationOf(const SceneView& photo, const Intrinsics& lens) {
  const auto orientation = FittingOrientation(photo, photo.image_path, lens.width, lens.height);
  if (orientation) return *orientation;
  throw InputError(
      "{}: has another size than its camera, which was made for {} x {}; use the photos the poses were made "
      "from",
      photo.image_path.string(), lens.width, lens.height);
}

/// Writes the faces of one sphere or fisheye photo below `half`, which becomes `dir`.
void Cut(const std::vector<const SceneView*>& views, const fs::path& dir, const fs::path& half) {
  const SphereSource& source = *views.front()->sphere;
  const SceneView sphere = PhotoOf(source);
  const Orientation orientation = source.lens ? OrientationOf(sphere, source.lens->intrinsics) : Orientation::kUpright;
  const Image8 photo = ReadImage(source.image_path, orientation);
  Image8 mask;
  if (!source.mask_path.empty()) {
    mask = ReadMask(sphere, photo.width, photo.height, orientation);
  } else if (source.lens) {  // of what it shows
    mask = {photo.width, photo.height, 1,
            std::vector<uint8_t>(photo.data.size() / static_cast<size_t>(photo.channels), 255)};
  }
  for (const SceneView* view : views) {
    const Eigen::Matrix3d& turn = SphereFaces()[static_cast<size_t>(view->sphere->face)].face_from_sphere;
    const Intrinsics camera = source.lens ? view->intrinsics : FaceIntrinsics(photo.width);
    WriteImage(half / view->image_path.lexically_relative(dir),
               CutFace(photo, source.lens, turn, camera, SphereFilter::kBicubic));
    if (view->mask_path.empty()) continue;
    WriteImage(half / view->mask_path.lexically_relative(dir),
               CutFace(mask, source.lens, turn, camera, SphereFilter::kNearest));
  }
}

}  // namespace

void CutSpheres(const Scene& scene, const fs::path& dir, const Listener& listener) {
  const auto spheres = Spheres(scene);
  if (spheres.empty()) return;
  const json wanted = Describe(spheres);
  if (IsCut(dir, wanted, spheres)) return;
  listener(StageStarted{"import"});
  const auto start = std::chrono::steady_clock::now();
  const fs::path half = dir.parent_path() / kHalfCut;
  std::error_code error;
  fs::remove_all(half, error);
  try {
    for (size_t i = 0; i < spheres.size(); ++i) {
      ThrowIfInterrupted();
      Cut(spheres[i], dir, half);
      listener(StepDone{"import", static_cast<int64_t>(i) + 1, std::ssize(spheres), "photos", ""});
    }
    WriteFileAtomically(half / kFacesFile, wanted.dump(1) + "\n");
  } catch (...) {
    fs::remove_all(half, error);
    throw;
  }
  fs::remove_all(dir, error);
  if (!error) fs::rename(half, dir, error);
  if (error) throw RunError("{}: cannot be renamed to {}: {}", half.string(), dir.string(), SystemReason(error));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  listener(StageFinished{"import", seconds.count()});
}

}  // namespace oraclegs
