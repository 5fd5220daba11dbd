#include "oraclegs/sfm/pose_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

// A match fits within kFit..., a median error is one of the poses above kOff...: pixels of kReferenceSide and, as
// features are located to a part of a pixel, of the photo itself.
constexpr double kFitReference = 1.5, kFitPhoto = .5;
constexpr double kOffReference = .5, kOffPhoto = .25;
constexpr double kOffOfFewMatches = 8;  // over the root of their number: the median of few is uncertain

constexpr int kMinMatchesOfPair = 15;  // colmap's own limit for a pair
constexpr int kMinMatchesOfAll = 50, kMinPairsOfAll = 2;
constexpr int kMinMatchesAlone = 200;  // suffice even where they are of one pair, or where no mistake explains them
constexpr int kMinMatchesOfView = 50;
constexpr double kHopelessShare = .15, kHopelessError = 5;  // of the limit
constexpr double kMistakeShare = .5, kMistakeGain = .15;
// Over the root of the number of matches, of which some fit by chance: more where a number was fitted to them.
constexpr double kMistakeGainOfFew = 1.5, kFocalGainOfFew = 3.5;
constexpr size_t kMatchesForOrder = 30;

double LongerSide(const Intrinsics& camera) { return std::max(camera.width, camera.height); }

/// The checked views that can be checked, and their matches.
struct CheckedViews {
  std::vector<int> views;  ///< indices of the scene
  GivenCameras given;
};

CheckedViews Gather(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                    const std::vector<VerifiedPair>& verified) {
  CheckedViews checked;
  std::map<std::string, int> index_of;
  std::vector<double> sides;
  for (size_t i = 0; i < views.size(); ++i) {
    const SceneView& view = scene.views[static_cast<size_t>(views[i])];
    if (!view.cam_from_world || view.intrinsics.params.empty()) continue;
    index_of[plan[i].name] = static_cast<int>(checked.views.size());
    checked.views.push_back(views[i]);
    checked.given.intrinsics.push_back(view.intrinsics);
    checked.given.cams_from_world.push_back(*view.cam_from_world);
    sides.push_back(LongerSide(view.intrinsics));
  }
  for (const VerifiedPair& pair : verified) {
    const auto a = index_of.find(pair.first), b = index_of.find(pair.second);
    const bool moves_with_the_camera = pair.config == TwoViewConfig::kWatermark;
    if (a == index_of.end() || b == index_of.end() || moves_with_the_camera) continue;
    if (static_cast<int>(pair.matches.size()) < kMinMatchesOfPair) continue;
    checked.given.pairs.push_back({a->second, b->second, pair.matches});
  }
  checked.given.limit = kFitReference + kFitPhoto * kReferenceSide / std::max(1., Median(std::move(sides)));
  return checked;
}

/// Completes a fit, whose name, side and pairs are known.
void SetErrors(std::vector<double> errors, double fits_within, FitOfView* fit) {
  fit->matches = static_cast<int>(errors.size());
  fit->share = ShareBelow(errors, fits_within);
  fit->limit = kOffReference + kOffPhoto * kReferenceSide / std::max(1., fit->side) +
               kOffOfFewMatches / std::sqrt(std::max(1., static_cast<double>(errors.size())));
  fit->error = UpperMedian(std::move(errors));
}

void Measure(const Scene& scene, const CheckedViews& checked, PoseFit* fit) {
  const GivenCameras& given = checked.given;
  const double extent = ExtentOf(given.cams_from_world);
  std::vector<double> all, sides;
  std::vector<std::vector<double>> of_view(checked.views.size());
  for (size_t i = 0; i < checked.views.size(); ++i) {
    fit->views.push_back({scene.views[static_cast<size_t>(checked.views[i])].name});
    fit->views.back().side = LongerSide(given.intrinsics[i]);
    sides.push_back(fit->views.back().side);
  }
  for (const RayPair& pair : RaysOf(given.pairs, given.intrinsics)) {
    const auto a = static_cast<size_t>(pair.a), b = static_cast<size_t>(pair.b);
    std::vector<double> errors;
    AppendErrors(pair, MotionBetween(given.cams_from_world[a], given.cams_from_world[b], extent), &errors);
    all.insert(all.end(), errors.begin(), errors.end());
    for (const size_t view : {a, b}) {
      of_view[view].insert(of_view[view].end(), errors.begin(), errors.end());
      ++fit->views[view].pairs;
    }
    ++fit->all.pairs;
  }
  fit->all.side = Median(std::move(sides));
  SetErrors(std::move(all), given.limit, &fit->all);
  for (size_t i = 0; i < of_view.size(); ++i) SetErrors(std::move(of_view[i]), given.limit, &fit->views[i]);
}

/// Matches of one pair alone may be of two things that look alike.
bool IsKnown(const FitOfView& view) { return view.matches >= kMinMatchesOfView && view.pairs >= kMinPairsOfAll; }

