#include "oraclegs/scene/transforms_frame.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/brown_lens.h"
#include "oraclegs/scene/rotation.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

using nlohmann::json;

constexpr double kLastRowTolerance = 1e-4;

const json* FindIn(const json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? nullptr : &*found;
}

double Number(const json& value, const char* key, const std::string& place) {
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (!std::isfinite(number)) throw InputError("{}: \"{}\" is not a finite number", place, key);
  return number;
}

std::optional<double> NumberIn(const json& object, const char* key, const std::string& place) {
  const json* value = FindIn(object, key);
  if (!value) return std::nullopt;
  return Number(*value, key, place);
}

std::optional<int> FindSide(const TransformsFrame& frame, const char* key) {
  const auto side = frame.FindNumber(key);
  if (!side) return std::nullopt;
  if (*side < 1 || *side > kMaxImageSide || std::abs(*side - std::round(*side)) > 1e-6) {
    throw InputError("{}: \"{}\" is {}, must be a whole number of pixels", frame.place, key, *side);
  }
  return static_cast<int>(std::round(*side));
}

void ReadSize(const TransformsFrame& frame, const std::filesystem::path& image_path, Intrinsics* intrinsics) {
  const auto width = FindSide(frame, "w"), height = FindSide(frame, "h");
  if (!width || !height) ReadImageSize(image_path, &intrinsics->width, &intrinsics->height);
  if (width) intrinsics->width = *width;
  if (height) intrinsics->height = *height;
}

/// The focal length that `object` itself gives for an axis of `side` pixels.
std::optional<double> FocalIn(const json& object, const char* focal_key, const char* angle_key, int side,
                              const std::string& place) {
  if (const auto focal = NumberIn(object, focal_key, place)) return focal;
  const auto angle = NumberIn(object, angle_key, place);
  if (!angle) return std::nullopt;
  if (!(*angle > 0 && *angle < std::numbers::pi)) {
    throw InputError("{}: \"{}\" is {}, must be an angle in radians between 0 and pi", place, angle_key, *angle);
  }
  return side / 2.0 / std::tan(*angle / 2);
}

/// fx and fy from the frame if it says anything about focal lengths, else from the file; one missing equals the other.
std::pair<double, double> ReadFocals(const TransformsFrame& frame, const Intrinsics& intrinsics) {
  for (const json* object : {&frame.frame, &frame.file}) {
    const auto fx = FocalIn(*object, "fl_x", "camera_angle_x", intrinsics.width, frame.place);
    const auto fy = FocalIn(*object, "fl_y", "camera_angle_y", intrinsics.height, frame.place);
    if (!fx && !fy) continue;
    return {fx ? *fx : *fy, fy ? *fy : *fx};
  }
  throw InputError("{}: no focal length; add \"fl_x\" in pixels or \"camera_angle_x\" in radians", frame.place);
}

/// Throws for a camera_model that is neither fisheye nor perspective.
bool IsFisheye(const TransformsFrame& frame) {
  const std::string model = frame.FindText("camera_model").value_or("OPENCV");
  if (model == "OPENCV_FISHEYE") return true;
  for (const char* known : {"OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL", "FULL_OPENCV"}) {
    if (model != known) continue;
    const json* flag = frame.Find("is_fisheye");  // instant-ngp's way to say it
    return flag && flag->is_boolean() && flag->get<bool>();
  }
  throw InputError("{}: camera_model '{}' is not supported; undistort the photos to PINHOLE first", frame.place,
                   Printable(model));
}

/// Puts the words NaN, Infinity and -Infinity, which Python writes and JSON does not know, in quotes, so that the error
/// names the frame that has one and not only a byte.
std::string QuoteNaN(const std::string& text) {
  const auto word_at = [&](size_t i) -> std::string_view {
    for (const std::string_view word : {"NaN", "-Infinity", "Infinity"}) {
      if (text.compare(i, word.size(), word) == 0) return word;
    }
    return {};
  };
  std::string quoted;
  quoted.reserve(text.size());
  bool in_string = false;
  for (size_t i = 0; i < text.size();) {
    const std::string_view word = in_string ? std::string_view() : word_at(i);
    const bool escape = in_string && text[i] == '\\' && i + 1 < text.size();
    const size_t length = escape ? 2 : std::max<size_t>(word.size(), 1);
    if (text[i] == '"') in_string = !in_string;
    if (!word.empty()) quoted += '"';
    quoted.append(text, i, length);
    if (!word.empty()) quoted += '"';
    i += length;
  }
  return quoted;
}

}  // namespace

