#include "oraclegs/datasets/metashape.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <pugixml.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/datasets/dataset_images.h"
#include "oraclegs/datasets/pose_files.h"
#include "oraclegs/scene/brown_lens.h"
#include "oraclegs/scene/rotation.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxShearPixels = 1;  // at the image's edge

bool IsMetashapeFile(const fs::path& path) {
  const std::string head = HeadOfPoseFile(path);
  return head.find("<document") != std::string::npos && head.find("<chunk") != std::string::npos;
}

fs::path MetashapeFile(const fs::path& root) {
  std::vector<fs::path> files = FilesThatEnd(root, ".xml");
  std::stable_partition(files.begin(), files.end(),
                        [](const fs::path& path) { return path.filename() == "cameras.xml"; });
  const auto found = std::find_if(files.begin(), files.end(), IsMetashapeFile);
  return found == files.end() ? fs::path() : *found;
}

/// Numbers of a node's text. Throws InputError unless there are `count` finite ones.
std::vector<double> NumbersOf(const pugi::xml_node& node, size_t count, const std::string& place) {
  const std::string_view text = node.text().get();
  std::vector<double> numbers;
  for (size_t at = 0; (at = text.find_first_not_of(" \t\r\n", at)) != std::string_view::npos;) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
    if (error != std::errc() || !std::isfinite(value)) break;
    numbers.push_back(value);
    at = static_cast<size_t>(end - text.data());
  }
  if (numbers.size() == count) return numbers;
  throw InputError("{}: <{}> is '{}', expected {}", place, node.name(), Printable(text, 40),
                   count == 1 ? "a number" : fmt::format("{} numbers", count));
}

double NumberIn(const pugi::xml_node& node, const char* name, const std::string& place) {
  const pugi::xml_node child = node.child(name);
  return child ? NumbersOf(child, 1, place).front() : 0;
}

/// The world from a chunk's or component's coordinates.
struct ChunkPlace {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1;
};

ChunkPlace ReadPlace(const pugi::xml_node& transform, const std::string& place) {
  ChunkPlace read;
  if (const pugi::xml_node node = transform.child("rotation")) {
    const std::vector<double> m = NumbersOf(node, 9, place);
    const Eigen::Matrix3d matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.data());
    read.rotation = NearestRotation(matrix, place + ": <rotation>").rotation;
  }
  if (const pugi::xml_node node = transform.child("translation")) {
    read.translation = Eigen::Vector3d::Map(NumbersOf(node, 3, place).data());
  }
  if (const pugi::xml_node node = transform.child("scale")) read.scale = NumbersOf(node, 1, place).front();
  if (!(read.scale > 0)) throw InputError("{}: <scale> is {}, must be more than 0", place, read.scale);
  return read;
}

/// The adjusted calibration of a sensor, else the one that there is.
pugi::xml_node CalibrationOf(const pugi::xml_node& sensor) {
  const pugi::xml_node adjusted = sensor.find_child_by_attribute("calibration", "class", "adjusted");
  return adjusted ? adjusted : sensor.child("calibration");
}

int SideOf(const pugi::xml_node& resolution, const char* name, const std::string& place) {
  const int side = resolution.attribute(name).as_int();
  if (side > 0 && side <= kMaxImageSide) return side;
  throw InputError("{}: its <resolution> has no {} in pixels", place, name);
}

/// A sensor's camera, and by how many pixels its shear, which no camera model has, would move the edge.
struct Sensor {
  Intrinsics intrinsics;
  double shear = 0;
};

Sensor ReadSensor(const pugi::xml_node& sensor, const std::string& place) {
  const std::string type = sensor.attribute("type").as_string("frame");
  if (type != "frame" && type != "fisheye") {
    throw InputError("{}: is of type '{}'; frame and fisheye cameras are read: cut panoramas into flat views first",
                     place, Printable(type));
  }
  const pugi::xml_node calibration = CalibrationOf(sensor);
  if (!calibration.child("f"))
    throw InputError("{}: has no calibration with <f>; align the photos in Metashape", place);
  const auto number = [&](const char* name) { return NumberIn(calibration, name, place); };
  const pugi::xml_node own_size = calibration.child("resolution");
  const pugi::xml_node size = own_size ? own_size : sensor.child("resolution");
  BrownLens lens;
  lens.width = SideOf(size, "width", place);
  lens.height = SideOf(size, "height", place);
  lens.fy = number("f");
  lens.fx = lens.fy + number("b1");
  lens.cx = lens.width / 2.0 + number("cx");
  lens.cy = lens.height / 2.0 + number("cy");
  lens.k = {number("k1"), number("k2"), number("k3"), number("k4")};
  lens.p1 = number("p2");  // Metashape's p1 goes with x, OpenCV's with y
  lens.p2 = number("p1");
  lens.fisheye = type == "fisheye";
  return {IntrinsicsOf(lens, place), std::abs(number("b2")) * lens.height / 2 / lens.fy};
}

