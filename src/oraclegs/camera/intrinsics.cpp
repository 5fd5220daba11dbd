#include "oraclegs/camera/intrinsics.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

struct ModelFacts {
  std::string_view name;
  int parameters;
  int focal_lengths;  ///< 1: f, cx, cy, ...; 2: fx, fy, cx, cy, ...
  bool distorts;      ///< even when all that follows the principal point is zero
};

constexpr std::array<ModelFacts, 11> kModels{{
    {"SIMPLE_PINHOLE", 3, 1, false},
    {"PINHOLE", 4, 2, false},
    {"SIMPLE_RADIAL", 4, 1, false},
    {"RADIAL", 5, 1, false},
    {"OPENCV", 8, 2, false},
    {"OPENCV_FISHEYE", 8, 2, true},
    {"FULL_OPENCV", 12, 2, false},
    {"FOV", 5, 2, false},
    {"SIMPLE_RADIAL_FISHEYE", 4, 1, true},
    {"RADIAL_FISHEYE", 5, 1, true},
    {"THIN_PRISM_FISHEYE", 12, 2, true},
}};

const ModelFacts& FactsOf(CameraModel model) { return kModels[static_cast<size_t>(model)]; }

/// The model of two focal lengths that takes the same coefficients.
CameraModel WithTwoFocalLengths(CameraModel model) {
  switch (model) {
    case CameraModel::kSimplePinhole:
      return CameraModel::kPinhole;
    case CameraModel::kSimpleRadial:
    case CameraModel::kRadial:
      return CameraModel::kOpenCv;
    case CameraModel::kSimpleRadialFisheye:
    case CameraModel::kRadialFisheye:
      return CameraModel::kOpenCvFisheye;
    default:
      return model;
  }
}

}  // namespace

std::optional<CameraModel> CameraModelFromName(std::string_view name) {
  for (size_t i = 0; i < kModels.size(); ++i) {
    if (kModels[i].name == name) return static_cast<CameraModel>(i);
  }
  return std::nullopt;
}

std::optional<CameraModel> CameraModelFromId(int id) {
  if (id < 0 || id >= static_cast<int>(kModels.size())) return std::nullopt;
  return static_cast<CameraModel>(id);
}

std::string_view CameraModelName(CameraModel model) { return FactsOf(model).name; }
int CameraModelParameterCount(CameraModel model) { return FactsOf(model).parameters; }

double Intrinsics::fx() const { return params[0]; }
double Intrinsics::fy() const { return params[FactsOf(model).focal_lengths == 1 ? 0 : 1]; }
double Intrinsics::cx() const { return params[static_cast<size_t>(FactsOf(model).focal_lengths)]; }
double Intrinsics::cy() const { return params[static_cast<size_t>(FactsOf(model).focal_lengths) + 1]; }

bool Intrinsics::IsPinhole() const {
  if (FactsOf(model).distorts) return false;
  return std::all_of(params.begin() + FactsOf(model).focal_lengths + 2, params.end(), [](double x) { return x == 0; });
}

void Intrinsics::Check(const std::string& name) const {
  const auto& facts = FactsOf(model);
  if (params.size() != static_cast<size_t>(facts.parameters)) {
    throw InputError("{}: camera model {} has {} parameters, found {}", name, facts.name, facts.parameters,
                     params.size());
  }
  if (!std::all_of(params.begin(), params.end(), [](double x) { return std::isfinite(x); })) {
    throw InputError("{}: a parameter of camera model {} is not finite", name, facts.name);
  }
  if (width <= 0 || height <= 0)
    throw InputError("{}: the image size is {} x {}, must be positive", name, width, height);
  if (fx() <= 0 || fy() <= 0) {
    throw InputError("{}: the focal length is {} x {} pixels, must be positive", name, fx(), fy());
  }
}

Intrinsics Resized(const Intrinsics& intrinsics, int width, int height) {
  const auto& facts = FactsOf(intrinsics.model);
  Intrinsics resized;
  resized.model = WithTwoFocalLengths(intrinsics.model);
  resized.width = width;
  resized.height = height;
  const double sx = static_cast<double>(width) / intrinsics.width;
  const double sy = static_cast<double>(height) / intrinsics.height;
  resized.params = {intrinsics.fx() * sx, intrinsics.fy() * sy, intrinsics.cx() * sx, intrinsics.cy() * sy};
  resized.params.insert(resized.params.end(), intrinsics.params.begin() + facts.focal_lengths + 2,
                        intrinsics.params.end());
  resized.params.resize(static_cast<size_t>(CameraModelParameterCount(resized.model)), 0.);
  return resized;
}

}  // namespace oraclegs
