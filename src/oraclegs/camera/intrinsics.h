#pragma once
// Camera models: all eleven of COLMAP 3.8 [Schoenberger 2016], by its names and parameter orders.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

enum class CameraModel {  // the values are COLMAP's model ids
  kSimplePinhole = 0,
  kPinhole = 1,
  kSimpleRadial = 2,
  kRadial = 3,
  kOpenCv = 4,
  kOpenCvFisheye = 5,
  kFullOpenCv = 6,
  kFov = 7,
  kSimpleRadialFisheye = 8,
  kRadialFisheye = 9,
  kThinPrismFisheye = 10,
};

/// "OPENCV" etc.; nullopt for an unknown name or id.
std::optional<CameraModel> CameraModelFromName(std::string_view name);
std::optional<CameraModel> CameraModelFromId(int id);
std::string_view CameraModelName(CameraModel model);
int CameraModelParameterCount(CameraModel model);

/// The map of a camera from rays to pixels, as COLMAP stores it. distortion_models.h projects with it.
struct Intrinsics {
  CameraModel model = CameraModel::kPinhole;
  int width = 0, height = 0;   ///< pixels
  std::vector<double> params;  ///< CameraModelParameterCount(model) numbers in COLMAP's order

  double fx() const;
  double fy() const;
  double cx() const;
  double cy() const;
  /// True when every distortion coefficient is zero (a fisheye model never is).
  bool IsPinhole() const;
  /// Throws InputError "NAME: ..." for a wrong count, a number that is not finite, or a size or focal length <= 0.
  void Check(const std::string& name) const;
};

/// A camera on an image of another size, in pixels. The axes may scale differently, so a model of one focal length
/// becomes the one of two that takes the same coefficients.
Intrinsics Resized(const Intrinsics& intrinsics, int width, int height);

}  // namespace oraclegs
