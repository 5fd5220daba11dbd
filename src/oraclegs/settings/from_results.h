#pragma once
// Everything automatic that waits for results of the run becomes a value here. What the options, the photos and this
// machine decide is settled before the first stage: plan.h, run_size.h.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {

/// Fewer dense points than this are no start, and fewer sparse ones are joined by random points: growth of 5 % at a
/// time would not reach a useful number of Gaussians (lego, 8 views: 170 points alone end at 2 000 Gaussians and
/// 20.2 dB, a random start at 22.5 dB).
inline constexpr size_t kMinPointsForStart = 1000;
/// Fewer sparse points than this are no start.
inline constexpr size_t kMinSparseStart = 100;

/// --set sfm-points. all_train: every view of the scene trains, so that no held-out view helped to place its points.
SfmPoints SettleSfmPoints(const StartOptions& asked, bool all_train);

/// Photos that leave less open than this (Openness) teach all that proposals could.
inline constexpr double kMinOpenness = 0.3;
/// Fewer photos than this leave something open however close together they stand.
inline constexpr int kLeastPhotosAlone = 6;

inline constexpr int kMostProposals = 96;  ///< that are made where nobody says how many

/// Photos that train, and what they leave open.
struct PhotosOpenness {
  int photos = 0;
  double openness = 1;  ///< as Openness; 1 where a generator that sees anything proposes, too
};

/// --trajectory and --proposals. proxies_alone: nothing but proxy models proposes.
TargetPlan SettleTargets(const TrajectoryOptions& asked, bool proxies_alone, const PhotosOpenness& found);

/// --set proxy-finish. Few views show each part of an object, so its proxy models learn longer.
double SettleProxyFinish(const ProposeOptions& asked, bool is_object);

/// Points to start from.
struct StartCounts {
  size_t dense = 0, sparse = 0;
  size_t most = 0;            ///< --max-gaussians
  bool looked_dense = false;  ///< stage "depth" ran
};

/// --init as the kinds of points that are added one after the other. auto takes the dense points where there are
/// plenty, else the sparse ones, joined by random ones where they are few, or random ones alone; warns of what lacks.
std::vector<StartKind> SettleStart(const StartOptions& asked, const StartCounts& found, const Listener& listener);

/// --set init-scale. is_dense: the points are dense ones.
double SettleStartScale(const StartOptions& asked, bool is_dense);

/// Facts that decide about the training.
struct TrainEvidence {
  bool is_object = false;            ///< the photos show an object before a plain background
  double exposure_spread = 0;        ///< ExposureSpread of photos whose exposures vary; 0 = they do not
  size_t photos = 0, proposals = 0;  ///< numbers of views
  /// Mean squared confidence of proposals that proxy models alone made; nullopt for others.
  std::optional<double> proxy_trust = {};
};

/// Options of the training. Reports what differs from scene to scene.
TrainOptions SettleTraining(const AutoTrainOptions& asked, const TrainEvidence& found, const Listener& listener);

/// {"rate-scale": 3.46, ...}: what `settled` has for the options that were automatic when the user asked.
nlohmann::json ChosenOptions(const AutoTrainOptions& asked, const TrainOptions& settled);

}  // namespace oraclegs