json ReadTransformsFile(const std::filesystem::path& path) {
  json file;
  try {
    file = ParseJson(QuoteNaN(ReadFile(path)));
  } catch (const json::exception& error) {
    throw InputError("{}: is not valid JSON: {}", path.string(), error.what());
  }
  const json* frames = file.is_object() ? FindIn(file, "frames") : nullptr;
  if (!frames || !frames->is_array() || frames->empty()) {
    throw InputError("{}: has no \"frames\"; expected the layout of instant-ngp, Nerfstudio or Blender", path.string());
  }
  return file;
}

NamedTransformsFrame NamedFrame(const json& file, const json& entry, const std::filesystem::path& path, int index) {
  const json* written = entry.is_object() ? FindIn(entry, "file_path") : nullptr;
  const std::string place = fmt::format("{}: frame {}", path.string(), index);
  if (!written || !written->is_string()) throw InputError("{}: has no \"file_path\"", place);
  const std::string name = written->get<std::string>();
  if (ViewName(name).empty() || std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; })) {
    throw InputError("{}: \"file_path\" is empty or has control characters", place);
  }
  return {{file, entry, fmt::format("{}: frame '{}'", path.string(), name)}, name};
}

std::filesystem::path FindFrameImage(const std::filesystem::path& folder, const std::string& file_path) {
  static constexpr const char* kExtensions[] = {"", ".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".JPEG"};
  for (const char* extension : kExtensions) {
    std::filesystem::path path = folder / (file_path + extension);
    if (IsFile(path)) return path;
  }
  return {};
}

const json* TransformsFrame::Find(const char* key) const {
  const json* value = FindIn(frame, key);
  return value ? value : FindIn(file, key);
}

std::optional<double> TransformsFrame::FindNumber(const char* key) const {
  const json* value = Find(key);
  if (!value) return std::nullopt;
  return Number(*value, key, place);
}

std::optional<std::string> TransformsFrame::FindText(const char* key) const {
  const json* value = Find(key);
  if (!value) return std::nullopt;
  if (!value->is_string()) throw InputError("{}: \"{}\" is not text", place, key);
  return value->get<std::string>();
}

bool IsSphereFrame(const TransformsFrame& frame) { return frame.FindText("camera_model") == "EQUIRECTANGULAR"; }

Intrinsics ReadTransformsIntrinsics(const TransformsFrame& frame, const std::filesystem::path& image_path) {
  Intrinsics size;
  ReadSize(frame, image_path, &size);
  const auto [fx, fy] = ReadFocals(frame, size);
  const auto number = [&](const char* key, double missing = 0) { return frame.FindNumber(key).value_or(missing); };
  BrownLens lens{size.width, size.height, fx, fy, number("cx", size.width / 2.0), number("cy", size.height / 2.0)};
  lens.k = {number("k1"), number("k2"), number("k3"), number("k4")};
  lens.fisheye = IsFisheye(frame);
  if (!lens.fisheye) {  // OpenCV's fisheye model has none
    lens.p1 = number("p1");
    lens.p2 = number("p2");
  }
  return IntrinsicsOf(lens, frame.place);
}

TransformsPose ReadTransformsPose(const TransformsFrame& frame) {
  const json* rows = FindIn(frame.frame, "transform_matrix");
  if (!rows || !rows->is_array() || (rows->size() != 3 && rows->size() != 4)) {
    throw InputError("{}: \"transform_matrix\" is missing or has not 3 or 4 rows", frame.place);
  }
  Eigen::Matrix4d world_from_cam = Eigen::Matrix4d::Identity();
  for (size_t r = 0; r < rows->size(); ++r) {
    const json& row = (*rows)[r];
    if (!row.is_array() || row.size() != 4) {
      throw InputError("{}: row {} of \"transform_matrix\" has not 4 numbers", frame.place, r);
    }
    for (size_t c = 0; c < 4; ++c) {
      world_from_cam(static_cast<int>(r), static_cast<int>(c)) = Number(row[c], "transform_matrix", frame.place);
    }
  }
  if ((world_from_cam.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > kLastRowTolerance) {
    throw InputError("{}: the last row of \"transform_matrix\" is not 0 0 0 1", frame.place);
  }
  auto [rotation, rounding] =
      NearestRotation(world_from_cam.topLeftCorner<3, 3>(), frame.place + ": \"transform_matrix\"");
  rotation.col(1) *= -1;  // OpenGL's y up and z backward become y down and z forward
  rotation.col(2) *= -1;
  Eigen::Isometry3d cam_from_world = Eigen::Isometry3d::Identity();
  cam_from_world.linear() = rotation.transpose();
  cam_from_world.translation() = -(rotation.transpose() * world_from_cam.topRightCorner<3, 1>());
  return {cam_from_world, rounding};
}

}  // namespace oraclegs
