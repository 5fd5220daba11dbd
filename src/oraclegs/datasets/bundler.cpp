#include "oraclegs/datasets/bundler.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/datasets/dataset_images.h"
#include "oraclegs/datasets/pose_files.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/rotation.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBundleVersion = "# Bundle file v0.3";

struct BundlerFiles {
  fs::path bundle, list;
};

std::optional<BundlerFiles> FindBundle(const fs::path& root) {
  std::vector<fs::path> bundles{root / "bundle.out", root / "bundle" / "bundle.out"};
  const std::vector<fs::path> others = FilesThatEnd(root, ".rd.out");
  bundles.insert(bundles.end(), others.begin(), others.end());
  for (const fs::path& bundle : bundles) {
    for (const fs::path& list : {bundle.parent_path() / "list.txt", root / "list.txt"}) {
      if (IsFile(bundle) && IsFile(list)) return BundlerFiles{bundle, list};
    }
  }
  return std::nullopt;
}

/// The numbers of a text one after the other; says in which line one is missing.
class BundleNumbers {
 public:
  BundleNumbers(std::string_view text, size_t begin, std::string file)
      : text_(text), file_(std::move(file)), at_(begin) {}

  double Next() {
    at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size());
    double value = 0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) {
      const size_t word_end = std::min(text_.find_first_of(" \t\r\n", at_), text_.size());
      const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<ptrdiff_t>(at_), '\n');
      throw InputError("{}: line {}: expected a number, found '{}'; is the file cut short?", file_, line,
                       Printable(text_.substr(at_, word_end - at_)));
    }
    at_ = static_cast<size_t>(end - text_.data());
    return value;
  }

  /// A whole number of at least 0. No file has more things than bytes.
  size_t NextCount(const char* what) {
    const double value = Next();
    if (value >= 0 && value <= static_cast<double>(text_.size()) && value == std::floor(value)) {
      return static_cast<size_t>(value);
    }
    throw InputError("{}: says it has {} {}, which do not fit into its {} bytes", file_, value, what, text_.size());
  }

  Eigen::Vector3d NextVector() {
    const double x = Next(), y = Next();
    return {x, y, Next()};
  }

 private:
  std::string_view text_;
  std::string file_;
  size_t at_;
};

