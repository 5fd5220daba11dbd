#include "oraclegs/depth/depth_files.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/colormap.h"
#include "oraclegs/image/image.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "PLY files are written as the machine stores numbers");

constexpr float kMax16 = 65535;
constexpr float kMinStoredConfidence = 0.01f;  // below, the depth is written as unknown

std::string Stem(const std::string& name) {
  std::string stem = fs::path(name).replace_extension().string();
  std::replace(stem.begin(), stem.end(), '/', '_');
  return stem;
}

uint8_t Byte(float value) { return static_cast<uint8_t>(std::lround(255 * std::clamp(value, 0.f, 1.f))); }

Image8 Blank(const Camera& camera, int channels, int columns = 1) {
  Image8 image{camera.width * columns, camera.height, channels, {}};
  image.data.assign(static_cast<size_t>(image.width) * image.height * channels, 0);
  return image;
}

Image8 NormalImage(const DepthMap& map) {
  Image8 image = Blank(map.camera, 3);
  for (size_t i = 0; i < map.size(); ++i) {
    if (!(map.confidence[i] > 0)) continue;
    for (int c = 0; c < 3; ++c) image.data[3 * i + c] = Byte((map.normals[i][c] + 1) / 2);
  }
  return image;
}

Image8 ConfidenceImage(const DepthMap& map) {
  Image8 image = Blank(map.camera, 1);
  for (size_t i = 0; i < map.size(); ++i) image.data[i] = Byte(map.confidence[i]);
  return image;
}

/// Range of the inverse depths of confident pixels, without the outermost percent.
std::pair<float, float> InverseDepthSpan(const DepthMap& map) {
  std::vector<float> values;
  for (size_t i = 0; i < map.size(); ++i) {
    if (map.confidence[i] >= kConfident) values.push_back(map.inv_depth[i]);
  }
  if (values.empty()) return {0.f, 1.f};
  std::sort(values.begin(), values.end());
  const size_t cut = values.size() / 100;
  return {values[cut], std::max(values[values.size() - 1 - cut], values[cut] * 1.001f)};
}

Image8 Preview(const DepthMap& map) {
  Image8 image = Blank(map.camera, 3, 2);
  const auto [low, high] = InverseDepthSpan(map);
  const auto width = static_cast<size_t>(map.camera.width);
  for (size_t i = 0; i < map.size(); ++i) {
    const size_t left = 3 * (i / width * 2 * width + i % width), right = left + 3 * width;
    const auto depth = MapColor(ColorMap::kViridis, (map.inv_depth[i] - low) / (high - low));
    const auto confidence = MapColor(ColorMap::kPlasma, map.confidence[i]);
    if (map.inv_depth[i] > 0) std::copy(depth.begin(), depth.end(), image.data.begin() + static_cast<int64_t>(left));
    std::copy(confidence.begin(), confidence.end(), image.data.begin() + static_cast<int64_t>(right));
  }
  return image;
}

/// The largest inverse depth that is stored as known, so that one outlier in front does not cost all others their
/// precision.
float LargestStored(const DepthMap& map) {
  float largest = 0;
  for (size_t i = 0; i < map.size(); ++i) {
    if (map.confidence[i] >= kMinStoredConfidence) largest = std::max(largest, map.inv_depth[i]);
  }
  return largest;
}

std::vector<uint16_t> Quantized(const DepthMap& map, float scale) {
  std::vector<uint16_t> values(map.size());
  for (size_t i = 0; i < map.size(); ++i) {
    if (map.confidence[i] < kMinStoredConfidence) continue;
    values[i] = static_cast<uint16_t>(std::lround(kMax16 * std::clamp(map.inv_depth[i] / scale, 0.f, 1.f)));
  }
  return values;
}

nlohmann::json ReadParams(const fs::path& path) {
  try {
    return ParseJson(ReadFile(path, uint64_t{1} << 26));
  } catch (const nlohmann::json::exception& error) {
    throw InputError("{}: is not valid JSON ({}); remove the folder, and it is made again", path.string(),
                     error.what());
  }
}

/// Reads an inverse depth from the file, in 1 / unit.
float Number(const nlohmann::json& params, const std::string& stem, const char* key, double unit,
             const fs::path& path) {
  const auto found = params.is_object() ? params.find(stem) : params.end();
  const bool is_there =
      found != params.end() && found->is_object() && found->contains(key) && (*found)[key].is_number();
  const auto number = static_cast<float>(is_there ? (*found)[key].get<double>() * unit : NAN);
  if (std::isfinite(number)) return number;
  throw InputError("{}: has no number {} for {}; remove the folder, and it is made again", path.string(), key, stem);
}

void RequireSize(const fs::path& path, int width, int height, const Camera& camera) {
  if (width == camera.width && height == camera.height) return;
  throw InputError("{}: is {} x {}, its view {} x {}; remove the folder, and it is made again", path.string(), width,
                   height, camera.width, camera.height);
}

/// Folders of a map's images, and the ends of their names.
constexpr std::array<std::pair<const char*, const char*>, 4> kFolders = {
    {{"", ".png"}, {"confidence", ".png"}, {"normals", ".png"}, {"preview", ".jpg"}}};

void WriteImage(const fs::path& path, const DepthMap& map, float scale, size_t folder) {
  switch (folder) {
    case 0:
      return WritePng16(path, map.camera.width, map.camera.height, Quantized(map, scale));
    case 1:
      return WritePng(path, ConfidenceImage(map));
    case 2:
      return WritePng(path, NormalImage(map));
    default:
      return WriteFileAtomically(path, CompressJpeg(Preview(map), kPreviewQuality));
  }
}

