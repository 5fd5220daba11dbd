#include "oraclegs/depth/given_depth.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/depth/depth_files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr char kParams[] = "depth_params.json";
constexpr uint64_t kMaxParamsBytes = 64 << 20;
constexpr float kWhole16 = 65536;
constexpr float kGivenConfidence = 0.9f;  // of a depth that comes without
constexpr float kMaxStep = 0.05f;         // relative step of depth to a neighbor on the same surface

/// Inverse depth = value of the file * scale + offset, 1 / unit of the cameras.
struct Params {
  float scale = 0, offset = 0;
};

std::vector<Params> ReadParams(const fs::path& dir, const std::vector<std::string>& stems, double unit) {
  const fs::path path = dir / kParams;
  nlohmann::json json;
  try {
    json = ParseJson(ReadFile(path, kMaxParamsBytes));
  } catch (const nlohmann::json::exception& error) {
    throw InputError("{}: is not valid JSON ({})", path.string(), error.what());
  }
  std::vector<Params> all;
  for (const std::string& stem : stems) {
    const auto number = [&](const char* key) {
      const nlohmann::json view = json.is_object() ? json.value(stem, nlohmann::json()) : nlohmann::json();
      const nlohmann::json value = view.is_object() ? view.value(key, nlohmann::json()) : nlohmann::json();
      const auto read = static_cast<float>(value.is_number() ? value.get<double>() * unit : NAN);
      if (std::isfinite(read)) return read;
      throw InputError("{}: has no number \"{}\" for \"{}\"; give {{\"{}\": {{\"scale\": ..., \"offset\": ...}}}}",
                       path.string(), key, stem, stem);
    };
    all.push_back({number("scale"), number("offset")});
  }
  return all;
}

fs::path ConfidenceFile(const fs::path& dir, const std::string& stem) { return dir / "confidence" / (stem + ".png"); }

/// Pixel of an image of another size that covers the middle of pixel (x, y) of the camera's.
size_t Nearest(const Camera& camera, int x, int y, int width, int height) {
  const auto at = [](int64_t i, int64_t from, int64_t to) { return std::min(to - 1, (2 * i + 1) * to / (2 * from)); };
  return static_cast<size_t>(at(y, camera.height, height) * width + at(x, camera.width, width));
}

/// A depth is known where the file has one that is finite and in front of the camera.
void FillDepth(const Image16& depth, const Params& params, DepthMap* map) {
  for (int y = 0; y < map->camera.height; ++y) {
    for (int x = 0; x < map->camera.width; ++x) {
      const uint16_t value = depth.values[Nearest(map->camera, x, y, depth.width, depth.height)];
      const float inv_depth = static_cast<float>(value) / kWhole16 * params.scale + params.offset;
      map->inv_depth.push_back(value > 0 && inv_depth > 0 && std::isfinite(inv_depth) ? inv_depth : 0);
    }
  }
}

void FillConfidence(const fs::path& file, DepthMap* map) {
  std::error_code ignored;
  const bool is_given = fs::exists(file, ignored);
  const Image8 image = is_given ? ReadImage(file) : Image8();
  for (int y = 0; y < map->camera.height; ++y) {
    for (int x = 0; x < map->camera.width; ++x) {
      float confidence = kGivenConfidence;
      if (is_given) {
        const size_t at = Nearest(map->camera, x, y, image.width, image.height);
        confidence = static_cast<float>(image.data[at * static_cast<size_t>(image.channels)]) / 255;
      }
      map->confidence.push_back(map->inv_depth[map->confidence.size()] > 0 ? confidence : 0);
    }
  }
}

/// Point of a pixel in the camera's frame; zero where nothing is known.
Eigen::Vector3f PointOf(const DepthMap& map, int x, int y) {
  const Camera& camera = map.camera;
  if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) return Eigen::Vector3f::Zero();
  const float inv_depth = map.inv_depth[static_cast<size_t>(y) * static_cast<size_t>(camera.width) + x];
  if (!(inv_depth > 0)) return Eigen::Vector3f::Zero();
  const Eigen::Vector3d ray((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
  return (ray / static_cast<double>(inv_depth)).cast<float>();
}

/// Way to the neighbor on one side, or from that on the other, on the same surface; zero where there is none.
Eigen::Vector3f Tangent(const DepthMap& map, int x, int y, int dx, int dy) {
  const Eigen::Vector3f here = PointOf(map, x, y);
  for (const int side : {1, -1}) {
    const Eigen::Vector3f there = PointOf(map, x + side * dx, y + side * dy);
    if (there.z() > 0 && std::abs(there.z() - here.z()) < kMaxStep * here.z()) {
      return static_cast<float>(side) * (there - here);
    }
  }
  return Eigen::Vector3f::Zero();
}

void FillNormals(DepthMap* map) {
  for (int y = 0; y < map->camera.height; ++y) {
    for (int x = 0; x < map->camera.width; ++x) {
      const size_t i = map->normals.size();
      Eigen::Vector3f normal = Eigen::Vector3f::Zero();
      if (map->confidence[i] > 0) {
        const Eigen::Vector3f across = Tangent(*map, x, y, 0, 1).cross(Tangent(*map, x, y, 1, 0));
        const Eigen::Vector3f ray = PointOf(*map, x, y).normalized();
        normal = across.squaredNorm() > 0 ? across.normalized() : Eigen::Vector3f(-ray);
        if (normal.dot(ray) > 0) normal = -normal;
      }
      map->normals.push_back(normal);
    }
  }
}

}  // namespace

std::vector<fs::path> GivenDepthFiles(const fs::path& dir, const std::vector<std::string>& names) {
  std::error_code ignored;
  if (!fs::is_directory(dir, ignored)) {
    throw InputError("{}: is no folder; name one with depth of your own with --set depth-folder", dir.string());
  }
  std::vector<fs::path> files = {dir / kParams};
  for (const std::string& stem : DepthFileStems(names)) files.push_back(dir / (stem + ".png"));
  for (const fs::path& file : files) {
    if (!fs::exists(file, ignored)) {
      throw InputError("{}: is missing; --set depth-folder needs depth of every training view", file.string());
    }
  }
  for (const std::string& stem : DepthFileStems(names)) {
    if (const fs::path file = ConfidenceFile(dir, stem); fs::exists(file, ignored)) files.push_back(file);
  }
  return files;
}

std::vector<DepthMap> ReadGivenDepth(const fs::path& dir, const std::vector<std::string>& names,
                                     const std::vector<Camera>& cameras, double unit) {
  GivenDepthFiles(dir, names);
  const std::vector<std::string> stems = DepthFileStems(names);
  const std::vector<Params> params = ReadParams(dir, stems, unit);
  std::vector<DepthMap> maps(names.size());
  ParallelFor(static_cast<int64_t>(names.size()), [&](int64_t task) {
    const auto v = static_cast<size_t>(task);
    DepthMap map{names[v], cameras[v], {}, {}, {}};
    FillDepth(ReadPng16(dir / (stems[v] + ".png")), params[v], &map);
    FillConfidence(ConfidenceFile(dir, stems[v]), &map);
    FillNormals(&map);
    maps[v] = std::move(map);
  });
  return maps;
}

}  // namespace oraclegs
