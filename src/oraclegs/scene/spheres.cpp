#include "oraclegs/scene/spheres.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "oraclegs/camera/sphere_faces.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/loaded_view.h"
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

void RequireTwiceAsWide(const SceneView& sphere, const ImageHeader& header) {
  if (IsTwiceAsWide(header.width, header.height)) return;
  throw InputError(
      "{}: is {} x {}, but an equirectangular photo is twice as wide as high; export the whole sphere, 360 x 180 "
      "degrees",
      sphere.image_path.string(), header.width, header.height);
}

bool IsWide(const SceneView& view) {
  return view.is_sphere || (!view.intrinsics.params.empty() && WideFisheye(view.intrinsics));
}

/// LightReach of the photo; 0 where it cannot be read, as whoever needs its pixels says.
double ReachIn(const SceneView& view, const FisheyeLens& lens) {
  try {
    const Intrinsics& camera = lens.intrinsics;
    const auto orientation = FittingOrientation(view, view.image_path, camera.width, camera.height);
    return orientation ? LightReach(ReadImage(view.image_path, *orientation), lens) : 0;
  } catch (const InputError&) {
    return 0;
  }
}

/// The cameras of a photo's faces; nullopt where it has no such face.
struct FaceCameras {
  std::optional<FisheyeLens> lens;
  std::array<std::optional<Intrinsics>, kSphereFaces> faces;
};

/// The cameras of the faces of a scene's photos: of fisheye lenses less what is black in the photos.
class CamerasOfFaces {
 public:
  explicit CamerasOfFaces(const std::vector<SceneView>& views) : views_(views) {}

  FaceCameras Of(const SceneView& view) {
    FaceCameras of_view;
    if (view.is_sphere) {
      of_view.faces.fill(FaceIntrinsics(ReadImageHeader(view.image_path).width));
      return of_view;
    }
    const auto known = std::find_if(lenses_.begin(), lenses_.end(), [&](const FaceCameras& lens) {
      return HaveOneCamera(lens.lens->intrinsics, view.intrinsics);
    });
    if (known != lenses_.end()) return *known;
    of_view.lens = Measured(*WideFisheye(view.intrinsics));
    std::transform(SphereFaces().begin(), SphereFaces().end(), of_view.faces.begin(),
                   [&](const SphereFace& face) { return FaceIntrinsics(*of_view.lens, face); });
    lenses_.push_back(of_view);
    return of_view;
  }

 private:
  static constexpr double kRim = 1.5e-2;  // radians at the end of an image circle, where it fades

  static bool HaveOneCamera(const Intrinsics& a, const Intrinsics& b) {
    return a.model == b.model && a.width == b.width && a.height == b.height && a.params == b.params;
  }

  FisheyeLens Measured(FisheyeLens lens) const {
    std::vector<const SceneView*> of_lens;
    for (const SceneView& view : views_) {
      if (!view.is_sphere && HaveOneCamera(lens.intrinsics, view.intrinsics)) of_lens.push_back(&view);
    }
    double lit = 0;  // a single photo may be dark at its border
    for (const size_t i : std::set<size_t>{0, of_lens.size() / 2, of_lens.size() - 1}) {
      lit = std::max(lit, ReachIn(*of_lens[i], lens));
    }
    if (lit > kRim && lit < lens.reach - kRim) lens.reach = lit - kRim;
    return lens;
  }

  const std::vector<SceneView>& views_;
  std::vector<FaceCameras> lenses_;
};

/// The views of one sphere or fisheye photo.
std::vector<SceneView> FacesOf(const SceneView& sphere, const FaceCameras& cameras, const fs::path& dir,
                               std::set<std::string>* taken) {
  const ImageHeader header = ReadImageHeader(sphere.image_path);
  if (sphere.is_sphere) RequireTwiceAsWide(sphere, header);
  const std::string extension = header.extension == ".jpg" ? ".jpg" : ".png";
  std::vector<SceneView> faces;
  for (int i = 0; i < kSphereFaces; ++i) {
    const SphereFace& face = SphereFaces()[static_cast<size_t>(i)];
    const std::optional<Intrinsics>& camera = cameras.faces[static_cast<size_t>(i)];
    if (!camera) continue;
    SceneView view = sphere;
    view.is_sphere = false;
    view.sphere = SphereSource{sphere.name, sphere.image_path, sphere.mask_path, sphere.mask_white,
                               i,           cameras.lens,      sphere.as_stored};
    view.name = FaceName(sphere.name, face.name, extension, taken);
    view.image_path = dir / "images" / view.name;
    const bool has_mask = cameras.lens || !sphere.mask_path.empty();
    view.mask_path = has_mask ? dir / "masks" / (view.name + ".png") : fs::path();
    view.mask_white = 255;
    view.depth_path.clear();  // a sensor's depth of a whole sphere is not cut
    view.confidence_path.clear();
    if (i > 0) view.gps.reset();  // one position, not six that agree
    view.intrinsics = *camera;
    if (view.cam_from_world) {
      view.cam_from_world = Eigen::Isometry3d(face.face_from_sphere) * *view.cam_from_world;
    } else {
      view.intrinsics.params.clear();
      view.focal_prior = camera->fx();
    }
    faces.push_back(std::move(view));
  }
  return faces;
}