DepthMap ReadDepthMap(const fs::path& dir, const std::string& file, DepthMap map, float scale, float offset) {
  const Image16 depth = ReadPng16(dir / file);
  RequireSize(dir / file, depth.width, depth.height, map.camera);
  const Image8 confidences = ReadImage(dir / "confidence" / file), normals = ReadImage(dir / "normals" / file);
  RequireSize(dir / "confidence" / file, confidences.width, confidences.height, map.camera);
  RequireSize(dir / "normals" / file, normals.width, normals.height, map.camera);
  for (size_t i = 0; i < depth.values.size(); ++i) {
    const uint8_t* n = normals.data.data() + static_cast<size_t>(normals.channels) * i;
    const float confidence = static_cast<float>(confidences.data[static_cast<size_t>(confidences.channels) * i]) / 255;
    const float inv_depth = static_cast<float>(depth.values[i]) / kMax16 * scale + offset;
    const bool known = depth.values[i] > 0 && inv_depth > 0;
    const Eigen::Vector3f normal = Eigen::Vector3f(n[0], n[1], n[2]) * (2.f / 255) - Eigen::Vector3f::Ones();
    map.inv_depth.push_back(known ? inv_depth : 0);
    map.confidence.push_back(known ? confidence : 0);
    map.normals.push_back(known && confidence > 0 ? normal.normalized() : Eigen::Vector3f::Zero());
  }
  return map;
}

template <class T>
void Append(std::string* bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes->append(raw, sizeof(T));
}

}  // namespace

std::vector<std::string> DepthFileStems(const std::vector<std::string>& names) {
  std::map<std::string, int> uses;
  for (const std::string& name : names) ++uses[Stem(name)];
  std::vector<std::string> stems;
  for (size_t i = 0; i < names.size(); ++i) {
    std::string stem = Stem(names[i]);
    if (uses[stem] > 1) {
      stem += fmt::format("_{}", i);
      while (uses.count(stem) > 0) stem += "_";
      uses[stem] = 1;
    }
    stems.push_back(std::move(stem));
  }
  return stems;
}

std::vector<std::string> WriteDepthMaps(const fs::path& dir, const std::vector<DepthMap>& maps, double unit) {
  std::vector<std::string> names;
  for (const DepthMap& map : maps) names.push_back(map.name);
  const std::vector<std::string> stems = DepthFileStems(names);
  nlohmann::json params = nlohmann::json::object();
  std::vector<float> scales;
  std::vector<std::string> files;
  std::vector<size_t> of_file;  // whose map it is
  for (size_t v = 0; v < maps.size(); ++v) {
    const float largest = LargestStored(maps[v]);
    scales.push_back(maps[v].size() == 0 ? 0 : largest > 0 ? largest : 1);
    params[stems[v]] = {{"scale", static_cast<double>(scales[v]) / unit}, {"offset", 0}};
    if (maps[v].monocular) params[stems[v]]["monocular"] = true;
    if (maps[v].size() == 0) continue;
    for (const auto& [folder, end] : kFolders) {
      files.push_back((fs::path(folder) / (stems[v] + end)).string());
      of_file.push_back(v);
    }
  }
  // One task per file: compression takes longest.
  ParallelFor(static_cast<int64_t>(files.size()), [&](int64_t task) {
    const auto file = static_cast<size_t>(task), v = of_file[file];
    WriteImage(dir / files[file], maps[v], scales[v], file % kFolders.size());
  });
  files.emplace_back("depth_params.json");
  WriteFileAtomically(dir / "depth_params.json", params.dump(2) + "\n");
  return files;
}

std::vector<DepthMap> ReadDepthMaps(const fs::path& dir, const std::vector<std::string>& names,
                                    const std::vector<Camera>& cameras, double unit) {
  const fs::path params_path = dir / "depth_params.json";
  const nlohmann::json params = ReadParams(params_path);
  const std::vector<std::string> stems = DepthFileStems(names);
  std::vector<DepthMap> maps(names.size());
  ParallelFor(static_cast<int64_t>(names.size()), [&](int64_t task) {
    const auto v = static_cast<size_t>(task);
    const float scale = Number(params, stems[v], "scale", unit, params_path);
    const float offset = Number(params, stems[v], "offset", unit, params_path);
    DepthMap map{names[v], cameras[v], {}, {}, {}};
    if (scale > 0) map = ReadDepthMap(dir, stems[v] + ".png", std::move(map), scale, offset);
    map.monocular = params[stems[v]].value("monocular", nlohmann::json()) == true;
    maps[v] = std::move(map);
  });
  return maps;
}

void WriteDensePly(const fs::path& path, const std::vector<DensePoint>& points, const Similarity& placement,
                   const std::vector<std::string>& comments) {
  std::string ply = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : comments) ply += "comment " + comment + "\n";
  ply += fmt::format(
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nproperty float confidence\nproperty uchar views\nend_header\n",
      points.size());
  for (const DensePoint& p : points) {
    const Eigen::Vector3f xyz = (placement * p.xyz.cast<double>()).cast<float>();
    for (int c = 0; c < 3; ++c) Append(&ply, xyz[c]);
    for (int c = 0; c < 3; ++c) Append(&ply, p.normal[c]);
    for (int c = 0; c < 3; ++c) Append(&ply, Byte(p.rgb[c]));
    Append(&ply, p.confidence);
    Append(&ply, static_cast<uint8_t>(std::min(p.views, 255)));
  }
  WriteFileAtomically(path, ply);
}

}  // namespace oraclegs
