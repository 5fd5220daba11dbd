#include "oraclegs/output/cameras.h"

#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/scene/colmap_files.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kJpegQuality = 95;

/// A folder under a temporary name, which gets its own name when it is complete.
class FolderInTheMaking {
 public:
  explicit FolderInTheMaking(fs::path final_path) : final_(std::move(final_path)) {
    std::error_code error;
    if (fs::exists(final_, error) && !(fs::is_directory(final_, error) && fs::is_empty(final_, error))) {
      throw InputError("{}: is not an empty folder; choose a new one with -o", final_.string());
    }
    const fs::path parent = fs::absolute(final_).parent_path();
    RequireWritableFolder(parent);
    path_ = parent / TemporaryName();
    fs::create_directory(path_, error);
    if (error) throw RunError("{}: cannot be made: {}", path_.string(), SystemReason(error));
  }
  ~FolderInTheMaking() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  FolderInTheMaking(const FolderInTheMaking&) = delete;
  FolderInTheMaking& operator=(const FolderInTheMaking&) = delete;

  const fs::path& path() const { return path_; }
  void Finish() {
    std::error_code error;
    fs::rename(path_, final_, error);
    if (error) throw RunError("{}: cannot be written: {}", final_.string(), SystemReason(error));
    path_.clear();
  }

 private:
  fs::path final_, path_;
};

/// "dir/" without its slash, so that its parent is the right one.
fs::path WithoutSlash(const fs::path& path) { return path.has_filename() ? path : path.parent_path(); }

/// View of the dataset.
struct DatasetView {
  int index = 0;  ///< index in the scene
  bool test = false;
  std::string name;
  Camera camera;
  bool has_mask = false;
};

std::vector<DatasetView> DatasetViews(const CameraDataset& dataset) {
  std::map<int, bool> indices;  // in the scene's order
  for (const int i : dataset.split.train) indices[i] = false;
  for (const int i : dataset.split.test) indices[i] = true;
  std::vector<std::string> names;
  for (const auto& [index, test] : indices) names.push_back(dataset.scene.views[static_cast<size_t>(index)].name);
  names = DatasetNames(names);
  std::vector<DatasetView> views;
  for (const auto& [index, test] : indices) {
    const SceneView& view = dataset.scene.views[static_cast<size_t>(index)];
    Camera camera = WorkingCamera(view, dataset.image);
    camera.cam_from_world = Moved(camera.cam_from_world, WrittenFromRun(dataset.frame));
    views.push_back({index, test, names[views.size()], camera, false});
  }
  return views;
}

void WriteDatasetImages(const CameraDataset& dataset, const fs::path& out, std::vector<DatasetView>* views,
                        const Listener& listener) {
  int64_t done = 0;
  for (DatasetView& view : *views) {
    ThrowIfInterrupted();
    const LoadedView loaded = LoadViews(dataset.scene, {view.index}, dataset.image, Silent()).front();
    WriteFileAtomically(out / "images" / view.name, CompressJpeg(ToImage8(loaded.rgb), kJpegQuality));
    view.has_mask = !loaded.mask.empty();
    if (view.has_mask) {
      Image8 mask{loaded.rgb.width, loaded.rgb.height, 1, loaded.mask};
      for (uint8_t& pixel : mask.data) pixel = pixel ? 255 : 0;
      std::error_code ignored;
      fs::create_directory(out / "masks", ignored);
      WritePng(out / "masks" / (view.name + ".png"), mask);
    }
    listener(StepDone{"cameras", ++done, static_cast<int64_t>(views->size()), "images", view.name});
  }
}

void WriteSparseModel(const CameraDataset& dataset, const fs::path& out, const std::vector<DatasetView>& views) {
  ColmapCameras cameras;
  std::vector<ColmapImage> images;
  std::map<std::vector<double>, uint32_t> ids;  // equal cameras share an id
  std::map<int, const DatasetView*> of_index;
  std::map<int, uint32_t> image_ids;
  for (const DatasetView& view : views) {
    const Camera& c = view.camera;
    const auto id = ids.emplace(std::vector<double>{double(c.width), double(c.height), c.fx, c.fy, c.cx, c.cy},
                                static_cast<uint32_t>(ids.size() + 1));
    if (id.second) {
      Intrinsics& intrinsics = cameras[id.first->second];
      intrinsics.model = CameraModel::kPinhole;
      intrinsics.width = c.width, intrinsics.height = c.height;
      intrinsics.params = {c.fx, c.fy, c.cx, c.cy};
    }
    const auto number = static_cast<uint32_t>(images.size() + 1);
    images.push_back({number, view.name, id.first->second, c.cam_from_world});
    of_index[view.index] = &view;
    image_ids[view.index] = number;
  }
  std::vector<ColmapTrack> tracks;
  for (const ScenePoint& point : dataset.points) {
    ColmapTrack track{point.xyz, point.rgb, {}};
    for (const int v : point.views) {
      const auto found = of_index.find(v);
      if (found == of_index.end()) continue;
      const Camera& c = found->second->camera;
      const Eigen::Vector3d p = c.cam_from_world * point.xyz;
      if (p.z() <= 0) continue;
      const Eigen::Vector2d pixel(c.fx * p.x() / p.z() + c.cx, c.fy * p.y() / p.z() + c.cy);
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > c.width || pixel.y() > c.height) continue;
      track.observations.push_back({image_ids[v], pixel});
    }
    tracks.push_back(std::move(track));
  }
  WriteColmapText(out / "sparse" / "0", cameras, images, tracks);
}

