#include "oraclegs/pipeline/stages/proposers.h"

#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/depth/gains.h"
#include "oraclegs/pipeline/settings/device.h"

namespace oraclegs {

Proposers::Proposers(const Run& run, const std::vector<LoadedView>& photos, const Geometry& geometry,
                     std::vector<ProxyModel> opinions)
    : silhouettes_(photos) {
  const std::array<float, 3> background = BackgroundColor(run.options.photo.background);
  WarpSources sources{photos, geometry.maps, {}, &silhouettes_, background};
  if (ExposureSpread(geometry.gains) > kVariedExposure) sources.gains = geometry.gains;
  warper_ = std::make_unique<Warper>(std::move(sources), ChooseDevice(run.options.device.device, ProbeDevices()));
  const std::string& asked = run.options.propose.proposers;
  // Also where nothing but a folder proposes: the oracle learns from what is known to be wrong.
  if (asked != "splat" || opinions.empty()) warp_ = std::make_unique<WarpProposer>(*warper_);
  warp_paints_ = asked != "seva";
  for (int k = 0; k < run.options.seva.candidates && run.options.propose.Names("seva"); ++k) {
    seva_.emplace_back(run.workspace.proposals(), k);
  }
  if (opinions.empty()) return;
  splat_ = std::make_unique<EnsembleProposer>(
      std::move(opinions), RenderOptions{background, run.options.train.sh_degree, run.options.train.antialiased});
}

std::vector<std::vector<Proposal>> Proposers::Ask(const std::vector<Target>& targets,
                                                  const std::vector<int>& hidden) const {
  std::vector<std::vector<Proposal>> answers(targets.size());
  if (warp_) {
    ParallelFor(static_cast<int64_t>(targets.size()), [&](int64_t t) {
      ThrowIfInterrupted();
      const auto i = static_cast<size_t>(t);
      if (hidden[i] < 0 && !warp_paints_) return;
      if (auto answer = warp_->Propose(targets[i], hidden[i])) answers[i].push_back(std::move(*answer));
    });
  }
  if (splat_) {
    for (size_t i = 0; i < targets.size(); ++i) {
      ThrowIfInterrupted();
      if (auto answer = splat_->Propose(targets[i], hidden[i])) answers[i].push_back(std::move(*answer));
    }
  }
  for (const SevaProposer& seva : seva_) {
    for (size_t i = 0; i < targets.size(); ++i) {
      if (auto answer = seva.Propose(targets[i], hidden[i])) answers[i].push_back(std::move(*answer));
    }
  }
  return answers;
}

}  // namespace oraclegs
