#include "oraclegs/sfm/colmap_staging.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/file_facts.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/image.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/masks.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr uint8_t kMaskThreshold = 128;
constexpr int kCopyQuality = 97;

/// True when colmap reads no such file or, ignoring the EXIF orientation, would see the image otherwise than its camera
/// does.
bool NeedsCopy(const SceneView& view) {
  const ImageHeader header = ReadImageHeader(view.image_path);
  if (header.extension != ".jpg" && header.extension != ".png") return true;
  if (!header.is_turned) return false;
  if (view.intrinsics.params.empty()) return true;
  return FittingOrientation(view, view.image_path, view.intrinsics.width, view.intrinsics.height) ==
         Orientation::kUpright;
}

/// The name as one path component that colmap's text files can hold.
std::string PlainName(const SceneView& view) {
  std::string name = view.name;
  // The faces of a sphere have one name, by which colmap knows that they belong together.
  if (view.sphere) name = fs::path(view.sphere->name).replace_extension(view.image_path.extension()).string();
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '_') c = '_';
  }
  if (name.empty() || name[0] == '.') name = "_" + name;
  if (!HasImageExtension(name) && HasImageExtension(view.image_path)) name += view.image_path.extension().string();
  return name;
}

bool IsPortrait(const SceneView& view) {
  int width = 0, height = 0;
  ReadImageSize(view.image_path, &width, &height);
  return height > width;
}

/// Views with equal keys were taken by one camera.
struct CameraKey {
  int model = -1;              ///< -1: of unknown intrinsics
  int width = 0, height = 0;   ///< with kTurn, width is the longer side where the intrinsics are unknown
  std::vector<double> params;  ///< the intrinsics or, where unknown, the focal length by EXIF
  std::string name;            ///< maker and model, by EXIF; "" where the intrinsics are known
  int face = -1;               ///< of a sphere: for colmap, a rig has a camera for each
  bool operator==(const CameraKey&) const = default;

  bool IsNameless() const { return model == -1 && name.empty() && params[0] == 0; }
};

CameraKey CameraKeyOf(const SceneView& view, Upright upright) {
  const int face = view.sphere ? view.sphere->face : -1;
  if (!view.intrinsics.params.empty()) {
    return {static_cast<int>(view.intrinsics.model),
            view.intrinsics.width,
            view.intrinsics.height,
            view.intrinsics.params,
            "",
            face};
  }
  int width = 0, height = 0;
  ReadImageSize(view.image_path, &width, &height);
  if (upright == Upright::kTurn && width < height) std::swap(width, height);
  return {-1, width, height, {view.focal_prior}, view.camera, face};
}

/// Photos that lost their EXIF get the key of the only camera of their size.
void NameNameless(std::vector<CameraKey>* keys) {
  const std::vector<CameraKey> given = *keys;
  for (CameraKey& key : *keys) {
    if (!key.IsNameless()) continue;
    const CameraKey* only = nullptr;
    bool ambiguous = false;
    for (const CameraKey& other : given) {
      if (other.IsNameless() || other.model != -1 || other.width != key.width || other.height != key.height) continue;
      ambiguous = ambiguous || (only != nullptr && !(*only == other));
      only = &other;
    }
    if (only != nullptr && !ambiguous) key = *only;
  }
}

/// By camera: whether more of its photos are portrait than landscape.
std::vector<bool> ArePortrait(const Scene& scene, const std::vector<int>& views, const std::vector<int>& cameras) {
  std::vector<int> balance;
  for (size_t i = 0; i < views.size(); ++i) {
    balance.resize(std::max(balance.size(), static_cast<size_t>(cameras[i]) + 1));
    balance[static_cast<size_t>(cameras[i])] += IsPortrait(scene.views.at(static_cast<size_t>(views[i]))) ? 1 : -1;
  }
  std::vector<bool> portrait;
  for (const int more : balance) portrait.push_back(more > 0);
  return portrait;
}

