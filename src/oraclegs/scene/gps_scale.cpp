#include "oraclegs/scene/gps_scale.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace oraclegs {
namespace {

constexpr size_t kMinPositions = 5;
constexpr double kMinSpread = 10;   // meters, root mean square from the middle
constexpr double kMaxError = 0.03;  // of the scale
constexpr double kMinWidth = 0.1;   // of the places, to their length
constexpr double kEquatorRadius = 6378137, kSquaredEccentricity = 6.69437999014e-3;  // WGS 84

using Place = std::complex<double>;  // on the ground

/// Meters east and north of `origin`; exact to a millionth over some kilometers.
Place OnGround(const GpsPosition& position, const GpsPosition& origin) {
  constexpr double kDegree = std::numbers::pi / 180;
  const double sine = std::sin(origin.latitude * kDegree);
  const double squeeze = 1 - kSquaredEccentricity * sine * sine;
  const double across = kEquatorRadius / std::sqrt(squeeze);  // radius of curvature from east to west
  const double along = across * (1 - kSquaredEccentricity) / squeeze;
  const double east = std::remainder(position.longitude - origin.longitude, 360);
  return {across * std::cos(origin.latitude * kDegree) * east * kDegree,
          along * (position.latitude - origin.latitude) * kDegree};
}

void Center(std::vector<Place>* places) {
  Place mean = 0;
  for (const Place& place : *places) mean += place / static_cast<double>(places->size());
  for (Place& place : *places) place -= mean;
}

double SumOfSquares(const std::vector<Place>& places) {
  double sum = 0;
  for (const Place& place : places) sum += std::norm(place);
  return sum;
}

}  // namespace

std::optional<GpsScale> UnitMetersByGps(const Scene& scene) {
  std::vector<Place> places, positions;  // of the cameras, by GPS
  const GpsPosition* origin = nullptr;
  for (const SceneView& view : scene.views) {
    if (!view.gps || !view.cam_from_world) continue;
    if (origin == nullptr) origin = &*view.gps;
    const Eigen::Vector3d center = view.cam_from_world->inverse(Eigen::Isometry).translation();
    places.emplace_back(center.x(), center.z());  // seen from above (from -y) z is left of x, as north is of east
    positions.push_back(OnGround(*view.gps, *origin));
  }
  const size_t n = places.size();
  if (n < kMinPositions) return std::nullopt;
  Center(&places);
  Center(&positions);
  const double spread = SumOfSquares(positions), units = SumOfSquares(places);
  if (!(spread >= static_cast<double>(n) * kMinSpread * kMinSpread) || !(units > 0)) return std::nullopt;
  Place factor = 0;  // a scale and a turn
  for (size_t i = 0; i < n; ++i) factor += std::conj(places[i]) * positions[i] / units;
  std::vector<Place> residuals;
  for (size_t i = 0; i < n; ++i) residuals.push_back(positions[i] - factor * places[i]);
  const double freedom = 2 * static_cast<double>(n) - 4;  // two numbers a place, less those of the similarity
  const double scale = std::abs(factor);
  const double error = std::sqrt(SumOfSquares(residuals) / freedom / units) / scale;
  if (!(error <= kMaxError)) return std::nullopt;
  return GpsScale{scale, error, static_cast<int>(n)};
}

std::optional<Eigen::Vector3d> UpByGps(const Scene& scene) {
  std::vector<Eigen::Vector3d> places, positions;
  const GpsPosition* origin = nullptr;
  for (const SceneView& view : scene.views) {
    if (!view.gps || !view.gps->altitude || !view.cam_from_world) continue;
    if (origin == nullptr) origin = &*view.gps;
    const Place ground = OnGround(*view.gps, *origin);
    places.push_back(view.cam_from_world->inverse(Eigen::Isometry).translation());
    positions.emplace_back(ground.real(), ground.imag(), *view.gps->altitude - *origin->altitude);
  }
  const auto n = static_cast<Eigen::Index>(places.size());
  if (places.size() < kMinPositions) return std::nullopt;
  Eigen::Matrix3Xd from(3, n), to(3, n);
  for (Eigen::Index i = 0; i < n; ++i)
    from.col(i) = places[static_cast<size_t>(i)], to.col(i) = positions[static_cast<size_t>(i)];
  from.colwise() -= from.rowwise().mean().eval();
  to.colwise() -= to.rowwise().mean().eval();
  const auto count = static_cast<double>(n);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(Eigen::Matrix3d(to * to.transpose()),
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& axes = spread.eigenvalues();  // squared lengths, ascending
  if (!(axes.sum() >= count * kMinSpread * kMinSpread) || axes[1] < kMinWidth * kMinWidth * axes[2])
    return std::nullopt;
  const Eigen::Matrix4d fit = Eigen::umeyama(from, to);
  const Eigen::Matrix3d turn = fit.topLeftCorner<3, 3>();
  const double scale = std::cbrt(turn.determinant());
  const double freedom = 3 * count - 7;
  const double error = (to - turn * from).norm() / std::sqrt(freedom) / (scale * from.norm());
  if (!(error <= kMaxError)) return std::nullopt;
  return Eigen::Vector3d(turn.row(2).transpose() / scale);
}

}  // namespace oraclegs
