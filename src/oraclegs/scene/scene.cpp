#include "oraclegs/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <set>
#include <string>
#include <system_error>
#include <unordered_map>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/fold_name.h"

namespace oraclegs {
namespace {

constexpr std::string_view kImagePrefix = "images/";

std::filesystem::path FindMask(const std::filesystem::path& mask_dir, const std::string& name) {
  std::vector<std::string> names{name};
  if (name.starts_with(kImagePrefix)) names.push_back(name.substr(kImagePrefix.size()));
  for (const std::string& n : names) {
    const std::filesystem::path as_is = mask_dir / n;
    std::filesystem::path appended = as_is, replaced = as_is;
    appended += ".png";
    replaced.replace_extension(".png");
    for (const auto& path : {as_is, appended, replaced}) {
      if (IsFile(path)) return path;
    }
  }
  return {};
}

/// The masks below a folder by their folded names without extension; an empty path where two have one name.
using MasksByName = std::unordered_map<std::string, std::filesystem::path>;

MasksByName FoldedMasks(const std::filesystem::path& mask_dir) {
  MasksByName masks;
  std::error_code error;
  std::filesystem::recursive_directory_iterator it(mask_dir, error);
  for (; !error && it != std::filesystem::recursive_directory_iterator(); it.increment(error)) {
    std::filesystem::path name = it->path().lexically_relative(mask_dir);
    if (!HasImageExtension(name) || !IsFile(it->path())) continue;
    const auto [mask, is_new] = masks.emplace(FoldName(name.replace_extension().generic_string()), it->path());
    if (!is_new) mask->second.clear();
  }
  return masks;
}

std::filesystem::path FindFoldedMask(const MasksByName& masks, std::string name) {
  if (name.starts_with(kImagePrefix)) name.erase(0, kImagePrefix.size());
  const std::string without_extension = std::filesystem::path(name).replace_extension().generic_string();
  for (const std::string& n : {name, without_extension}) {
    const auto mask = masks.find(FoldName(n));
    if (mask != masks.end()) return mask->second;
  }
  return {};
}

}  // namespace

const char* SceneFormatName(SceneFormat format) {
  switch (format) {
    case SceneFormat::kColmap:
      return "COLMAP model";
    case SceneFormat::kTransforms:
      return "transforms.json";
    case SceneFormat::kBlender:
      return "Blender (NeRF synthetic)";
    case SceneFormat::kLlff:
      return "LLFF (poses_bounds.npy)";
    case SceneFormat::kNeus:
      return "NeuS (cameras.npz)";
    case SceneFormat::kBundler:
      return "Bundler (bundle.out)";
    case SceneFormat::kMetashape:
      return "Metashape's cameras (XML)";
    case SceneFormat::kRealityScan:
      return "RealityScan's cameras (CSV)";
    case SceneFormat::kPolycam:
      return "Polycam's raw export";
    case SceneFormat::kRecord3d:
      return "a capture of Record3D";
    case SceneFormat::kPhotos:
      break;
  }
  return "photos without poses";
}

std::vector<int> AllViews(const Scene& scene) {
  std::vector<int> all(scene.views.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<std::string> NamesAt(const Scene& scene, const std::vector<int>& views) {
  std::vector<std::string> names;
  for (const int i : views) names.push_back(scene.views[static_cast<size_t>(i)].name);
  return names;
}

bool IsFile(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

std::string ViewName(const std::string& written_path) {
  std::string name;
  for (const auto& part : std::filesystem::path(written_path).relative_path()) {
    if (part.empty() || part == "." || part == "..") continue;
    if (!name.empty()) name += '/';
    name += part.string();
  }
  return name;
}

std::string FileName(const std::string& view) {
  std::filesystem::path name = ViewName(view);
  if (HasImageExtension(name)) name.replace_extension();
  std::string flat = name.generic_string();
  std::replace(flat.begin(), flat.end(), '/', '_');
  return flat.empty() ? "view" : flat;
}

std::vector<std::string> FileNames(const std::vector<std::string>& views) {
  std::set<std::string> wanted, taken;
  for (const std::string& view : views) wanted.insert(FileName(view));
  std::vector<std::string> names;
  for (const std::string& view : views) {
    const std::string plain = FileName(view);
    std::string name = plain;
    // A numbered name must not be the plain name of another view.
    for (int k = 2; taken.count(name) > 0 || (name != plain && wanted.count(name) > 0); ++k) {
      name = fmt::format("{}_{}", plain, k);
    }
    taken.insert(name);
    names.push_back(name);
  }
  return names;
}

void RequireUtf8Names(const Scene& scene) {
  const auto require = [](const std::string& name, const std::filesystem::path& shown) {
    if (IsUtf8(name)) return;
    throw InputError("{}: the photo's name is not valid UTF-8; rename it, also where the scene's files name it",
                     EscapeBytes(shown.string()));
  };
  for (const SceneView& view : scene.views) require(view.name, view.image_path);
  for (const std::string& name : scene.missing_images) require(name, scene.root / name);
}

void KeepViewsWithImages(std::vector<SceneView> candidates, const std::string& source, const std::string& searched,
                         const Listener& listener, Scene* scene) {
  std::sort(candidates.begin(), candidates.end(),
            [](const SceneView& a, const SceneView& b) { return NaturalLess(a.name, b.name); });
  const auto twin = std::adjacent_find(candidates.begin(), candidates.end(),
                                       [](const SceneView& a, const SceneView& b) { return a.name == b.name; });
  if (twin != candidates.end()) {
    throw InputError("{}: lists the view '{}' twice; every photo may have one pose only; remove one", source,
                     twin->name);
  }
  const size_t total = candidates.size();
  for (SceneView& view : candidates) {
    if (view.image_path.empty()) {
      scene->missing_images.push_back(view.name);
    } else {
      scene->views.push_back(std::move(view));
    }
  }
  if (scene->missing_images.empty() && total > 0) return;
  if (scene->views.empty()) {
    throw InputError(
        "{}: none of its {} views has an image file in {}{}{}; name the folder of the photos, which must "
        "keep their names, with --images",
        source, total, searched, total > 0 ? ", e.g. " : "", total > 0 ? scene->missing_images.front() : "");
  }
  listener(Warning{fmt::format("{}: {} of {} views have no image file in {} and are left out: {}", source,
                               scene->missing_images.size(), total, searched, SomeNames(scene->missing_images))});
}

void AttachMasks(const std::filesystem::path& mask_dir, const Listener& listener, Scene* scene) {
  std::error_code error;
  if (!std::filesystem::is_directory(mask_dir, error)) return;
  std::optional<MasksByName> folded;
  bool any = false;
  for (SceneView& view : scene->views) {
    if (view.mask_path.empty()) view.mask_path = FindMask(mask_dir, view.name);
    if (view.mask_path.empty()) {
      if (!folded) folded = FoldedMasks(mask_dir);
      view.mask_path = FindFoldedMask(*folded, view.name);
    }
    any |= !view.mask_path.empty();
  }
  if (!any) {
    listener(
        Warning{fmt::format("{}: fits no view, so all pixels are used; a mask is named like its photo, e.g. {}.png",
                            mask_dir.string(), scene->views.empty() ? "NAME" : scene->views.front().name)});
  }
}

void WritePointPly(const std::filesystem::path& path, const std::vector<ScenePoint>& points) {
  std::string ply = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      points.size());
  for (const ScenePoint& p : points) {
    fmt::format_to(std::back_inserter(ply), "{:.9g} {:.9g} {:.9g} {} {} {}\n", p.xyz.x(), p.xyz.y(), p.xyz.z(),
                   p.rgb[0], p.rgb[1], p.rgb[2]);
  }
  WriteFileAtomically(path, ply);
}

}  // namespace oraclegs
