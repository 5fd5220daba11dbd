#include "oraclegs/render/splat_camera.h"

#include "oraclegs/render/constants.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

template <class F>
SplatCamera<F> MakeSplatCamera(const Camera& camera, const RenderOptions& options) {
  SplatCamera<F> out{};
  const Eigen::Matrix3d r = camera.cam_from_world.linear();
  const Eigen::Vector3d t = camera.cam_from_world.translation(), eye = camera.Center();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.r[3 * i + j] = static_cast<F>(r(i, j));
    out.t[i] = static_cast<F>(t[i]);
    out.eye[i] = static_cast<F>(eye[i]);
    out.background[i] = static_cast<F>(options.background[static_cast<size_t>(i)]);
  }
  out.fx = static_cast<F>(camera.fx), out.fy = static_cast<F>(camera.fy);
  out.cx = static_cast<F>(camera.cx), out.cy = static_cast<F>(camera.cy);
  const double margin_u = kFrustumMargin * camera.width / (2 * camera.fx);
  const double margin_v = kFrustumMargin * camera.height / (2 * camera.fy);
  out.min_u = static_cast<F>(-camera.cx / camera.fx - margin_u);
  out.max_u = static_cast<F>((camera.width - camera.cx) / camera.fx + margin_u);
  out.min_v = static_cast<F>(-camera.cy / camera.fy - margin_v);
  out.max_v = static_cast<F>((camera.height - camera.cy) / camera.fy + margin_v);
  out.width = camera.width, out.height = camera.height;
  out.tiles_x = (camera.width + kTile - 1) / kTile;
  out.tiles_y = (camera.height + kTile - 1) / kTile;
  out.sh_degree = options.sh_degree;
  out.antialiased = options.antialiased;
  return out;
}

template SplatCamera<float> MakeSplatCamera(const Camera&, const RenderOptions&);
template SplatCamera<double> MakeSplatCamera(const Camera&, const RenderOptions&);

CameraGradient CameraGradientOf(const SplatCamera<float>& camera, const double* sums) {
  const auto rotation = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(camera.r).cast<double>();
  const Eigen::Map<const Eigen::Vector3d> means(sums), turns(sums + 3);
  return {rotation * means, turns, sums[6], sums[7], sums[8], sums[9]};
}

}  // namespace oraclegs
