#include "oraclegs/scene/spheres.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "oraclegs/camera/sphere_faces.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/photo_folder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

bool IsTwiceAsWide(int width, int height) { return height > 0 && width == int64_t{2} * height; }

bool IsSphere(const SceneView& photo, SphereChoice choice) {
  try {
    const ImageHeader header = ReadImageHeader(photo.image_path);
    return IsTwiceAsWide(header.width, header.height) &&
           (choice == SphereChoice::kAll || header.projection == Projection::kSphere);
  } catch (const InputError&) {  // whoever needs its pixels says so
    return false;
  }
}

/// "trip/IMG_1_front.jpg", or the next name that no view has.
std::string FaceName(const std::string& sphere, const char* face, const std::string& extension,
                     std::set<std::string>* taken) {
  const std::string stem = fs::path(sphere).replace_extension().generic_string() + "_" + face;
  std::string name = stem + extension;
  for (int k = 2; !taken->insert(name).second; ++k) name = fmt::format("{}-{}{}", stem, k, extension);
  return name;
}

/// The views of one sphere.
std::vector<SceneView> FacesOf(const SceneView& sphere, const fs::path& dir, std::set<std::string>* taken) {
  const ImageHeader header = ReadImageHeader(sphere.image_path);
  if (!IsTwiceAsWide(header.width, header.height)) {
    throw InputError(
        "{}: is {} x {}, but an equirectangular photo is twice as wide as high; export the whole sphere, 360 x 180 "
        "degrees",
        sphere.image_path.string(), header.width, header.height);
  }
  const std::string extension = header.extension == ".jpg" ? ".jpg" : ".png";
  const Intrinsics camera = FaceIntrinsics(header.width);
  std::vector<SceneView> faces;
  for (int i = 0; i < kSphereFaces; ++i) {
    const SphereFace& face = SphereFaces()[static_cast<size_t>(i)];
    SceneView view = sphere;
    view.is_sphere = false;
    view.sphere = SphereSource{sphere.name, sphere.image_path, sphere.mask_path, sphere.mask_white, i};
    view.name = FaceName(sphere.name, face.name, extension, taken);
    view.image_path = dir / "images" / view.name;
    view.mask_path = sphere.mask_path.empty() ? fs::path() : dir / "masks" / (view.name + ".png");
    view.mask_white = 255;
    view.depth_path.clear();  // a sensor's depth of a whole sphere is not cut
    view.confidence_path.clear();
    if (i > 0) view.gps.reset();  // one position, not six that agree
    view.intrinsics = camera;
    if (view.cam_from_world) {
      view.cam_from_world = Eigen::Isometry3d(face.face_from_sphere) * *view.cam_from_world;
    } else {
      view.intrinsics.params.clear();
      view.focal_prior = camera.fx();
    }
    faces.push_back(std::move(view));
  }
  return faces;
}

}  // namespace

void MarkSpheres(SphereChoice choice, Scene* scene) {
  for (SceneView& view : scene->views) view.is_sphere = IsSphere(view, choice);
}

void RequireNoSpheres(const Scene& scene) {
  const auto sphere =
      std::find_if(scene.views.begin(), scene.views.end(), [](const SceneView& view) { return view.is_sphere; });
  if (sphere == scene.views.end()) return;
  throw InputError(
      "{}: is a spherical photo (EQUIRECTANGULAR), which only `oraclegs reconstruct` takes apart; name its workspace "
      "instead",
      sphere->image_path.string());
}

void TakeFaces(const fs::path& dir, const Listener& listener, Scene* scene) {
  std::vector<SceneView> spheres, views;
  for (SceneView& view : scene->views) (view.is_sphere ? spheres : views).push_back(std::move(view));
  if (spheres.empty()) {
    scene->views = std::move(views);
    return;
  }
  const size_t count = views.size() + spheres.size() * kSphereFaces;
  if (!scene->HasPoses() && count > static_cast<size_t>(kMaxPhotos)) {
    throw InputError(
        "{}: its {} are cut into {} views each, and at most {} views without poses can be put together; copy some to "
        "a folder of their own",
        scene->root.string(), Counted(spheres.size(), "spherical photo"), kSphereFaces, kMaxPhotos);
  }
  std::set<std::string> taken;
  for (const SceneView& view : views) taken.insert(view.name);
  for (const SceneView& sphere : spheres) {
    std::vector<SceneView> faces = FacesOf(sphere, dir, &taken);
    std::move(faces.begin(), faces.end(), std::back_inserter(views));
  }
  std::sort(views.begin(), views.end(),
            [](const SceneView& a, const SceneView& b) { return NaturalLess(a.name, b.name); });
  scene->views = std::move(views);
  listener(Note{
      fmt::format("{}: {} cut into {} views each, {} x {} degrees", scene->root.string(),
                  spheres.size() == 1 ? "1 spherical photo is" : fmt::format("{} spherical photos are", spheres.size()),
                  kSphereFaces, kFaceDegrees, kFaceDegrees)});
}

std::vector<std::vector<int>> ByPhoto(const Scene& scene, const std::vector<int>& views) {
  std::vector<std::vector<int>> photos;
  std::map<std::string, size_t> photo_of;
  for (const int v : views) {
    const auto& sphere = scene.views[static_cast<size_t>(v)].sphere;
    const size_t photo = sphere ? photo_of.emplace(sphere->name, photos.size()).first->second : photos.size();
    if (photo == photos.size()) photos.emplace_back();
    photos[photo].push_back(v);
  }
  return photos;
}

}  // namespace oraclegs
