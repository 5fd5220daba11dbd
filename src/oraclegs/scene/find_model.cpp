#include "oraclegs/scene/find_model.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/fit_cameras.h"
#include "oraclegs/scene/photo_folder.h"
#include "oraclegs/scene/photo_kind.h"
#include "oraclegs/scene/read_colmap.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxModelDepth = 4;  // folders between the scene's and the model's
constexpr size_t kMaxFoldersSearched = 10000;

/// The folders in a folder, sorted; empty when it is not a folder.
std::vector<fs::path> FoldersIn(const fs::path& dir) {
  if (!IsFolder(dir)) return {};
  std::vector<fs::path> folders;
  std::error_code error;
  fs::directory_iterator it(dir, error);
  for (; !error && it != fs::directory_iterator(); it.increment(error)) {
    std::error_code ignored;
    if (it->is_directory(ignored)) folders.push_back(it->path());
  }
  if (error) throw InputError("{}: cannot be listed ({}); check its permissions", dir.string(), error.message());
  std::sort(folders.begin(), folders.end());
  return folders;
}

bool IsNumber(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c); });
}

/// The model with the most images in a folder of numbered ones, or the folder itself; empty when there is none.
fs::path ModelIn(const fs::path& sparse, const Listener& listener) {
  std::vector<fs::path> models;
  for (const fs::path& dir : FoldersIn(sparse)) {
    if (IsNumber(dir.filename().string()) && IsColmapModel(dir)) models.push_back(dir);
  }
  if (models.empty()) return IsColmapModel(sparse) ? sparse : fs::path();
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

/// images/ when there is one, unless the model's names fit the scene folder itself.
fs::path UsualImageFolder(const fs::path& root, const fs::path& model) {
  const fs::path usual = root / "images";
  if (!IsFolder(usual)) return root;
  const std::vector<ColmapImage> images = ReadColmapImages(model);
  const auto any_in = [&](const fs::path& dir) {
    return std::any_of(images.begin(), images.end(), [&](const ColmapImage& i) { return IsFile(dir / i.name); });
  };
  return !any_in(usual) && any_in(root) ? root : usual;
}

/// Files with poses below a scene's folder, apart from those that FindModel looks at.
struct PosesBelow {
  std::set<fs::path> models;  ///< folders with a model, or with numbered ones
  std::vector<fs::path> transforms;
};

void Search(const fs::path& dir, int depth, size_t* searched, PosesBelow* found) {
  if (++*searched > kMaxFoldersSearched) return;
  if (depth > 0 && IsColmapModel(dir)) {
    found->models.insert(IsNumber(dir.filename().string()) ? dir.parent_path() : dir);
  }
  for (const char* file : {"transforms.json", "transforms_train.json"}) {
    if (depth > 0 && IsFile(dir / file)) found->transforms.push_back(dir / file);
  }
  if (depth == kMaxModelDepth) return;
  std::vector<fs::path> folders;
  try {
    folders = FoldersIn(dir);
  } catch (const InputError&) {  // somebody else's
    return;
  }
  for (const fs::path& folder : folders) {
    const std::string name = folder.filename().string();
    const bool is_result = IsFile(folder / "stages.json");
    if (!name.starts_with(".") && !IsHelperFolder(name) && !is_result) Search(folder, depth + 1, searched, found);
  }
}

/// True when the image can have been taken by the camera, perhaps before it was scaled.
bool CanBeOf(const fs::path& image, const Intrinsics& camera) {
  for (const Orientation way : {Orientation::kUpright, Orientation::kAsStored}) {
    try {
      int width = 0, height = 0;
      ReadImageSize(image, &width, &height, way);
      if (HaveSameAspect(width, height, camera.width, camera.height)) return true;
    } catch (const InputError&) {
      return false;
    }
  }
  return false;
}

/// The images of a model that are in `dir`, none when the first one there is of another shape than its camera.
size_t CountImages(const std::vector<ColmapImage>& images, const ColmapCameras& cameras, const fs::path& dir) {
  size_t count = 0;
  for (const ColmapImage& image : images) {
    const fs::path path = dir / image.name;
    if (!IsFile(path)) continue;
    const auto camera = cameras.find(image.camera_id);
    if (count == 0 && (camera == cameras.end() || !CanBeOf(path, camera->second))) return 0;
    ++count;
  }
  return count;
}

struct FittingModel {
  ModelPlace place;
  size_t images = 0;  ///< images of the model that are there
  size_t photos = 0;  ///< photos that are there
};

/// The photos that the scene has when no model is used.
size_t CountLoosePhotos(const fs::path& root, const SceneReadOptions& options) {
  try {
    if (!options.images.empty()) return FindPhotos(root / options.images, Silent()).size();
    const size_t usual = FindPhotos(root / "images", Silent()).size();
    return usual > 0 ? usual : FindPhotos(root, Silent()).size();
  } catch (const InputError&) {  // thrown again where they are needed
    return 0;
  }
}

/// The image folder nearest to a model that has the most of its images; nothing when these are less than half of its
/// images, of the photos there or of the `loose` ones, which the model would replace.
std::optional<FittingModel> FitModel(const fs::path& model, const fs::path& root, const SceneReadOptions& options,
                                     size_t loose) {
  const std::vector<ColmapImage> images = ReadColmapImages(model);
  const ColmapCameras cameras = ReadColmapCameras(model);
  std::vector<fs::path> folders;
  if (!options.images.empty()) {
    folders.push_back(root / options.images);
  } else {
    for (fs::path dir = model;; dir = dir.parent_path()) {
      for (const char* usual : {"images", "input"}) folders.push_back(dir / usual);
      folders.push_back(dir);
      if (dir == root || !dir.has_relative_path()) break;
    }
  }
  FittingModel fitting{{model, {}}};
  for (const fs::path& folder : folders) {
    const size_t count = IsFolder(folder) ? CountImages(images, cameras, folder) : 0;
    if (count <= fitting.images) continue;
    fitting.images = count;
    fitting.place.images = folder;
  }
  if (fitting.images == 0 || 2 * fitting.images < images.size()) return std::nullopt;
  fitting.photos = FindPhotos(fitting.place.images, Silent()).size();
  if (2 * fitting.images < std::max(fitting.photos, loose)) return std::nullopt;
  return fitting;
}

/// A damaged model in some folder is no reason to refuse the photos.
std::optional<FittingModel> FitModelIn(const fs::path& folder, const fs::path& root, const SceneReadOptions& options,
                                       size_t loose) {
  try {
    return FitModel(ModelIn(folder, Silent()), root, options, loose);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::vector<std::string> RelativeNames(const fs::path& root, const std::vector<fs::path>& paths) {
  std::vector<std::string> names;
  for (const fs::path& path : paths) names.push_back(OneLine(path.lexically_relative(root).generic_string()));
  return names;
}

}  // namespace

std::optional<ModelPlace> FindModel(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  fs::path model = ModelIn(root / "sparse", listener);
  if (model.empty() && IsColmapModel(root)) model = root;
  if (model.empty()) return std::nullopt;
  return ModelPlace{model, options.images.empty() ? UsualImageFolder(root, model) : root / options.images};
}

std::optional<ModelPlace> FindModelBeside(const fs::path& root, const SceneReadOptions& options,
                                          const Listener& listener) {
  PosesBelow below;
  size_t searched = 0;
  Search(root, 0, &searched, &below);
  const size_t loose = below.models.empty() ? 0 : CountLoosePhotos(root, options);
  std::vector<FittingModel> fitting;
  std::vector<fs::path> others;
  for (const fs::path& folder : below.models) {
    const auto fits = FitModelIn(folder, root, options, loose);
    if (fits) fitting.push_back(*fits);
    if (!fits) others.push_back(folder);
  }
  if (fitting.size() == 1) {
    const auto& [place, images, photos] = fitting.front();
    listener(Note{fmt::format("{}: this COLMAP model has {} of the {} in {}; its poses are used", place.model.string(),
                              images, Counted(photos, "photo"), place.images.string())});
    return place;
  }
  if (fitting.size() > 1) {
    std::vector<fs::path> models;
    for (const FittingModel& fits : fitting) models.push_back(fits.place.model);
    listener(Warning{fmt::format(
        "{}: has several COLMAP models with photos ({}), so none is used, and poses are found anew; to use one, name "
        "the folder that holds its sparse/, and its photos with --images",
        root.string(), SomeNames(RelativeNames(root, models)))});
  } else if (!others.empty()) {
    listener(Warning{fmt::format("{}: the COLMAP model in {} does not fit the photos here and is not used",
                                 root.string(), SomeNames(RelativeNames(root, others)))});
  }
  if (!below.transforms.empty()) {
    listener(Warning{fmt::format("{}: {} may have poses, which are not used; name its folder to use them",
                                 root.string(), SomeNames(RelativeNames(root, below.transforms)))});
  }
  return std::nullopt;
}

}  // namespace oraclegs
