#include "oraclegs/experiments/bench/methods.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "oraclegs/baselines/methods.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

RunOptions Ours(const Method&, const std::string&) { return {}; }

RunOptions OursWithoutProposals(const Method&, const std::string&) {
  RunOptions run;
  run.propose.proposers = std::string(kNoneWord);
  return run;
}

/// A published training, from dense points of the training views: the authors' are COLMAP's, this program's stereo's.
RunOptions Published(const Method& method, const std::string& suite) {
  const BaselineMethod& baseline = BaselineFor(method.name, suite);
  RunOptions run = OursWithoutProposals(method, suite);
  run.method.method = baseline.word;
  run.train = baseline.train;
  run.input.frame = FrameKind::kScene;
  run.depth.depth_prior = DepthPrior::kStereo;
  run.start.init = StartKind::kDense;
  run.start.init_scale = baseline.own.adaptive ? 1 : 0.1;
  run.start.init_opacity = baseline.own.adaptive ? 0.1 : 0.5;
  run.start.init_planes = false;
  return run;
}

/// A published training that sees the depth of a network where its weights are.
RunOptions WithNetworkDepth(const Method& method, const std::string& suite) {
  RunOptions run = Published(method, suite);
  run.depth.depth_prior = {};
  return run;
}

/// The authors' training without points; the OracleGS paper's ablation begins with it.
RunOptions FromRandomPoints(const Method& method, const std::string& suite) {
  RunOptions run = Published(method, suite);
  run.depth.depth_prior = DepthPrior::kNone;
  run.start.init = StartKind::kRandomCube;
  return run;
}

}  // namespace

MethodSettings Method::For(const std::string& suite) const {
  const RunOptions run = options(*this, suite);
  const nlohmann::json set = RunOptionsToJson(run), defaults = RunOptionsToJson(RunOptions{});
  MethodSettings settings;
  for (const auto& [option, value] : set.items()) {
    if (value == defaults.at(option)) continue;
    const bool is_usual = option == "iterations" || (option == "init" && run.start.init == StartKind::kDense);
    (is_usual ? settings.usual : settings.options)
        .emplace_back(option, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return settings;
}

const std::vector<Method>& Methods() {
  static const char* const kStandIn = "monocular depth; stereo's stands in for it";
  static const std::vector<Method> methods = {
      {"ours", "OracleGS (this program)", "", Ours},
      {"ours-no-proposals", "OracleGS without proposals", "", OursWithoutProposals},
      {"paper", "OracleGS (the paper's settings)", "Topaloglu 2026", nullptr,
       "the weights of six networks and a large GPU: docs/models.md"},
      {"3dgs", "3DGS", "Kerbl 2023", Published},
      {"3dgs-mcmc", "3DGS-MCMC", "Kheradmand 2024", Published},
      {"3dgs-mcmc-random", "3DGS-MCMC, random start", "Kheradmand 2024", FromRandomPoints},
      {"dropgaussian", "DropGaussian", "Park 2025", Published},
      {"fsgs", "FSGS", "Zhu 2024", WithNetworkDepth, kStandIn},
      {"cor-gs", "CoR-GS", "Zhang 2024", Published},
      {"dngaussian", "DNGaussian", "Li 2024", WithNetworkDepth, kStandIn},
      {"sparsegs", "SparseGS", "Xiong 2023", WithNetworkDepth,
       "monocular depth; stereo's stands in for it, and there is no diffusion model"},
      {"comapgs", "CoMapGS", "Jang 2025", Published, "matches of a network; the depth of stereo stands in for them"},
  };
  return methods;
}

std::vector<Method> FindMethods(const std::string& list) {
  std::vector<Method> found;
  std::vector<std::string> names;
  for (const Method& method : Methods()) names.push_back(method.name);
  for (const std::string& word : SplitTrimmed(list, ',')) {
    const auto at = std::find(names.begin(), names.end(), word);
    if (at == names.end()) {
      throw UsageError("--methods names '{}'; there are {}{}", word, fmt::join(names, ", "), DidYouMean(word, names));
    }
    const Method& method = Methods()[static_cast<size_t>(at - names.begin())];
    const bool again = std::any_of(found.begin(), found.end(), [&](const Method& m) { return m.name == method.name; });
    if (!again) found.push_back(method);
  }
  if (found.empty()) throw UsageError("--methods names none; there are {}", fmt::join(names, ", "));
  return found;
}

}  // namespace oraclegs
