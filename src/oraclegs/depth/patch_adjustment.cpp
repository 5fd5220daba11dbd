#include "oraclegs/depth/patch_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr int kAdjustSteps = 8;  // of Levenberg and Marquardt
constexpr double kFirstDamping = 1e-4, kMaxDamping = 1e4;
constexpr double kSettledChange = 1e-4;           // of the sum of squares, relative
constexpr double kOffsetSigma = 0.25;             // pixels: of an offset
constexpr double kOffsetsAsOne = 50;              // neighbors err alike: this many weigh like one
constexpr double kInvDepthSigma = 0.25;           // relative step of an inverse depth
constexpr double kMinHuber = 0.1, kMaxHuber = 2;  // pixels: bounds of Huber's threshold, the median |across|
constexpr double kTurnSigma = 0.3 * M_PI / 180, kShiftSigma = 0.01;  // of given poses: radians, shares of the extent
constexpr double kMaxDepthStep = 0.2;                                // relative

/// One offset, linearized: residual in pixels, expected minus found.
struct OffsetTerm {
  size_t slot = 0;  ///< of the source view in the system of the pixel's view
  Eigen::Vector2d residual;
  Reprojection at;
  double weight = 0;
};

/// Normal equations of a view's pixels, inverse depths eliminated: the view, then its source views. Only the lower
/// triangle of `matrix` is meaningful.
struct LocalSystem {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
};

/// A pixel's own part of them.
struct DepthSystem {
  Eigen::VectorXd cross;  ///< between the local unknowns and the inverse depth
  double square = 0, gradient = 0;
};

class Adjustment {
 public:
  Adjustment(const std::vector<PatchOffset>& offsets, const std::vector<Camera>& given, const AdjustedScene& scene)
      : offsets_(offsets), given_(given), extent_(SpatialExtent(given)), slots_(given.size()) {
    first_pixel_.assign(given.size() + 1, scene.pixels.size());
    for (size_t p = scene.pixels.size(); p-- > 0;) first_pixel_[static_cast<size_t>(scene.pixels[p].view)] = p;
    for (size_t v = given.size(); v-- > 0;) first_pixel_[v] = std::min(first_pixel_[v], first_pixel_[v + 1]);
    first_offset_.assign(scene.pixels.size() + 1, offsets.size());
    for (size_t k = offsets.size(); k-- > 0;) first_offset_[static_cast<size_t>(offsets[k].pixel)] = k;
    for (size_t p = scene.pixels.size(); p-- > 0;) first_offset_[p] = std::min(first_offset_[p], first_offset_[p + 1]);
    std::vector<double> across;
    for (const PatchOffset& offset : offsets) {
      across.push_back(std::abs(offset.across));
      std::vector<int>& slots = slots_[static_cast<size_t>(scene.pixels[static_cast<size_t>(offset.pixel)].view)];
      if (std::find(slots.begin(), slots.end(), offset.source) == slots.end()) slots.push_back(offset.source);
    }
    huber_ = std::clamp(Median(&across), kMinHuber, kMaxHuber);
    FindBaseline();
  }

  void Run(AdjustedScene* scene) const {
    if (!(baseline_ > 0) || offsets_.empty()) return;
    double damping = kFirstDamping, cost = CostOf(*scene);
    for (int step = 0; step < kAdjustSteps; ++step) {
      const auto [matrix, gradient] = SystemOf(*scene);
      bool better = false;
      double change = 0;
      for (; !better && damping < kMaxDamping; damping *= 10) {
        Eigen::MatrixXd damped = matrix;
        damped.diagonal() *= 1 + damping;
        AdjustedScene trial = After(*scene, -damped.ldlt().solve(gradient));
        const double trial_cost = CostOf(trial);
        if (!(trial_cost < cost)) continue;
        better = true;
        change = (cost - trial_cost) / cost;
        cost = trial_cost;
        *scene = std::move(trial);
        damping = std::max(1e-9, damping / 100);
      }
      if (!better || change < kSettledChange) return;
    }
  }

