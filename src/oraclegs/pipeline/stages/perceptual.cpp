#include "oraclegs/pipeline/stages/perceptual.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "oraclegs/networks/common/recognize.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/pipeline/settings/weights.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

using SharedLpips = std::shared_ptr<const Lpips>;

SharedLpips Load(const std::vector<fs::path>& files, torch::Device device = torch::kCPU) {
  return std::make_shared<const Lpips>(LoadRecognizedLpips(files, device));
}

const char* NetworkName(const Lpips& lpips) {
  return lpips.features.config.network == FeatureNetwork::kVgg16 ? "VGG16" : "AlexNet";
}

int64_t BytesOf(const LpipsTarget& target) {
  int64_t bytes = 0;
  for (const Tensor& t : target.features) bytes += t.numel() * static_cast<int64_t>(t.element_size());
  return bytes;
}

/// Targets and their features. None is given up for another: all are asked for equally often.
class Targets {
 public:
  Targets(SharedLpips lpips, int64_t bytes) : lpips_(std::move(lpips)), left_(bytes) {}

  LpipsTarget Get(const Tensor& picture) {
    const auto found = known_.find(picture.data_ptr());
    if (found != known_.end() && found->second.first.sizes() == picture.sizes()) return found->second.second;
    LpipsTarget target = PrepareTarget(*lpips_, picture, LpipsRange::kZeroOne);
    const int64_t bytes = BytesOf(target);
    if (found == known_.end() && bytes <= left_) {
      left_ -= bytes;
      // Held, so that no other picture can come to lie in its place.
      known_.emplace(picture.data_ptr(), std::pair{picture, target});
    }
    return target;
  }

 private:
  SharedLpips lpips_;
  int64_t left_;
  std::map<const void*, std::pair<Tensor, LpipsTarget>> known_;
};

PerceptualDistance LossOf(const SharedLpips& lpips, int64_t cache_bytes) {
  const auto targets = std::make_shared<Targets>(lpips, cache_bytes);
  return [lpips, targets](const Tensor& render, const Tensor& target, double weight, Tensor* grad) {
    Tensor own;
    const bool backward = grad != nullptr && grad->defined();
    if (backward) own = torch::empty_like(*grad);
    const double value = Distance(*lpips, render, targets->Get(target), backward ? &own : nullptr).value;
    if (backward) grad->add_(own, weight);
    return value;
  };
}

bool UsesLpips(const TrainOptions& options) {
  const ProposalSchedule schedule = options.Proposals();
  return options.proposal_lpips > 0 && options.proposal_weight > 0 && schedule.floor + schedule.peak > 0;
}

}  // namespace

std::vector<fs::path> FindLpips(const WeightOptions& options) {
  return FindWeights(kLpipsModel, options.lpips_weights);
}

PerceptualDistance LpipsLoss(const std::vector<fs::path>& files, int64_t cache_bytes) {
  return LossOf(Load(files), cache_bytes);
}

TrainingLpips LpipsOfProposals(const RunOptions& options, const std::vector<TrainView>& proposals,
                               const Listener& listener) {
  if (proposals.empty() || !UsesLpips(options.train)) return {};
  const std::vector<fs::path> files = FindLpips(options.weights);
  if (files.empty()) return {};
  const SharedLpips lpips = Load(files, ChooseDevice(options.device.device, ProbeDevices()));
  int64_t smallest = std::numeric_limits<int64_t>::max();
  for (const TrainView& view : proposals) {
    smallest = std::min<int64_t>(smallest, std::min(view.camera.width, view.camera.height));
  }
  if (options.train.coarse_share > 0) smallest /= 2;
  if (smallest < lpips->features.smallest_side) {
    listener(
        Warning{fmt::format("proposals of {} pixels a side are too small for LPIPS, which needs {}: it is left out",
                            smallest, lpips->features.smallest_side)});
    return {};
  }
  return {LossOf(lpips, kLpipsCacheBytes), fmt::format("{}, pictures in [0, 1]", NetworkName(*lpips))};
}

PictureScores LpipsScores(const std::vector<fs::path>& files) {
  if (files.empty()) return {};
  const SharedLpips lpips = Load(files);
  PictureScores scores;
  scores.smallest_side = lpips->features.smallest_side;
  scores.conventions = {
      {"lpips",
       fmt::format("{}, pictures in [0, 1] as they are, as papers of the 3DGS family score", NetworkName(*lpips))},
      {"lpips_minus1_1", fmt::format("{}, pictures in [-1, 1], as LPIPS was published", NetworkName(*lpips))}};
  scores.of = [lpips](const Tensor& render, const Tensor& truth) {
    std::map<std::string, double> values;
    for (const auto& [name, range] :
         {std::pair{"lpips", LpipsRange::kZeroOne}, std::pair{"lpips_minus1_1", LpipsRange::kMinusOneOne}}) {
      values[name] = Distance(*lpips, render, PrepareTarget(*lpips, truth, range)).value;
    }
    return values;
  };
  return scores;
}

}  // namespace oraclegs