struct BundleCamera {
  double focal = 0, k1 = 0, k2 = 0;
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

struct Bundle {
  std::vector<BundleCamera> cameras;
  std::vector<ScenePoint> points;  ///< views are cameras
};

std::vector<BundleCamera> ReadCameras(size_t count, BundleNumbers* numbers) {
  std::vector<BundleCamera> cameras;
  for (size_t i = 0; i < count; ++i) {
    BundleCamera camera;
    camera.focal = numbers->Next();
    camera.k1 = numbers->Next();
    camera.k2 = numbers->Next();
    for (int row = 0; row < 3; ++row) camera.rotation.row(row) = numbers->NextVector().transpose();
    camera.translation = numbers->NextVector();
    cameras.push_back(camera);
  }
  return cameras;
}

Bundle ParseBundle(std::string_view text, const std::string& file) {
  if (!text.starts_with(kBundleVersion)) {
    throw InputError("{}: begins with '{}', and '{}' is read", file, Printable(text.substr(0, text.find('\n')), 30),
                     kBundleVersion);
  }
  BundleNumbers numbers(text, kBundleVersion.size(), file);
  const size_t count = numbers.NextCount("cameras"), num_points = numbers.NextCount("points");
  Bundle bundle{ReadCameras(count, &numbers), {}};
  for (size_t i = 0; i < num_points; ++i) {
    ScenePoint point;
    point.xyz = numbers.NextVector();
    const Eigen::Vector3d rgb = numbers.NextVector();
    for (int c = 0; c < 3; ++c)
      point.rgb[static_cast<size_t>(c)] = static_cast<uint8_t>(std::clamp(rgb(c), 0.0, 255.0));
    for (size_t seen = numbers.NextCount("sightings of a point"); seen > 0; --seen) {
      const size_t camera = numbers.NextCount("cameras");
      if (camera >= count) {
        throw InputError("{}: point {} is seen by camera {}, and there are {}", file, i, camera, count);
      }
      point.views.push_back(static_cast<int>(camera));
      for (int skipped = 0; skipped < 3; ++skipped) numbers.Next();  // key and pixel
    }
    bundle.points.push_back(std::move(point));
  }
  return bundle;
}

/// The photos of list.txt: the first word of each line.
std::vector<std::string> ReadList(const fs::path& path) {
  std::vector<std::string> names;
  for (const std::string& line : SplitTrimmed(ReadFile(path), '\n')) {
    const std::vector<std::string> words = SplitTrimmed(line, ' ');
    if (!words.empty()) names.push_back(words.front());
  }
  return names;
}

void FillBundleCamera(const BundleCamera& camera, const std::string& place, SceneView* view) {
  Intrinsics& intrinsics = view->intrinsics;
  ReadImageSize(view->image_path, &intrinsics.width, &intrinsics.height, Orientation::kAsStored);
  view->as_stored = true;
  intrinsics.model = camera.k1 == 0 && camera.k2 == 0 ? CameraModel::kPinhole : CameraModel::kRadial;
  intrinsics.params = {camera.focal, intrinsics.width / 2.0, intrinsics.height / 2.0};
  if (intrinsics.model == CameraModel::kPinhole) {
    intrinsics.params.insert(intrinsics.params.begin(), camera.focal);
  } else {
    intrinsics.params.insert(intrinsics.params.end(), {camera.k1, camera.k2});
  }
  intrinsics.Check(place);
  const Eigen::DiagonalMatrix<double, 3> flip(1, -1, -1);
  view->cam_from_world = Eigen::Isometry3d::Identity();
  view->cam_from_world->linear() = flip * NearestRotation(camera.rotation, place + ": its matrix").rotation;
  view->cam_from_world->translation() = flip * camera.translation;
}

/// Points whose views are cameras, with indices of the scene's views; those that no view sees are left out.
std::vector<ScenePoint> PointsOfViews(std::vector<ScenePoint> points, const std::vector<int>& view_of_camera) {
  for (ScenePoint& point : points) {
    for (int& view : point.views) view = view_of_camera[static_cast<size_t>(view)];
    std::sort(point.views.begin(), point.views.end());
    point.views.erase(std::unique(point.views.begin(), point.views.end()), point.views.end());
    if (!point.views.empty() && point.views.front() < 0) point.views.erase(point.views.begin());
  }
  std::erase_if(points, [](const ScenePoint& point) { return point.views.empty(); });
  return points;
}

}  // namespace

bool IsBundlerScene(const fs::path& root) { return FindBundle(root).has_value(); }

Scene ReadBundlerScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const auto [path, list] = FindBundle(root).value();
  const std::string file = path.string();
  Bundle bundle = ParseBundle(ReadFile(path), file);
  const std::vector<std::string> names = ReadList(list);
  if (names.size() != bundle.cameras.size()) {
    throw InputError("{}: has {}, and {} names {}; use the list that Bundler was given", file,
                     Counted(bundle.cameras.size(), "camera"), list.string(), Counted(names.size(), "photo"));
  }
  const fs::path folder = DatasetImageFolder(root, options);
  std::vector<SceneView> views;
  std::vector<std::string> name_of_camera, unplaced;
  for (SceneView& view : ViewsOfNames(names, list.string(), folder, options, listener)) {
    const size_t i = name_of_camera.size();
    name_of_camera.push_back(view.name);
    if (bundle.cameras[i].focal == 0) {
      unplaced.push_back(view.name);
      continue;
    }
    const std::string place = fmt::format("{}: camera {} ({})", file, i, OneLine(view.name));
    if (!view.image_path.empty()) FillBundleCamera(bundle.cameras[i], place, &view);
    views.push_back(std::move(view));
  }
  ReportUnplaced(file, unplaced, listener);
  Scene scene = SceneOfDataset(path, SceneFormat::kBundler, std::move(views), folder, listener);
  std::unordered_map<std::string, int> view_of_name;
  for (size_t v = 0; v < scene.views.size(); ++v) view_of_name[scene.views[v].name] = static_cast<int>(v);
  std::vector<int> view_of_camera;
  for (const std::string& name : name_of_camera) {
    const auto found = view_of_name.find(name);
    view_of_camera.push_back(found == view_of_name.end() ? -1 : found->second);
  }
  scene.points = PointsOfViews(std::move(bundle.points), view_of_camera);
  return scene;
}

}  // namespace oraclegs
