#include "oraclegs/workspace/frame_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/sha256.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr uint64_t kMaxFrameBytes = 1 << 20;

/// Hash of the poses as they were found.
std::string KeyOf(const Scene& scene) {
  Sha256 hash;
  for (const SceneView& view : scene.views) {
    const Eigen::Matrix4d pose = view.cam_from_world->matrix();
    hash.Add({reinterpret_cast<const char*>(pose.data()), sizeof(double) * 16});
  }
  return hash.Hex();
}

json ReadJson(const fs::path& file) {
  try {
    return ParseJsonOrDiscard(ReadFile(file, kMaxFrameBytes));
  } catch (const Error&) {
    return nullptr;
  }
}

std::optional<SceneFrame> FromJson(const json& saved) {
  if (!saved.is_object()) return std::nullopt;
  std::vector<double> numbers;
  for (const char* name : {"rotation", "center", "scale", "offset"}) {
    const bool is_optional = std::string_view(name) == "offset";
    const json value = saved.value(name, is_optional ? json::array({0, 0, 0}) : json());
    for (const json& number : value.is_array() ? value : json::array({value})) {
      if (!number.is_number() || !std::isfinite(number.get<double>())) return std::nullopt;
      numbers.push_back(number.get<double>());
    }
  }
  SceneFrame frame;
  if (numbers.size() != 16 || !(numbers[12] > 0)) return std::nullopt;
  for (int i = 0; i < 9; ++i) frame.rotation(i / 3, i % 3) = numbers[static_cast<size_t>(i)];
  for (int i = 0; i < 3; ++i) frame.center[i] = numbers[static_cast<size_t>(9 + i)];
  frame.scale = numbers[12];
  for (int i = 0; i < 3; ++i) frame.offset[i] = numbers[static_cast<size_t>(13 + i)];
  frame.is_given = saved.value("poses_given", json()) == true;
  frame.is_level = !frame.is_given;
  const bool turns = (frame.rotation * frame.rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-6;
  return turns ? std::optional(frame) : std::nullopt;
}

}  // namespace

std::optional<SceneFrame> ReadFrame(const fs::path& file) { return FromJson(ReadJson(file)); }

SceneFrame FrameOf(const Scene& scene, const fs::path& file) {
  const json saved = ReadJson(file);
  if (saved.is_object() && saved.value("poses", json()) == KeyOf(scene)) {
    if (const auto frame = FromJson(saved); frame && !frame->is_given) return *frame;
  }
  return LevelFrame(scene);
}

void WriteFrame(const Scene& scene, const SceneFrame& frame, const fs::path& file) {
  const Eigen::Matrix3d& r = frame.rotation;
  const json json = {{"poses", KeyOf(scene)},
                     {"rotation", {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}},
                     {"center", {frame.center.x(), frame.center.y(), frame.center.z()}},
                     {"scale", frame.scale},
                     {"offset", {frame.offset.x(), frame.offset.y(), frame.offset.z()}},
                     {"poses_given", frame.is_given}};
  WriteFileAtomically(file, json.dump(1) + "\n");
}

}  // namespace oraclegs
