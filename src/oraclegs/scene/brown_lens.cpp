#include "oraclegs/scene/brown_lens.h"

#include "oraclegs/core/error.h"

namespace oraclegs {

Intrinsics IntrinsicsOf(const BrownLens& lens, const std::string& place) {
  const auto& [k1, k2, k3, k4] = lens.k;
  const bool is_tangential = lens.p1 != 0 || lens.p2 != 0;
  Intrinsics intrinsics{CameraModel::kPinhole, lens.width, lens.height, {lens.fx, lens.fy, lens.cx, lens.cy}};
  const auto with = [&](CameraModel model, std::initializer_list<double> coefficients) {
    intrinsics.model = model;
    intrinsics.params.insert(intrinsics.params.end(), coefficients);
  };
  if (lens.fisheye && is_tangential) {
    with(CameraModel::kThinPrismFisheye, {k1, k2, lens.p1, lens.p2, k3, k4, 0, 0});
  } else if (lens.fisheye) {
    with(CameraModel::kOpenCvFisheye, {k1, k2, k3, k4});
  } else if (k4 != 0) {
    throw InputError("{}: \"k4\" of a camera that is no fisheye cannot be undistorted; set it to 0", place);
  } else if (k3 != 0) {
    with(CameraModel::kFullOpenCv, {k1, k2, lens.p1, lens.p2, k3, 0, 0, 0});
  } else if (k1 != 0 || k2 != 0 || is_tangential) {
    with(CameraModel::kOpenCv, {k1, k2, lens.p1, lens.p2});
  }
  intrinsics.Check(place);
  return intrinsics;
}

}  // namespace oraclegs