void FindMistake(const Scene& scene, const CheckedViews& checked, PoseFit* fit) {
  const auto at_least = [&](double gain_of_few) {
    const double gain = kMistakeGain + gain_of_few / std::sqrt(static_cast<double>(fit->all.matches));
    return std::max(kMistakeShare, fit->all.share + gain);
  };
  double most = at_least(kMistakeGainOfFew);
  const auto try_change = [&](ChangeFit found) {
    const auto cameras = Changed(checked.given.cams_from_world, found.change);
    std::vector<Intrinsics> intrinsics;
    for (const Intrinsics& camera : checked.given.intrinsics) intrinsics.push_back(Changed(camera, found.change));
    found.share = FittingShare(RaysOf(checked.given.pairs, intrinsics), cameras, checked.given.limit);
    const bool is_enough = found.change.focal_factor == 1 || found.share > at_least(kFocalGainOfFew);
    if (is_enough && found.share > most) most = found.share, fit->change = found;
  };
  try_change(BestAxes(checked.given));
  try_change(BestFocal(checked.given));
  OrderSearch search;
  search.pairs = RaysOf(Thinned(checked.given.pairs, kMatchesForOrder), checked.given.intrinsics);
  search.limit = checked.given.limit;
  std::map<int, int> among_posed;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    if (!scene.views[v].cam_from_world) continue;
    among_posed[static_cast<int>(v)] = static_cast<int>(search.poses.size());
    search.names.push_back(scene.views[v].name);
    search.poses.push_back(*scene.views[v].cam_from_world);
  }
  for (const int view : checked.views) search.views.push_back(among_posed.at(view));
  std::optional<PhotoOrder> order = FindPhotoOrder(search);
  if (!order) return;
  std::vector<Eigen::Isometry3d> cameras;
  for (const int pose : order->pose_of_view) cameras.push_back(search.poses[static_cast<size_t>(pose)]);
  order->share = FittingShare(RaysOf(checked.given.pairs, checked.given.intrinsics), cameras, checked.given.limit);
  if (order->share <= most) return;
  for (int& pose : order->pose_of_view) {  // of the scene again
    pose = std::find_if(among_posed.begin(), among_posed.end(), [&](const auto& entry) {
             return entry.second == pose;
           })->first;
  }
  fit->change.reset();
  fit->order = std::move(order);
}

/// Some photos alone may be turned, as by EXIF orientations that some have and some lack.
void FindTurned(const CheckedViews& checked, PoseFit* fit) {
  TurnedViews turned = FindTurnedViews(checked.given);
  if (!turned.views.empty() && turned.share > fit->all.share) fit->turned = std::move(turned);
}

/// True when most matches miss the poses, and a mistake explains most of those that do.
bool IsRuinedByMistake(const PoseFit& fit) {
  if (!fit.IsExplained() || fit.all.share >= .5) return false;
  const double explained = fit.change ? fit.change->share : fit.order ? fit.order->share : fit.turned->share;
  return explained - fit.all.share > .5 * (1 - fit.all.share);
}

}  // namespace

std::vector<std::string> PoseFit::NamesOff() const {
  std::vector<const FitOfView*> off;
  for (const FitOfView& view : views) {
    if (IsKnown(view) && view.IsOff()) off.push_back(&view);
  }
  std::stable_sort(off.begin(), off.end(), [](const FitOfView* a, const FitOfView* b) { return a->error > b->error; });
  std::vector<std::string> names;
  for (const FitOfView* view : off) names.push_back(view->name);
  return names;
}

PoseFit FitPoses(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                 const std::vector<VerifiedPair>& verified, const Eigen::Vector3d& origin) {
  CheckedViews checked = Gather(scene, views, plan, verified);
  checked.given.origin = origin;
  PoseFit fit;
  Measure(scene, checked, &fit);
  const FitOfView& all = fit.all;
  if (all.matches < kMinMatchesOfAll || (all.pairs < kMinPairsOfAll && all.matches < kMinMatchesAlone)) return fit;
  if (!all.IsOff() && fit.NamesOff().empty()) {
    fit.verdict = PoseVerdict::kFit;
    return fit;
  }
  fit.verdict = PoseVerdict::kOff;
  if (all.IsOff()) FindMistake(scene, checked, &fit);
  if (!fit.IsExplained()) FindTurned(checked, &fit);
  const bool hardly_fits = all.share < kHopelessShare && all.error > kHopelessError * all.limit;
  if (IsRuinedByMistake(fit) || (hardly_fits && all.matches >= kMinMatchesAlone)) fit.verdict = PoseVerdict::kHopeless;
  return fit;
}

std::optional<PoseFit> FitPosesOf(const Scene& scene, const std::vector<int>& views, const Eigen::Vector3d& origin,
                                  const std::filesystem::path& work_dir, const Listener& listener) {
  const std::filesystem::path database = work_dir / "database.db";
  if (!IsFile(database)) return std::nullopt;
  try {
    return FitPoses(scene, views, PlanStaging(scene, views), ReadVerifiedMatches(database, kMinMatchesOfPair), origin);
  } catch (const RunError& damage) {
    listener(Warning{fmt::format("{}; the given poses are not checked", damage.what())});
    return std::nullopt;
  }
}

}  // namespace oraclegs