nlohmann::json IntrinsicsJson(const Camera& c) {
  return {{"w", c.width}, {"h", c.height}, {"fl_x", c.fx}, {"fl_y", c.fy}, {"cx", c.cx}, {"cy", c.cy}};
}

/// Camera to world as a matrix, with OpenGL's axes: y up, looking along -z.
nlohmann::json MatrixJson(const Camera& camera) {
  Eigen::Matrix4d m = camera.cam_from_world.inverse(Eigen::Isometry).matrix();
  m.middleCols<2>(1) *= -1;
  nlohmann::json rows = nlohmann::json::array();
  for (int r = 0; r < 4; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
  return rows;
}

nlohmann::json TransformsJson(const CameraDataset& dataset, const std::vector<DatasetView>& views) {
  const Eigen::Vector3d moved = Eigen::Vector3d::Zero() - dataset.frame.offset;  // 0 - 0 is 0, not -0
  nlohmann::json json = {{"camera_model", "PINHOLE"},
                         {"applied_transform", {{1, 0, 0, moved.x()}, {0, 1, 0, moved.y()}, {0, 0, 1, moved.z()}}}};
  const nlohmann::json first = IntrinsicsJson(views.front().camera);
  bool shared = true;
  for (const DatasetView& view : views) shared &= IntrinsicsJson(view.camera) == first;
  if (shared) json.update(first);
  nlohmann::json frames = nlohmann::json::array(), train = frames, test = frames;
  for (const DatasetView& view : views) {
    nlohmann::json frame = {{"file_path", "images/" + view.name}, {"transform_matrix", MatrixJson(view.camera)}};
    if (!shared) frame.update(IntrinsicsJson(view.camera));
    if (view.has_mask) frame["mask_path"] = "masks/" + view.name + ".png";
    (view.test ? test : train).push_back(frame["file_path"]);
    frames.push_back(std::move(frame));
  }
  json["frames"] = std::move(frames);
  if (!test.empty()) {  // Nerfstudio reads all three lists or none
    json["train_filenames"] = train;
    json["val_filenames"] = test;
    json["test_filenames"] = test;
  }
  if (!dataset.points.empty()) json["ply_file_path"] = "sparse_pc.ply";
  return json;
}

nlohmann::json SplitJson(const std::vector<DatasetView>& views) {
  nlohmann::json json = {{"train", nlohmann::json::array()}, {"test", nlohmann::json::array()}};
  for (const DatasetView& view : views) json[view.test ? "test" : "train"].push_back(view.name);
  return json;
}

}  // namespace

std::vector<std::string> DatasetNames(const std::vector<std::string>& names) {
  std::set<fs::path> folders;
  for (const std::string& name : names) folders.insert(fs::path(name).parent_path());
  std::vector<std::string> made;
  std::set<std::string> taken;
  for (const std::string& name : names) {
    const fs::path path(name);
    std::string stem = (folders.size() == 1 ? path.stem() : path.parent_path() / path.stem()).string();
    for (char& c : stem) {
      const auto byte = static_cast<unsigned char>(c);
      const bool plain = byte >= 0x80 || std::isalnum(byte) || c == '.' || c == '-' || c == '_';
      if (!plain) c = '_';
    }
    if (stem.empty() || stem.front() == '.') stem = "_" + stem;
    std::string unique = stem + ".jpg";
    for (int k = 2; !taken.insert(unique).second; ++k) unique = fmt::format("{}_{}.jpg", stem, k);
    made.push_back(std::move(unique));
  }
  return made;
}

CameraDatasetResult WriteCameraDataset(const CameraDataset& in_run, const fs::path& asked, const Listener& listener) {
  CameraDataset dataset = in_run;
  for (ScenePoint& point : dataset.points) point.xyz = WrittenFromRun(in_run.frame) * point.xyz;
  const fs::path out = WithoutSlash(asked);
  RequireOutsideScene(out, dataset.scene, {});
  std::vector<DatasetView> views = DatasetViews(dataset);
  if (views.empty()) throw InputError("{}: has no views to write", dataset.scene.root.string());
  FolderInTheMaking folder(out);
  WriteDatasetImages(dataset, folder.path(), &views, listener);
  WriteSparseModel(dataset, folder.path(), views);
  if (!dataset.points.empty()) WritePointPly(folder.path() / "sparse_pc.ply", dataset.points);
  WriteFileAtomically(folder.path() / "transforms.json", TransformsJson(dataset, views).dump(1) + "\n");
  WriteFileAtomically(folder.path() / "split.json", SplitJson(views).dump(2) + "\n");
  folder.Finish();
  return {static_cast<int>(views.size()), dataset.points.size()};
}

}  // namespace oraclegs
