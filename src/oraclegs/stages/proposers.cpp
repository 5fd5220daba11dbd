#include "oraclegs/stages/proposers.h"

#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/propose/generator.h"
#include "oraclegs/stages/proxy_models.h"
#include "oraclegs/stages/seva_stage.h"

namespace oraclegs {

Proposers::Proposers(const Run& run, const TrainingViews& training, const Geometry& geometry,
                     std::vector<ProxyModel> proxies) {
  const std::array<float, 3> background = BackgroundColor(run.options.image.background);
  WarpSources sources{training.views, geometry.maps, {}, &training.silhouettes, background};
  if (geometry.HasVariedExposure()) sources.gains = geometry.gains;
  warper_ = std::make_unique<Warper>(std::move(sources), run.plan.device);
  const ProposeOptions& options = run.options.propose;
  // Also where nothing but a folder proposes: the oracle learns from what is known to be wrong.
  if (options.Choice() != ProposerChoice::kSplat || proxies.empty()) warp_ = std::make_unique<WarpProposer>(*warper_);
  // Beside a generator targets are asked for where stereo found little, too.
  const bool generates = options.Uses(ProposerChoice::kSeva) || !options.generator.empty();
  warp_paints_ = options.Choice() != ProposerChoice::kSeva && options.Choice() != ProposerChoice::kCommand &&
                 (!generates || CanPropose(training, geometry));
  for (int k = 0; k < run.options.seva.candidates && options.Uses(ProposerChoice::kSeva); ++k) {
    stored_.emplace_back(run.workspace.proposals(), SevaSource(k));
  }
  if (options.Uses(ProposerChoice::kCommand)) stored_.emplace_back(run.workspace.proposals(), kGeneratorSource);
  if (proxies.empty()) return;
  splat_ = std::make_unique<EnsembleProposer>(
      std::move(proxies), RenderOptions{background, run.options.train.sh_degree, run.options.train.antialiased});
}

std::vector<std::vector<Proposal>> Proposers::Ask(const std::vector<Target>& targets,
                                                  const std::vector<std::optional<int>>& held_out) const {
  std::vector<std::vector<Proposal>> candidates(targets.size());
  const auto held_out_of = [&](size_t i) { return held_out.empty() ? std::nullopt : held_out[i]; };
  const auto ask = [&](const Proposer& proposer, size_t i) {
    if (auto answer = proposer.Propose(targets[i], held_out_of(i))) candidates[i].push_back(std::move(*answer));
  };
  if (warp_) {
    ParallelFor(static_cast<int64_t>(targets.size()), [&](int64_t t) {
      ThrowIfInterrupted();
      const auto i = static_cast<size_t>(t);
      if (held_out_of(i) || warp_paints_) ask(*warp_, i);
    });
  }
  if (splat_) {
    for (size_t i = 0; i < targets.size(); ++i) {
      ThrowIfInterrupted();
      ask(*splat_, i);
    }
  }
  for (const StoredProposer& stored : stored_) {
    for (size_t i = 0; i < targets.size(); ++i) ask(stored, i);
  }
  return candidates;
}

std::optional<Proposal> Proposers::ProxyRender(const Target& target) const {
  return splat_ ? splat_->Propose(target, std::nullopt) : std::nullopt;
}

const Proposers& ProposersOf(Run* run) {
  StageResults& known = *run->results;
  if (!known.proposers) {
    known.proposers = std::make_shared<const Proposers>(*run, ViewsOf(run), known.geometry, known.proxies);
  }
  return *known.proposers;
}

}  // namespace oraclegs