/// 255 where features may be found by the image's transparency; no data when they may be anywhere.
Image8 AlphaMask(const Image8& image) {
  if (image.channels != 4) return {};
  Image8 mask{image.width, image.height, 1, std::vector<uint8_t>(image.data.size() / 4)};
  for (size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = image.data[4 * i + 3] < kMaskThreshold ? 0 : 255;
  return mask;
}

/// The image turned by 90 degrees, clockwise.
Image8 Turned(const Image8& image) {
  Image8 turned{image.height, image.width, image.channels, std::vector<uint8_t>(image.data.size())};
  const auto channels = static_cast<size_t>(image.channels);
  for (size_t y = 0; y < static_cast<size_t>(image.height); ++y) {
    for (size_t x = 0; x < static_cast<size_t>(image.width); ++x) {
      const size_t to = x * static_cast<size_t>(image.height) + static_cast<size_t>(image.height) - 1 - y;
      std::copy_n(&image.data[(y * static_cast<size_t>(image.width) + x) * channels], channels,
                  &turned.data[to * channels]);
    }
  }
  return turned;
}

/// As the view's camera sees it, or turned, without transparency, whose mask it returns (not turned).
Image8 WriteCopy(const SceneView& view, const StagedView& staged, const fs::path& target) {
  Image8 image = ReadImage(view.image_path);
  Image8 mask = AlphaMask(image);
  if (image.channels == 4) {
    Image8 opaque{image.width, image.height, 3, std::vector<uint8_t>(image.data.size() / 4 * 3)};
    for (size_t i = 0; i < image.data.size() / 4; ++i) std::copy_n(&image.data[4 * i], 3, &opaque.data[3 * i]);
    image = std::move(opaque);
  }
  WriteFileAtomically(target, CompressJpeg(staged.is_turned ? Turned(image) : image, kCopyQuality));
  return mask;
}

/// Returns the mask of the photo's transparency.
Image8 PlaceImage(const SceneView& view, const StagedView& staged, const fs::path& target) {
  if (staged.is_copy) return WriteCopy(view, staged, target);
  std::error_code error;
  fs::create_symlink(fs::absolute(view.image_path), target, error);
  if (error) fs::copy_file(view.image_path, target, error);
  if (error) throw RunError("{}: cannot be written: {}", target.string(), SystemReason(error));
  return ReadImageHeader(view.image_path).may_be_transparent ? AlphaMask(ReadImage(view.image_path)) : Image8();
}

/// Each pixel of the mask that is nearest to one of an image of this size.
Image8 Scaled(const Image8& mask, int width, int height) {
  if (mask.width == width && mask.height == height) return mask;
  Image8 scaled{width, height, 1, std::vector<uint8_t>(static_cast<size_t>(width) * static_cast<size_t>(height))};
  for (int64_t y = 0; y < height; ++y) {
    for (int64_t x = 0; x < width; ++x) {
      const int64_t from =
          (2 * y + 1) * mask.height / (2 * height) * mask.width + (2 * x + 1) * mask.width / (2 * width);
      scaled.data[static_cast<size_t>(y * width + x)] = mask.data[static_cast<size_t>(from)];
    }
  }
  return scaled;
}

/// The mask of the photo's transparency, joined by the view's own, in the size of the photo that colmap sees: colmap
/// refuses any other.
Image8 FeatureMask(const SceneView& view, const StagedView& staged, Image8 mask) {
  if (view.mask_path.empty()) return mask;
  const Orientation seen = staged.is_copy ? Orientation::kUpright : Orientation::kAsStored;
  int width = 0, height = 0;
  ReadImageSize(view.image_path, &width, &height, seen);
  Image8 drawn = Scaled(ReadMask(view, width, height, seen), width, height);
  if (mask.data.empty()) return drawn;
  for (size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = std::min(mask.data[i], drawn.data[i]);
  return mask;
}

/// By content: a copied, moved or merely touched file is still the same image.
nlohmann::json DescribeFile(const fs::path& path) {
  if (path.empty()) return nullptr;
  const FileDigest digest = DigestOf(path);
  return {{"bytes", digest.bytes}, {"crc32", digest.crc32}};
}

}  // namespace

std::vector<StagedView> PlanStaging(const Scene& scene, const std::vector<int>& views, Upright upright) {
  std::vector<CameraKey> keys, cameras;
  for (const int v : views) keys.push_back(CameraKeyOf(scene.views.at(static_cast<size_t>(v)), upright));
  NameNameless(&keys);
  std::vector<int> camera_of;
  for (const CameraKey& key : keys) {
    const auto camera = static_cast<int>(std::find(cameras.begin(), cameras.end(), key) - cameras.begin());
    if (camera == static_cast<int>(cameras.size())) cameras.push_back(key);
    camera_of.push_back(camera);
  }
  const std::vector<bool> portrait =
      upright == Upright::kTurn ? ArePortrait(scene, views, camera_of) : std::vector<bool>();
  std::vector<StagedView> plan;
  std::set<std::string> taken;
  std::map<std::string, int> first_face;  // by sphere
  for (size_t i = 0; i < views.size(); ++i) {
    const SceneView& view = scene.views.at(static_cast<size_t>(views[i]));
    const int camera = camera_of[i];
    StagedView staged{fmt::format("camera{}/{}", camera, PlainName(view)), camera, NeedsCopy(view)};
    if (upright == Upright::kTurn && view.intrinsics.params.empty() && keys[i].width != keys[i].height) {
      staged.is_turned = IsPortrait(view) != portrait[static_cast<size_t>(camera)];
      staged.is_copy = staged.is_copy || staged.is_turned;
    }
    if (staged.is_copy) {
      staged.name += ".jpg";
    } else if (!HasImageExtension(staged.name)) {
      staged.name += ReadImageHeader(view.image_path).extension;
    }
    if (!taken.insert(staged.name).second) {  // names that differ only in what PlainName replaced
      const int number = view.sphere ? first_face.emplace(view.sphere->name, views[i]).first->second : views[i];
      staged.name = fmt::format("camera{}/{}-{}", camera, number, staged.name.substr(staged.name.find('/') + 1));
      taken.insert(staged.name);
    }
    plan.push_back(std::move(staged));
  }
  return plan;
}

bool StageImages(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                 const fs::path& work_dir) {
  std::error_code error;
  fs::remove_all(work_dir / "images", error);
  fs::remove_all(work_dir / "masks", error);
  for (const StagedView& staged : plan) {
    fs::create_directories((work_dir / "images" / staged.name).parent_path(), error);
    if (error) throw RunError("{}: cannot be made: {}", (work_dir / "images").string(), SystemReason(error));
  }
  std::vector<uint8_t> masked(views.size(), 0);
  ParallelFor(static_cast<int64_t>(views.size()), [&](int64_t i) {
    const SceneView& view = scene.views.at(views[i]);
    const Image8 mask = FeatureMask(view, plan[i], PlaceImage(view, plan[i], work_dir / "images" / plan[i].name));
    if (mask.data.empty()) return;
    WritePng(work_dir / "masks" / (plan[i].name + ".png"), plan[i].is_turned ? Turned(mask) : mask);
    masked[i] = 1;
  });
  return std::count(masked.begin(), masked.end(), 1) > 0;
}

nlohmann::json DescribeInputs(const Scene& scene, const std::vector<int>& views) {
  std::vector<std::array<nlohmann::json, 2>> files(views.size());
  ParallelFor(static_cast<int64_t>(views.size()), [&](int64_t i) {
    const SceneView& view = scene.views.at(views[i]);
    files[i] = {DescribeFile(view.image_path), DescribeFile(view.mask_path)};
  });
  nlohmann::json images = nlohmann::json::array();
  for (size_t i = 0; i < views.size(); ++i) {
    const SceneView& view = scene.views.at(views[i]);
    nlohmann::json entry = {
        {"name", view.name}, {"file", files[i][0]}, {"mask", files[i][1]}, {"as_stored", view.as_stored}};
    if (!view.intrinsics.params.empty()) {
      entry["intrinsics"] = {{"model", CameraModelName(view.intrinsics.model)},
                             {"width", view.intrinsics.width},
                             {"height", view.intrinsics.height},
                             {"params", view.intrinsics.params}};
    }
    if (view.focal_prior > 0) entry["focal_prior"] = view.focal_prior;
    if (view.cam_from_world) {
      const Eigen::Matrix<double, 3, 4> pose = view.cam_from_world->matrix().topRows<3>();
      for (int row = 0; row < 3; ++row) {
        entry["cam_from_world"].push_back({pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3)});
      }
    }
    images.push_back(std::move(entry));
  }
  return {{"format", 4}, {"images", std::move(images)}};
}

}  // namespace oraclegs