 private:
  size_t views() const { return given_.size(); }
  Eigen::Index Unknowns() const { return static_cast<Eigen::Index>(6 * (views() - 1)); }
  /// Place of a view's twist among the unknowns; nothing for the first camera.
  static std::optional<Eigen::Index> PlaceOf(size_t view) {
    if (view == 0) return std::nullopt;
    return static_cast<Eigen::Index>(6 * (view - 1));
  }

  void FindBaseline() {
    for (size_t a = 0; a < views(); ++a) {
      for (size_t b = a + 1; b < views(); ++b) {
        const double length = (given_[a].Center() - given_[b].Center()).norm();
        if (length > baseline_) baseline_ = length, ends_ = {a, b};
      }
    }
  }

  Eigen::Vector2d Found(const PatchOffset& offset) const { return offset.expected + offset.offset; }

  /// The pixel's offsets in a scene; those behind a camera are left out.
  std::vector<OffsetTerm> TermsOf(const AdjustedScene& scene, size_t p) const {
    std::vector<OffsetTerm> terms;
    const OffsetPixel& pixel = scene.pixels[p];
    const auto v = static_cast<size_t>(pixel.view);
    for (size_t k = first_offset_[p]; k < first_offset_[p + 1]; ++k) {
      const auto source = static_cast<size_t>(offsets_[k].source);
      const auto at = Reproject(scene.cameras[v], scene.cameras[source], {pixel.u, pixel.v, pixel.inv_depth});
      if (!at) continue;
      const auto slot = std::find(slots_[v].begin(), slots_[v].end(), offsets_[k].source) - slots_[v].begin();
      const Eigen::Vector2d residual = at->at - Found(offsets_[k]);
      const double weight = std::min(1.0, huber_ / std::max(1e-12, residual.norm()));
      terms.push_back(
          {static_cast<size_t>(slot), residual, *at, weight / (kOffsetsAsOne * kOffsetSigma * kOffsetSigma)});
    }
    return terms;
  }

  double CostOf(const AdjustedScene& scene) const {
    std::vector<double> costs(views(), 0);
    ParallelFor(static_cast<int64_t>(views()), [&](int64_t view) {
      const auto v = static_cast<size_t>(view);
      for (size_t p = first_pixel_[v]; p < first_pixel_[v + 1]; ++p) {
        for (size_t k = first_offset_[p]; k < first_offset_[p + 1]; ++k) {
          const OffsetPixel& pixel = scene.pixels[p];
          const auto at = Reproject(scene.cameras[v], scene.cameras[static_cast<size_t>(offsets_[k].source)],
                                    {pixel.u, pixel.v, pixel.inv_depth});
          const double r = at ? (at->at - Found(offsets_[k])).norm() : 1e3;
          costs[v] += r < huber_ ? r * r / 2 : huber_ * (r - huber_ / 2);
        }
      }
      costs[v] /= kOffsetsAsOne * kOffsetSigma * kOffsetSigma;
      costs[v] += PriorOf(scene, v).cwiseProduct(PriorWeights()).dot(PriorOf(scene, v)) / 2;
    });
    return std::accumulate(costs.begin(), costs.end(), 0.0);
  }

  Twist PriorOf(const AdjustedScene& scene, size_t v) const { return TwistBetween(given_[v], scene.cameras[v]); }
  Twist PriorWeights() const {
    const double shift = kShiftSigma * extent_;
    Twist weights;
    weights << Eigen::Vector3d::Constant(1 / (shift * shift)), Eigen::Vector3d::Constant(1 / (kTurnSigma * kTurnSigma));
    return weights;
  }