Eigen::Isometry3d ReadMetashapePose(const pugi::xml_node& transform, const ChunkPlace& chunk,
                                    const std::string& place) {
  const std::vector<double> m = NumbersOf(transform, 16, place);
  const Eigen::Matrix4d chunk_from_cam = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
  const Eigen::Matrix3d rotation =
      chunk.rotation * NearestRotation(chunk_from_cam.topLeftCorner<3, 3>(), place + ": <transform>").rotation;
  const Eigen::Vector3d center =
      chunk.scale * (chunk.rotation * chunk_from_cam.topRightCorner<3, 1>()) + chunk.translation;
  Eigen::Isometry3d cam_from_world = Eigen::Isometry3d::Identity();
  cam_from_world.linear() = rotation.transpose();
  cam_from_world.translation() = -(rotation.transpose() * center);
  return cam_from_world;
}

/// One chunk being read.
class MetashapeChunk {
 public:
  MetashapeChunk(pugi::xml_node chunk, std::string file) : chunk_(chunk), file_(std::move(file)) {
    const ChunkPlace whole = ReadPlace(chunk.child("transform"), file_ + ": the chunk");
    places_[""] = whole;
    for (const pugi::xml_node& node : chunk.child("components").children("component")) {
      const pugi::xml_node transform = node.child("transform");
      const std::string id = node.attribute("id").as_string();
      places_[id] = transform ? ReadPlace(transform, fmt::format("{}: component {}", file_, Printable(id))) : whole;
    }
    for (const pugi::xml_node& node : chunk.child("sensors").children("sensor")) {
      sensors_[node.attribute("id").as_string()] = node;
    }
    AddCameras(chunk.child("cameras"));
  }

  const std::vector<pugi::xml_node>& cameras() const { return cameras_; }
  const std::vector<std::string>& unplaced() const { return unplaced_; }
  double shear() const { return shear_; }

  void Fill(const pugi::xml_node& camera, SceneView* view) {
    const std::string place = fmt::format("{}: camera '{}'", file_, Printable(camera.attribute("label").as_string()));
    const std::string id = camera.attribute("sensor_id").as_string();
    const auto node = sensors_.find(id);
    if (node == sensors_.end()) throw InputError("{}: its sensor {} is missing", place, Printable(id));
    auto sensor = read_.find(id);
    if (sensor == read_.end()) {
      const std::string words = fmt::format("{}: sensor {}", file_, Printable(id));
      sensor = read_.emplace(id, ReadSensor(node->second, words)).first;
    }
    shear_ = std::max(shear_, sensor->second.shear);
    view->intrinsics = sensor->second.intrinsics;
    const auto component = places_.find(camera.attribute("component_id").as_string());
    view->cam_from_world = ReadMetashapePose(camera.child("transform"),
                                             component == places_.end() ? places_[""] : component->second, place);
    view->as_stored = true;  // the resolution of a sensor is that of the pixels in the file
  }

 private:
  /// Cameras may lie in groups.
  void AddCameras(const pugi::xml_node& cameras) {
    for (const pugi::xml_node& group : cameras.children("group")) {
      for (const pugi::xml_node& camera : group.children("camera")) AddCamera(camera);
    }
    for (const pugi::xml_node& camera : cameras.children("camera")) AddCamera(camera);
  }

  void AddCamera(const pugi::xml_node& camera) {
    if (!camera.attribute("enabled").as_bool(true)) return;
    const std::string label = camera.attribute("label").as_string();
    if (!camera.child("transform")) return unplaced_.push_back(OneLine(label));
    cameras_.push_back(camera);
  }

  pugi::xml_node chunk_;
  std::string file_;
  std::map<std::string, ChunkPlace> places_;  ///< by the id of a component; "" is the chunk itself
  std::map<std::string, pugi::xml_node> sensors_;
  std::map<std::string, Sensor> read_;
  std::vector<pugi::xml_node> cameras_;
  std::vector<std::string> unplaced_;
  double shear_ = 0;
};

}  // namespace

bool IsMetashapeScene(const fs::path& root) { return !MetashapeFile(root).empty(); }

Scene ReadMetashapeScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const fs::path path = MetashapeFile(root);
  const std::string file = path.string(), text = ReadFile(path);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) throw InputError("{}: is not valid XML: {} at byte {}", file, parsed.description(), parsed.offset);
  MetashapeChunk chunk(document.child("document").child("chunk"), file);
  if (chunk.cameras().empty()) {
    throw InputError(
        "{}: has no camera with a pose; align the photos in Metashape, or take the file away to have the cameras found "
        "from the photos",
        file);
  }
  std::vector<std::string> labels;
  for (const pugi::xml_node& camera : chunk.cameras()) labels.emplace_back(camera.attribute("label").as_string());
  const fs::path folder = DatasetImageFolder(root, options);
  std::vector<SceneView> views = ViewsOfNames(labels, file, folder, options, listener);
  for (size_t i = 0; i < views.size(); ++i) {
    if (!views[i].image_path.empty()) chunk.Fill(chunk.cameras()[i], &views[i]);
  }
  ReportUnplaced(file, chunk.unplaced(), listener);
  if (chunk.shear() > kMaxShearPixels) {
    listener(
        Warning{fmt::format("{}: b2, which no camera model has, is left out and moves pixels by up to {:.2g}; fix "
                            "it to 0 in Metashape, or export undistorted photos",
                            file, chunk.shear())});
  }
  return SceneOfDataset(path, SceneFormat::kMetashape, std::move(views), folder, listener);
}

}  // namespace oraclegs
