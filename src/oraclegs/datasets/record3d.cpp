#include "oraclegs/datasets/record3d.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/datasets/dataset_images.h"
#include "oraclegs/datasets/pose_files.h"
#include "oraclegs/scene/transforms_frame.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr uint64_t kMaxMetadataBytes = 256 << 20;
constexpr double kMinQuaternion = 0.5, kMaxQuaternion = 2;  // lengths of those that few decimals make

struct Record3dFolder {
  fs::path metadata, images;
};

std::optional<Record3dFolder> FindRecord3d(const fs::path& root) {
  for (const char* file : {"metadata.json", "metadata"}) {
    const fs::path metadata = root / file;
    if (!IsFile(metadata)) continue;
    for (const char* images : {"rgbd", "rgb"}) {
      if (IsFolder(root / images) && !FilesThatEnd(root / images, ".jpg").empty()) {
        return Record3dFolder{metadata, root / images};
      }
    }
  }
  return std::nullopt;
}

/// `count` numbers of a list; throws InputError for anything else.
std::vector<double> Record3dNumbers(const json& list, size_t count, const std::string& place) {
  std::vector<double> numbers;
  if (list.is_array() && list.size() == count) {
    for (const json& number : list) numbers.push_back(number.is_number() ? number.get<double>() : NAN);
  }
  if (numbers.size() != count) {
    throw InputError("{}: is no list of {} numbers; export the capture from Record3D again", place, count);
  }
  return numbers;
}

json MatrixOf(const json& pose, const std::string& place) {
  const std::vector<double> p = Record3dNumbers(pose, 7, place);
  const Eigen::Quaterniond turn(p[3], p[0], p[1], p[2]);
  if (!(turn.norm() > kMinQuaternion && turn.norm() < kMaxQuaternion)) {
    throw InputError("{}: has no rotation; export the capture from Record3D again", place);
  }
  const Eigen::Matrix3d m = turn.normalized().toRotationMatrix();
  json rows = json::array();
  for (int row = 0; row < 3; ++row) rows.push_back({m(row, 0), m(row, 1), m(row, 2), p[static_cast<size_t>(4 + row)]});
  return rows;
}

/// The number that a file is called by.
std::optional<size_t> NumberOfFrame(const fs::path& image) {
  const std::string stem = image.stem().string();
  size_t number = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
  return error == std::errc() && end == stem.data() + stem.size() ? std::optional(number) : std::nullopt;
}

json ReadMetadata(const fs::path& path) {
  try {
    json metadata = ParseJson(ReadFile(path, kMaxMetadataBytes));
    if (metadata.is_object() && metadata.contains("poses") && metadata["poses"].is_array()) return metadata;
  } catch (const json::exception& error) {
    throw InputError("{}: is not valid JSON: {}", path.string(), error.what());
  }
  throw InputError("{}: has no \"poses\"; export the capture from Record3D again, or name the folder of its images",
                   path.string());
}

}  // namespace

bool IsRecord3dScene(const fs::path& root) {
  const auto folder = FindRecord3d(root);
  const std::string head = folder ? HeadOfPoseFile(folder->metadata) : "";
  return head.starts_with('{') &&
         (head.find("\"K\"") != std::string::npos || head.find("\"poses\"") != std::string::npos);
}

Scene ReadRecord3dScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const auto [path, usual_images] = FindRecord3d(root).value();
  const fs::path images = options.images.empty() ? usual_images : root / options.images;
  const json metadata = ReadMetadata(path);
  const json& poses = metadata["poses"];
  const std::vector<double> k = Record3dNumbers(metadata.value("K", json()), 9, path.string() + ": \"K\"");
  const json lens = {{"fl_x", k[0]},
                     {"fl_y", k[4]},
                     {"cx", k[6]},
                     {"cy", k[7]},
                     {"w", metadata.value("w", json())},
                     {"h", metadata.value("h", json())}};
  std::vector<SceneView> views;
  std::vector<std::string> unplaced;
  for (const fs::path& image : SortedImages(images)) {
    SceneView view;
    view.name = image.filename().string();
    view.image_path = image;
    const auto number = NumberOfFrame(image);
    if (!number || *number >= poses.size()) {
      unplaced.push_back(view.name);
      continue;
    }
    const std::string place = fmt::format("{}: pose {}", path.string(), *number);
    const json frame = {{"transform_matrix", MatrixOf(poses[*number], place)}};
    const TransformsFrame read{lens, frame, place};
    view.intrinsics = ReadTransformsIntrinsics(read, image);
    view.cam_from_world = ReadTransformsPose(read).cam_from_world;
    views.push_back(std::move(view));
  }
  ReportUnplaced(path.string(), unplaced, listener);
  listener(Note{
      fmt::format("{}: depth of Record3D (packed by LZFSE, or EXR) is not read; examples/record3d writes PNGs of it",
                  path.string())});
  return SceneOfDataset(path, SceneFormat::kRecord3d, std::move(views), images, listener);
}

}  // namespace oraclegs
