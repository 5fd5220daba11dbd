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
#include "oraclegs/scene/masks.h"
#include "oraclegs/scene/spheres.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kFacesFile[] = "faces.json";
constexpr char kHalfCut[] = ".oraclegs-faces.tmp";
constexpr int kFaceQuality = 97;  // of a JPEG, hardly to be told from the photo

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
    }
    out.push_back({{"photo", source.name},
                   {"file", DigestJson(source.image_path)},
                   {"mask", DigestJson(source.mask_path)},
                   {"mask_white", source.mask_white},
                   {"side", views.front()->intrinsics.width},
                   {"degrees", kFaceDegrees},
                   {"faces", faces}});
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

/// Writes the faces of one sphere below `half`, which becomes `dir`.
void Cut(const std::vector<const SceneView*>& views, const fs::path& dir, const fs::path& half) {
  const SphereSource& source = *views.front()->sphere;
  const Image8 photo = ReadImage(source.image_path);
  SceneView sphere;
  sphere.name = source.name;
  sphere.image_path = source.image_path;
  sphere.mask_path = source.mask_path;
  sphere.mask_white = source.mask_white;
  const Image8 mask =
      source.mask_path.empty() ? Image8() : ReadMask(sphere, photo.width, photo.height, Orientation::kUpright);
  for (const SceneView* view : views) {
    const Eigen::Matrix3d& turn = SphereFaces()[static_cast<size_t>(view->sphere->face)].face_from_sphere;
    const Intrinsics camera = FaceIntrinsics(photo.width);
    WriteImage(half / view->image_path.lexically_relative(dir), CutFace(photo, turn, camera, SphereFilter::kBicubic));
    if (view->mask_path.empty()) continue;
    WriteImage(half / view->mask_path.lexically_relative(dir), CutFace(mask, turn, camera, SphereFilter::kNearest));
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
      listener(StepDone{"import", static_cast<int64_t>(i) + 1, std::ssize(spheres), "spheres", ""});
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