bool SeesPoint(const SceneView& view, const Eigen::Vector3d& xyz) {
  const Eigen::Vector3d in_view = *view.cam_from_world * xyz;
  if (!(in_view.z() > 0)) return false;
  const Intrinsics& camera = view.intrinsics;
  const double x = camera.fx() * in_view.x() / in_view.z() + camera.cx();
  const double y = camera.fy() * in_view.y() / in_view.z() + camera.cy();
  return x >= 0 && y >= 0 && x <= camera.width && y <= camera.height;
}

/// Points that photos saw are now seen by views. `photos`: names of the photos by their former index.
void RenumberViews(const std::vector<std::string>& photos, Scene* scene) {
  std::map<std::string, std::vector<int>> views_of;
  for (const int v : AllViews(*scene)) {
    const SceneView& view = scene->views[static_cast<size_t>(v)];
    views_of[view.sphere ? view.sphere->name : view.name].push_back(v);
  }
  for (ScenePoint& point : scene->points) {
    std::vector<int> views;
    for (const int photo : point.views) {
      for (const int v : views_of[photos[static_cast<size_t>(photo)]]) {
        const SceneView& view = scene->views[static_cast<size_t>(v)];
        if (!view.sphere || SeesPoint(view, point.xyz)) views.push_back(v);
      }
    }
    std::sort(views.begin(), views.end());
    point.views = std::move(views);
  }
  std::erase_if(scene->points, [](const ScenePoint& point) { return point.views.empty(); });
}

void NoteCut(const Scene& scene, size_t spheres, size_t fisheyes, const Listener& listener) {
  if (spheres > 0) {
    listener(Note{fmt::format("{}: {} cut into {} views each, {} x {} degrees", scene.root.string(),
                              spheres == 1 ? "1 spherical photo is" : fmt::format("{} spherical photos are", spheres),
                              kSphereFaces, kFaceDegrees, kFaceDegrees)});
  }
  if (fisheyes == 0) return;
  size_t views = 0;
  double reach = 0;
  for (const SceneView& view : scene.views) {
    if (!view.sphere || !view.sphere->lens) continue;
    ++views;
    reach = std::max(reach, view.sphere->lens->reach);
  }
  listener(Note{fmt::format("{}: {} cut into {} views, of up to {} x {} degrees: they show {:.0f} degrees",
                            scene.root.string(),
                            fisheyes == 1 ? "1 fisheye photo is" : fmt::format("{} fisheye photos are", fisheyes),
                            views, kFaceDegrees, kFaceDegrees, 360 / std::numbers::pi * reach)});
}

}  // namespace

void MarkSpheres(SphereChoice choice, Scene* scene) {
  for (SceneView& view : scene->views) view.is_sphere = IsSphere(view, choice);
}

void RequireNoSpheres(const Scene& scene) {
  const auto wide = std::find_if(scene.views.begin(), scene.views.end(), IsWide);
  if (wide == scene.views.end()) return;
  throw InputError("{}: is a {}, which only `oraclegs reconstruct` takes apart; name its workspace instead",
                   wide->image_path.string(),
                   wide->is_sphere ? "spherical photo (EQUIRECTANGULAR)"
                                   : fmt::format("fisheye photo of more than {} degrees", 2 * kMaxFlatDegrees));
}

void TakeFaces(const fs::path& dir, const Listener& listener, Scene* scene) {
  CamerasOfFaces cameras(scene->views);
  const std::vector<std::string> photos = NamesAt(*scene, AllViews(*scene));
  std::set<std::string> taken;
  std::vector<const SceneView*> wide;
  size_t spheres = 0;
  for (const SceneView& view : scene->views) {
    if (!IsWide(view)) {
      taken.insert(view.name);
    } else {
      wide.push_back(&view);
      spheres += view.is_sphere;
    }
  }
  if (wide.empty()) return;
  const size_t count = taken.size() + spheres * kSphereFaces;
  if (!scene->HasPoses() && count > static_cast<size_t>(kMaxPhotos)) {
    throw InputError(
        "{}: its {} are cut into {} views each, and at most {} views without poses can be put together; copy some to "
        "a folder of their own",
        scene->root.string(), Counted(spheres, "spherical photo"), kSphereFaces, kMaxPhotos);
  }
  std::vector<SceneView> views;
  for (const SceneView* view : wide) {
    std::vector<SceneView> faces = FacesOf(*view, cameras.Of(*view), dir, &taken);
    std::move(faces.begin(), faces.end(), std::back_inserter(views));
  }
  const size_t fisheyes = wide.size() - spheres;
  for (SceneView& view : scene->views) {
    if (!IsWide(view)) views.push_back(std::move(view));
  }
  std::sort(views.begin(), views.end(),
            [](const SceneView& a, const SceneView& b) { return NaturalLess(a.name, b.name); });
  scene->views = std::move(views);
  RenumberViews(photos, scene);
  NoteCut(*scene, spheres, fisheyes, listener);
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
