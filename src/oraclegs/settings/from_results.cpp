#include "oraclegs/settings/from_results.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace oraclegs {
namespace {

constexpr int kUsualProposals = 32;  // images are slow to make, renders of proxy models are not

// Those of [Kerbl 2023] and [Kheradmand 2024].
constexpr double kDenseScale = 1, kSparseScale = 0.1;

constexpr double kOpacityNoise = 0.5, kObjectOpacityNoise = 0.3, kLastRates = 0.1;
// An object is seen from all around, every part of it in few views: overfitting costs more there than dropout blurs.
// Views that overlap much lose by it.
constexpr double kObjectDropout = 0.2;

// Proxy models that are trained nearly to the end err as the model itself does, but each in its own way, so that their
// mean is nearer to the truth than the model would come alone: it may be seen often, as far as it is right. In the end
// the model is as good as they are, and only photos make it sharper.
constexpr double kProxyDose = 0.5;

// 3DGS's learning rates are made for so many iterations. A run of fewer ends before its Gaussians have arrived: with
// rates times the root of the ratio, 1000 iterations come as far as 5000 did, and 5000 half a decibel further.
constexpr double kIterationsOfRates = 30000, kMaxRateScale = 6;

/// Settles what depends on the length of the run; the defaults of `settled` are 3DGS's, for its 30000 iterations.
void SettleCourse(const AutoTrainOptions& asked, TrainOptions* settled) {
  const int iterations = settled->iterations = asked.iterations.ValueOr(kUsualIterations);
  const double course = std::max<double>(iterations, asked.horizon);
  const double rates = std::clamp(std::sqrt(kIterationsOfRates / course), 1., kMaxRateScale);
  settled->rate_scale = asked.rate_scale.ValueOr(rates);
  settled->last_rates = asked.last_rates.ValueOr(kLastRates);
  settled->refine_start = asked.refine_start.ValueOr(std::min(iterations / 10, settled->refine_start));
  settled->refine_every = asked.refine_every.ValueOr(std::clamp(iterations / 50, 10, settled->refine_every));
  settled->sh_degree_interval =
      asked.sh_degree_interval.ValueOr(std::clamp(iterations / 5, 1, settled->sh_degree_interval));
}

void SettleExposure(const AutoTrainOptions& asked, double spread, TrainOptions* settled, const Listener& listener) {
  settled->exposure = asked.exposure.ValueOr(spread > 0 ? ExposureMode::kOn : ExposureMode::kOff);
  if (!asked.exposure.is_auto() || settled->exposure == ExposureMode::kOff) return;
  listener(Note{fmt::format("the images' exposures differ by {:.0f} %: a color map is learned for each (--exposure)",
                            100 * spread)});
}

/// Settles how often an iteration takes a proposal (docs/method.md#schedules).
void SettleSchedule(const AutoTrainOptions& asked, const TrainEvidence& found, TrainOptions* settled,
                    const Listener& listener) {
  settled->schedule = asked.schedule.ValueOr(settled->schedule);
  settled->synthetic_floor = asked.synthetic_floor.ValueOr(settled->synthetic_floor);
  if (found.proxy_trust && asked.schedule.is_auto() && asked.synthetic_floor.is_auto()) {
    settled->schedule = ScheduleKind::kFalling;
    settled->synthetic_floor = kProxyDose * *found.proxy_trust;
    listener(Note{fmt::format("{:.0f} % of the iterations take a proposal, later ones fewer (--set synthetic-floor)",
                              100 * settled->synthetic_floor)});
  } else if (settled->schedule == ScheduleKind::kUnion) {
    settled->schedule = ScheduleKind::kConstant;
    settled->synthetic_floor =
        static_cast<double>(found.proposals) / static_cast<double>(found.photos + found.proposals);
  }
}

}  // namespace

SfmPoints SettleSfmPoints(const StartOptions& asked, bool all_train) {
  return asked.sfm_points.ValueOr(all_train ? SfmPoints::kModel : SfmPoints::kTriangulate);
}

TargetPlan SettleTargets(const TrajectoryOptions& asked, bool proxies_alone, const PhotosOpenness& found) {
  const bool train_alone = found.openness < kMinOpenness && found.photos >= kLeastPhotosAlone;
  const int usual = proxies_alone ? kMostProposals : kUsualProposals;
  return {asked.proposals.ValueOr(train_alone ? 0 : usual), asked.trajectory.ValueOr(Trajectory::kDataset),
          asked.trajectory.is_auto()};
}

double SettleProxyFinish(const ProposeOptions& asked, bool is_object) {
  return asked.proxy_finish.ValueOr(is_object ? 0.6 : 0.4);
}

std::vector<StartKind> SettleStart(const StartOptions& asked, const StartCounts& found, const Listener& listener) {
  if (!asked.init.is_auto()) return {asked.init.value()};
  if (found.dense >= kMinPointsForStart) return {StartKind::kDense};
  if (found.looked_dense) {
    listener(Warning{fmt::format(
        "stereo gave {} points only: the photos overlap too little, or their surfaces have no texture; starting "
        "without them",
        found.dense)});
  }
  if (found.sparse < kMinSparseStart) {
    listener(
        Warning{fmt::format("the training views gave {} points, fewer than {}: starting from random points, which "
                            "reconstructs fine detail less well",
                            found.sparse, kMinSparseStart)});
    return {StartKind::kRandom};
  }
  if (found.sparse < std::min(kMinPointsForStart, found.most)) return {StartKind::kSfm, StartKind::kRandom};
  return {StartKind::kSfm};
}

double SettleStartScale(const StartOptions& asked, bool is_dense) {
  return asked.init_scale.ValueOr(is_dense ? kDenseScale : kSparseScale);
}

TrainOptions SettleTraining(const AutoTrainOptions& asked, const TrainEvidence& found, const Listener& listener) {
  if (found.is_object) {
    listener(Note{"an object before a plain background: its silhouettes bound the reconstruction"});
  }
  TrainOptions settled{asked};
  settled.max_gaussians = asked.max_gaussians.ValueOr(kUsualMaxGaussians);
  settled.opacity_noise = asked.opacity_noise.ValueOr(found.is_object ? kObjectOpacityNoise : kOpacityNoise);
  settled.dropout = asked.dropout.ValueOr(found.is_object ? kObjectDropout : 0);
  SettleCourse(asked, &settled);
  SettleExposure(asked, found.exposure_spread, &settled, listener);
  SettleSchedule(asked, found, &settled, listener);
  return settled;
}

nlohmann::json ChosenOptions(const AutoTrainOptions& asked, const TrainOptions& settled) {
  const nlohmann::json before = OptionsToJson(asked);
  nlohmann::json chosen = OptionsToJson(settled);
  for (const auto& [name, value] : before.items()) {
    if (value != "auto") chosen.erase(name);
  }
  return chosen;
}

}  // namespace oraclegs
