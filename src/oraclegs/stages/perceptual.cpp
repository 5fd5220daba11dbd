#include "oraclegs/stages/perceptual.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "oraclegs/networks/loader.h"
#include "oraclegs/settings/device.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

// Of the features of all targets; what does not fit is computed each time.
constexpr int64_t kLpipsCacheBytes = int64_t{2} << 30;

using SharedNetwork = std::shared_ptr<const PerceptualNetwork>;

SharedNetwork Load(const std::vector<fs::path>& files, Device device, int64_t cache_bytes) {
  return GetNetworks().LoadPerceptual(files, device, cache_bytes);
}

bool UsesLpips(const TrainOptions& options) {
  const ProposalSchedule schedule = options.Proposals();
  return options.proposal_lpips > 0 && schedule.floor + schedule.peak > 0;
}

}  // namespace

TrainingLpips LpipsOfProposals(const TrainOptions& options, const Plan& plan, const std::vector<TrainView>& proposals,
                               const Listener& listener) {
  if (proposals.empty() || !UsesLpips(options) || plan.lpips.empty()) return {};
  const Device device = DeviceOfNetworks(GetNetworks(), plan.device, listener);
  const SharedNetwork network = Load(plan.lpips, device, kLpipsCacheBytes);
  int64_t smallest = std::numeric_limits<int64_t>::max();
  for (const TrainView& view : proposals) {
    smallest = std::min<int64_t>(smallest, std::min(view.camera.width, view.camera.height));
  }
  if (smallest < network->smallest_side()) {
    listener(
        Warning{fmt::format("proposals of {} pixels a side are too small for LPIPS, which needs {}: it is left out",
                            smallest, network->smallest_side())});
    return {};
  }
  const auto loss = [network](const Buffer<float>& render, const Buffer<float>& target, double weight,
                              Buffer<float>* grad) { return network->Loss(render, target, weight, grad); };
  return {loss, fmt::format("{}, images in [0, 1]", network->name())};
}

ImageScores LpipsScores(const std::vector<fs::path>& files, Device device, const Listener& listener) {
  if (files.empty()) return {};
  const SharedNetwork network = Load(files, DeviceOfNetworks(GetNetworks(), device, listener), 0);
  ImageScores scores;
  scores.smallest_side = network->smallest_side();
  scores.conventions = {
      {"lpips", fmt::format("{}, images in [0, 1] as they are, as papers of the 3DGS family score", network->name())},
      {"lpips_minus1_1", fmt::format("{}, images in [-1, 1], as LPIPS was published", network->name())}};
  scores.of = [network](const Buffer<float>& render, const Buffer<float>& truth) {
    std::map<std::string, double> values;
    for (const auto& [name, range] :
         {std::pair{"lpips", LpipsRange::kZeroOne}, std::pair{"lpips_minus1_1", LpipsRange::kMinusOneOne}}) {
      values[name] = network->Score(render, truth, range);
    }
    return values;
  };
  return scores;
}

}  // namespace oraclegs