  DepthSystem DepthSystemOf(const std::vector<OffsetTerm>& terms, double inv_depth, Eigen::Index size) const {
    DepthSystem depth{Eigen::VectorXd::Zero(size), 1 / std::pow(kInvDepthSigma * inv_depth, 2), 0};
    for (const OffsetTerm& term : terms) {
      const Eigen::Vector2d by_depth = term.weight * term.at.by_inv_depth;
      depth.square += by_depth.dot(term.at.by_inv_depth);
      depth.gradient += by_depth.dot(term.residual);
      depth.cross.head<6>() += term.at.by_view.transpose() * by_depth;
      depth.cross.segment<6>(static_cast<Eigen::Index>(6 * (term.slot + 1))) += term.at.by_other.transpose() * by_depth;
    }
    return depth;
  }

  Eigen::Index LocalSize(size_t v) const { return static_cast<Eigen::Index>(6 * (slots_[v].size() + 1)); }

  LocalSystem LocalSystemOf(const AdjustedScene& scene, size_t v) const {
    const Eigen::Index size = LocalSize(v);
    LocalSystem local{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
    for (size_t p = first_pixel_[v]; p < first_pixel_[v + 1]; ++p) {
      const std::vector<OffsetTerm> terms = TermsOf(scene, p);
      for (const OffsetTerm& term : terms) {
        const auto place = static_cast<Eigen::Index>(6 * (term.slot + 1));
        const Eigen::Matrix<double, 6, 2> view = term.weight * term.at.by_view.transpose(),
                                          other = term.weight * term.at.by_other.transpose();
        local.matrix.topLeftCorner<6, 6>() += view * term.at.by_view;
        local.matrix.block<6, 6>(place, 0) += other * term.at.by_view;
        local.matrix.block<6, 6>(place, place) += other * term.at.by_other;
        local.gradient.head<6>() += view * term.residual;
        local.gradient.segment<6>(place) += other * term.residual;
      }
      if (terms.empty()) continue;
      const DepthSystem depth = DepthSystemOf(terms, scene.pixels[p].inv_depth, size);
      local.matrix.selfadjointView<Eigen::Lower>().rankUpdate(depth.cross, -1 / depth.square);
      local.gradient -= depth.cross * (depth.gradient / depth.square);
    }
    return local;
  }

  /// Place of each local unknown among all; -1 where it is held.
  std::vector<Eigen::Index> PlacesOf(size_t v) const {
    std::vector<Eigen::Index> places(static_cast<size_t>(LocalSize(v)), -1);
    for (size_t slot = 0; slot <= slots_[v].size(); ++slot) {
      const auto first = PlaceOf(slot == 0 ? v : static_cast<size_t>(slots_[v][slot - 1]));
      for (size_t k = 0; first && k < 6; ++k) places[6 * slot + k] = *first + static_cast<Eigen::Index>(k);
    }
    return places;
  }

  /// Matrix and gradient of all unknowns, with priors and the gauge.
  std::pair<Eigen::MatrixXd, Eigen::VectorXd> SystemOf(const AdjustedScene& scene) const {
    std::vector<LocalSystem> locals(views());
    ParallelFor(static_cast<int64_t>(views()),
                [&](int64_t v) { locals[static_cast<size_t>(v)] = LocalSystemOf(scene, static_cast<size_t>(v)); });
    const Eigen::Index n = Unknowns();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    for (size_t v = 0; v < views(); ++v) {
      const std::vector<Eigen::Index> places = PlacesOf(v);
      for (size_t i = 0; i < places.size(); ++i) {
        if (places[i] < 0) continue;
        const auto row = static_cast<Eigen::Index>(i);
        gradient[places[i]] += locals[v].gradient[row];
        for (size_t j = 0; j <= i; ++j) {
          if (places[j] < 0) continue;
          const double value = locals[v].matrix(row, static_cast<Eigen::Index>(j));
          matrix(places[i], places[j]) += value;
          if (i != j) matrix(places[j], places[i]) += value;
        }
      }
      if (const auto place = PlaceOf(v)) {
        matrix.diagonal().segment<6>(*place) += PriorWeights();
        gradient.segment<6>(*place) += PriorWeights().cwiseProduct(PriorOf(scene, v));
      }
    }
    // A step that would change the baseline is as expensive as any: the scale is free, so it costs the rest nothing.
    const Eigen::VectorXd stretch = StretchOf(scene);
    matrix += matrix.diagonal().maxCoeff() / std::max(1e-300, stretch.squaredNorm()) * stretch * stretch.transpose();
    return {matrix, gradient};
  }

  /// Derivative of the baseline's length.
  Eigen::VectorXd StretchOf(const AdjustedScene& scene) const {
    Eigen::VectorXd stretch = Eigen::VectorXd::Zero(Unknowns());
    const Camera &a = scene.cameras[ends_.first], &b = scene.cameras[ends_.second];
    const Eigen::Vector3d along = (a.Center() - b.Center()).normalized();
    if (const auto place = PlaceOf(ends_.first)) stretch.segment<3>(*place) = -(a.cam_from_world.linear() * along);
    if (const auto place = PlaceOf(ends_.second)) stretch.segment<3>(*place) = b.cam_from_world.linear() * along;
    return stretch;
  }

  AdjustedScene After(const AdjustedScene& scene, const Eigen::VectorXd& step) const {
    AdjustedScene next = scene;
    ParallelFor(static_cast<int64_t>(views()), [&](int64_t view) {
      const auto v = static_cast<size_t>(view);
      const std::vector<Eigen::Index> places = PlacesOf(v);
      Eigen::VectorXd local(LocalSize(v));
      for (size_t i = 0; i < places.size(); ++i)
        local[static_cast<Eigen::Index>(i)] = places[i] < 0 ? 0 : step[places[i]];
      for (size_t p = first_pixel_[v]; p < first_pixel_[v + 1]; ++p) {
        const std::vector<OffsetTerm> terms = TermsOf(scene, p);
        if (terms.empty()) continue;
        double& inv_depth = next.pixels[p].inv_depth;
        const DepthSystem depth = DepthSystemOf(terms, inv_depth, local.size());
        const double change = -(depth.gradient + depth.cross.dot(local)) / depth.square;
        inv_depth += std::clamp(change, -kMaxDepthStep * inv_depth, kMaxDepthStep * inv_depth);
      }
    });
    for (size_t v = 0; v < views(); ++v) {
      if (const auto place = PlaceOf(v)) next.cameras[v] = Stepped(scene.cameras[v], step.segment<6>(*place));
    }
    HoldBaseline(&next);
    return next;
  }

  /// Scales the scene around the first camera.
  void HoldBaseline(AdjustedScene* scene) const {
    const double length = (scene->cameras[ends_.first].Center() - scene->cameras[ends_.second].Center()).norm();
    if (!(length > 0)) return;
    const double scale = baseline_ / length;
    const Eigen::Vector3d origin = scene->cameras.front().Center();
    for (size_t v = 1; v < views(); ++v) {
      Eigen::Isometry3d& pose = scene->cameras[v].cam_from_world;
      pose.translation() = -(pose.linear() * (origin + scale * (scene->cameras[v].Center() - origin)));
    }
    for (OffsetPixel& pixel : scene->pixels) pixel.inv_depth /= scale;
  }

  const std::vector<PatchOffset>& offsets_;
  const std::vector<Camera>& given_;
  double extent_;
  std::vector<std::vector<int>> slots_;  ///< of each view: source views that its pixels have offsets in
  std::vector<size_t> first_pixel_;      ///< of each view, and the end
  std::vector<size_t> first_offset_;     ///< of each pixel, and the end
  double huber_ = kMinHuber;
  double baseline_ = 0;  ///< world units, the longest
  std::pair<size_t, size_t> ends_{0, 0};
};

}  // namespace

void AdjustScene(const std::vector<PatchOffset>& offsets, const std::vector<Camera>& given, AdjustedScene* scene) {
  if (given.size() < 2) return;
  Adjustment(offsets, given, *scene).Run(scene);
}

}  // namespace oraclegs
