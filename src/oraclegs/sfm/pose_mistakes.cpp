#include "oraclegs/sfm/pose_mistakes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace oraclegs {
namespace {

constexpr double kAlike = .02;         // shares that differ by less say nothing
constexpr double kLargestFactor = 4;   // of the focal length
constexpr int kFactorSteps = 48;       // from 1 to that: 3 % each
constexpr int kRefinements = 12;       // of the best of them
constexpr size_t kMatchesOfPair = 60;  // are enough to tell one change from another

Eigen::Matrix3d Axes(const std::array<int, 3>& order, int signs) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  for (int row = 0; row < 3; ++row) axes(row, order[static_cast<size_t>(row)]) = (signs >> row & 1) != 0 ? -1 : 1;
  return axes;
}

/// All changes of axes and direction, the usual ones first.
std::vector<CameraChange> AxisChanges() {
  std::vector<CameraChange> changes;
  const auto add = [&](const Eigen::Matrix3d& axes, bool inverse) {
    const bool is_known = std::any_of(changes.begin(), changes.end(), [&](const CameraChange& known) {
      return known.inverse == inverse && known.axes == axes;
    });
    if (!is_known) changes.push_back({axes, inverse});
  };
  const std::array<int, 3> same{0, 1, 2}, turned{1, 0, 2};
  add(Axes(same, 0), false);
  add(Axes(same, 0b110), false);  // between OpenGL and OpenCV
  add(Axes(same, 0), true);
  add(Axes(same, 0b110), true);
  add(Axes(turned, 0b001), false);  // pixels turned by 90 degrees
  add(Axes(turned, 0b010), false);
  for (const int signs : {0b011, 0b001, 0b010}) {  // turned by 180, mirrored
    add(Axes(same, signs), false);
    changes.push_back({Axes(same, signs), false, 1, false, true});
  }
  add(Axes(same, 0b100), false);
  std::array<int, 3> order = same;
  do {
    for (int signs = 0; signs < 8; ++signs) {
      for (const bool inverse : {false, true}) add(Axes(order, signs), inverse);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return changes;
}

/// The errors of all matches, in pixels of kReferenceSide.
std::vector<double> ErrorsOf(const std::vector<RayPair>& pairs, const std::vector<Eigen::Isometry3d>& cams_from_world) {
  const double extent = ExtentOf(cams_from_world);
  std::vector<double> errors;
  for (const RayPair& pair : pairs) {
    AppendErrors(pair,
                 MotionBetween(cams_from_world[static_cast<size_t>(pair.a)],
                               cams_from_world[static_cast<size_t>(pair.b)], extent),
                 &errors);
  }
  return errors;
}

/// The mean error of all matches, an outlier counting as the limit: smooth, to refine by.
double BoundedError(const std::vector<RayPair>& pairs, const std::vector<Eigen::Isometry3d>& cams_from_world,
                    double limit) {
  const std::vector<double> errors = ErrorsOf(pairs, cams_from_world);
  double sum = 0;
  for (const double error : errors) sum += std::min(error, limit);
  return errors.empty() ? limit : sum / static_cast<double>(errors.size());
}

/// Mirrors a camera of two focal lengths along the axis x (0) or y (1), on which the image has `size` pixels.
void Mirror(int size, size_t axis, Intrinsics* camera) {
  std::vector<double>& params = camera->params;
  params[2 + axis] = size - params[2 + axis];
  const bool is_thin_prism = camera->model == CameraModel::kThinPrismFisheye;
  const bool is_tangential =
      is_thin_prism || camera->model == CameraModel::kOpenCv || camera->model == CameraModel::kFullOpenCv;
  if (is_tangential) params[7 - axis] *= -1;  // p1 and p2: p2 is odd in x
  if (is_thin_prism) params[10 + axis] *= -1;
}

std::vector<Intrinsics> AllChanged(const std::vector<Intrinsics>& intrinsics, const CameraChange& change) {
  std::vector<Intrinsics> changed;
  for (const Intrinsics& camera : intrinsics) changed.push_back(Changed(camera, change));
  return changed;
}

/// Which photos stand upside down: each is turned while that makes more matches fit.
class TurnSearch {
 public:
  explicit TurnSearch(const GivenCameras& given) : views_(given.cams_from_world.size()) {
    const double extent = ExtentOf(given.cams_from_world);
    const CameraChange half_turn{Axes({0, 1, 2}, 0b011), false, 1, false, true};
    const auto seen_by = [&](size_t view, bool turns) {
      return turns ? Changed(given.intrinsics[view], half_turn) : given.intrinsics[view];
    };
    const auto pose_of = [&](size_t view, bool turns) {
      Eigen::Isometry3d pose = given.cams_from_world[view];
      if (turns) pose.prerotate(half_turn.axes);
      return pose;
    };
    for (const ViewPair& pair : Thinned(given.pairs, kMatchesOfPair)) {
      Fits fits{static_cast<size_t>(pair.a), static_cast<size_t>(pair.b), static_cast<double>(pair.matches.size()), {}};
      for (size_t turned = 0; turned < 4; ++turned) {
        const bool turns_a = (turned & 1) != 0, turns_b = (turned & 2) != 0;
        const auto rays = RaysOf({{0, 1, pair.matches}}, {seen_by(fits.a, turns_a), seen_by(fits.b, turns_b)});
        std::vector<double> errors;
        AppendErrors(rays.front(), MotionBetween(pose_of(fits.a, turns_a), pose_of(fits.b, turns_b), extent), &errors);
        fits.fits[turned] = ShareBelow(errors, given.limit) * fits.matches;
      }
      pairs_.push_back(fits);
    }
  }

  /// From the photos as they are, and from all of them turned.
  std::vector<bool> Best() const {
    std::vector<bool> best = Improved(std::vector<bool>(views_, false));
    const std::vector<bool> other = Improved(std::vector<bool>(views_, true));
    return FitsOf(other, kAll) > FitsOf(best, kAll) ? other : best;
  }

  double ShareOf(const std::vector<bool>& turned, size_t view) const {
    double matches = 0;
    for (const Fits& pair : pairs_) {
      if (view == kAll || pair.a == view || pair.b == view) matches += pair.matches;
    }
    return matches > 0 ? FitsOf(turned, view) / matches : 0;
  }

  static constexpr size_t kAll = std::numeric_limits<size_t>::max();

 private:
  struct Fits {
    size_t a, b;
    double matches;
    std::array<double, 4> fits;  ///< as they are, a turned, b turned, both turned
  };

  double FitsOf(const std::vector<bool>& turned, size_t view) const {
    double fits = 0;
    for (const Fits& pair : pairs_) {
      if (view != kAll && pair.a != view && pair.b != view) continue;
      fits += pair.fits[(turned[pair.a] ? 1 : 0) + (turned[pair.b] ? 2 : 0)];
    }
    return fits;
  }

  std::vector<bool> Improved(std::vector<bool> turned) const {
    for (bool is_better = true; is_better;) {
      is_better = false;
      for (size_t view = 0; view < views_; ++view) {
        const double before = FitsOf(turned, view);
        turned[view] = !turned[view];
        if (FitsOf(turned, view) > before) {
          is_better = true;
        } else {
          turned[view] = !turned[view];
        }
      }
    }
    return turned;
  }

  size_t views_;
  std::vector<Fits> pairs_;
};

class FocalSearch {
 public:
  FocalSearch(const GivenCameras& given, bool is_other_resolution)
      : given_(given), pairs_(Thinned(given.pairs, kMatchesOfPair)), is_other_resolution_(is_other_resolution) {}

  ChangeFit Best() const {
    double best = 0, least = ErrorAt(0);
    const double step = std::log(kLargestFactor) / kFactorSteps;
    for (int i = -kFactorSteps; i <= kFactorSteps; ++i) {
      const double error = ErrorAt(i * step);
      if (error < least) least = error, best = i * step;
    }
    double width = step;
    for (int i = 0; i < kRefinements; ++i, width *= .6) {
      for (const double other : {best - width, best + width}) {
        const double error = ErrorAt(other);
        if (error < least) least = error, best = other;
      }
    }
    const CameraChange change = At(best);
    return {change,
            FittingShare(RaysOf(pairs_, AllChanged(given_.intrinsics, change)), given_.cams_from_world, given_.limit)};
  }

 private:
  CameraChange At(double log_factor) const {
    return {Eigen::Matrix3d::Identity(), false, std::exp(log_factor), is_other_resolution_};
  }
  double ErrorAt(double log_factor) const {
    const auto rays = RaysOf(pairs_, AllChanged(given_.intrinsics, At(log_factor)));
    return BoundedError(rays, given_.cams_from_world, 3 * given_.limit);
  }

  const GivenCameras& given_;
  std::vector<ViewPair> pairs_;
  bool is_other_resolution_;
};

}  // namespace

std::vector<Eigen::Isometry3d> Changed(const std::vector<Eigen::Isometry3d>& cams_from_world,
                                       const CameraChange& change) {
  std::vector<Eigen::Isometry3d> changed;
  for (const Eigen::Isometry3d& given : cams_from_world) {
    const Eigen::Isometry3d cam_from_world =
        change.inverse ? (given * Eigen::Translation3d(change.origin)).inverse() : given;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() =
        change.axes * cam_from_world.linear() * change.axes.transpose();  // a rotation where axes mirror, too
    pose.translation() = change.axes * cam_from_world.translation();
    changed.push_back(pose);
  }
  return changed;
}

Intrinsics Changed(const Intrinsics& intrinsics, const CameraChange& change) {
  Intrinsics changed =
      Resized(intrinsics, intrinsics.width, intrinsics.height);  // of two focal lengths: fx, fy, cx, cy
  for (size_t i = 0; i < (change.is_other_resolution ? 4 : 2); ++i) changed.params[i] *= change.focal_factor;
  if (change.is_of_pixels && change.axes(0, 0) < 0) Mirror(changed.width, 0, &changed);
  if (change.is_of_pixels && change.axes(1, 1) < 0) Mirror(changed.height, 1, &changed);
  return changed;
}

double FittingShare(const std::vector<RayPair>& pairs, const std::vector<Eigen::Isometry3d>& cams_from_world,
                    double limit) {
  return ShareBelow(ErrorsOf(pairs, cams_from_world), limit);
}

ChangeFit BestAxes(const GivenCameras& given) {
  const std::vector<ViewPair> pairs = Thinned(given.pairs, kMatchesOfPair);
  const std::vector<RayPair> rays = RaysOf(pairs, given.intrinsics);
  ChangeFit best;
  best.share = -kAlike;
  for (CameraChange change : AxisChanges()) {
    if (change.inverse) change.origin = given.origin;
    const double share = FittingShare(change.is_of_pixels ? RaysOf(pairs, AllChanged(given.intrinsics, change)) : rays,
                                      Changed(given.cams_from_world, change), given.limit);
    if (share > best.share + kAlike) best = {change, share};
  }
  return best;
}

ChangeFit BestFocal(const GivenCameras& given) {
  const ChangeFit alone = FocalSearch(given, false).Best(), whole = FocalSearch(given, true).Best();
  return whole.share > alone.share + kAlike ? whole : alone;
}

TurnedViews FindTurnedViews(const GivenCameras& given) {
  constexpr double kMaxShareAsGiven = .2, kMinShareTurned = .6;
  const TurnSearch search(given);
  const std::vector<bool> best = search.Best(), as_given(best.size(), false);
  TurnedViews turned{{}, search.ShareOf(best, TurnSearch::kAll)};
  for (size_t view = 0; view < best.size(); ++view) {
    if (!best[view] || search.ShareOf(best, view) < kMinShareTurned) continue;
    if (search.ShareOf(as_given, view) < kMaxShareAsGiven) turned.views.push_back(static_cast<int>(view));
  }
  return turned;
}

}  // namespace oraclegs
