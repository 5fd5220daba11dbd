#pragma once
// One frame of a transforms.json: its intrinsics and its pose.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// A frame with the file it stands in; `place` ("FILE: frame 'NAME'") opens every error message.
struct TransformsFrame {
  const nlohmann::json& file;
  const nlohmann::json& frame;
  std::string place;

  /// The frame's value, or else the file's; nullptr when neither has it (or it is null).
  const nlohmann::json* Find(const char* key) const;
  /// That value as a finite number; throws InputError when it is something else.
  std::optional<double> FindNumber(const char* key) const;
  /// That value as text.
  std::optional<std::string> FindText(const char* key) const;
};

/// The JSON of a transforms.json. Throws InputError naming the place when it is not JSON, or has no frames. NaN and
/// Infinity, which Python writes, stand as text in it, so that the frame that has one can be named.
nlohmann::json ReadTransformsFile(const std::filesystem::path& path);

/// A frame of `file` and its file_path as written. Throws InputError when it has none, or one that cannot be a name.
struct NamedTransformsFrame {
  TransformsFrame frame;
  std::string file_path;
};
NamedTransformsFrame NamedFrame(const nlohmann::json& file, const nlohmann::json& entry,
                                const std::filesystem::path& path, int index);

/// The image that file_path means: as written or with an extension appended; empty when there is none.
std::filesystem::path FindFrameImage(const std::filesystem::path& folder, const std::string& file_path);

/// True for an equirectangular image, which no intrinsics describe: its middle is where the camera looks.
bool IsSphereFrame(const TransformsFrame& frame);

/// The intrinsics; w and h missing are read from the image's header. Throws InputError as ReadTransformsScene says.
Intrinsics ReadTransformsIntrinsics(const TransformsFrame& frame, const std::filesystem::path& image_path);

/// A pose, and by how much the file's matrix was off the nearest rotation (its largest element).
struct TransformsPose {
  Eigen::Isometry3d cam_from_world;
  double rounding = 0;
};

/// transform_matrix (3x4 or 4x4, camera to world, OpenGL axes) as a pose, with the rotation nearest to it. Throws
/// InputError when it is not finite, more than 0.01 off a rotation (a scale, a mirror), or of another shape.
TransformsPose ReadTransformsPose(const TransformsFrame& frame);

}  // namespace oraclegs
