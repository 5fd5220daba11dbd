#include "run_scope.h"

#include <algorithm>
#include <map>

namespace oraclegs {
namespace {

using Names = std::vector<std::string_view>;

bool Contains(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The stages' groups from `first` on, in the order of the pipeline.
Names GroupsFrom(std::string_view first, Names more = {}) {
  const Names stages = {"Stereo",     "Depth",    "Proposed poses", "Proposals", "Stable Virtual Camera",
                        "Validation", "Training", "Checkpoints",    "Report"};
  more.insert(more.end(), std::find(stages.begin(), stages.end(), first), stages.end());
  return more;
}

const Names kEveryStage = {"quality", "preset", "max-size", "eval", "views", "device", "seed"};

Names And(Names names, const Names& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

/// Scope of commands on a trained model: its scene, the size of its images, the machine.
RunScope OfModel(Names with_options, Names more_groups = {}) {
  return {And(GroupsFrom("Stereo", {"Basic", "Input", "Start"}), more_groups),
          std::move(with_options),
          {"device"},
          OtherOptions::kNone};
}

std::map<std::string_view, RunScope> AllScopes() {
  const Names of_run = And(kEveryStage, {"frames", "iterations"});
  std::map<std::string_view, RunScope> scopes;
  scopes["reconstruct"] = scopes["train"] = scopes["ablate"] = {{}, {}, of_run};
  scopes["train"].without_groups = {"Report"};
  scopes["ablate"].without_groups = {"Report", "Checkpoints"};
  scopes["ablate"].basic = {"preset", "views", "iterations", "seed"};  // beside its own
  // --views is a list of the command's own.
  scopes["bench"] = {{"Split", "Checkpoints", "Report"},
                     {"eval", "test-every", "view-steps", "train-views", "test-views"},
                     {"preset", "iterations", "device", "seed"},
                     OtherOptions::kNone};
  scopes["sfm"] = {GroupsFrom("Stereo"), {}, And(kEveryStage, {"frames"})};
  scopes["depth"] = {GroupsFrom("Proposed poses"), {}, And(kEveryStage, {"depth-prior", "init"})};
  // Proxy models are trained, too.
  scopes["propose"] = {
      {"Validation", "Checkpoints", "Report"}, {}, And(kEveryStage, {"iterations", "proposers", "proposals"})};
  scopes["validate"] = {{"Checkpoints", "Report"}, {}, And(kEveryStage, {"iterations", "oracle", "proposers"})};
  // --antialiased is how a foreign model was trained.
  scopes["evaluate"] = OfModel({"antialiased", "seed"});
  scopes["evaluate"].basic = {"device", "downscale", "max-size", "test-every", "preset"};
  scopes["render"] = scopes["figure"] = scopes["mesh"] = OfModel({"antialiased"}, {"Weights"});
  return scopes;
}

}  // namespace

bool RunScope::Has(std::string_view group, std::string_view option) const {
  return !Contains(without_groups, group) || Contains(with_options, option);
}

bool RunScope::IsBasic(std::string_view option) const { return Contains(basic, option); }

const RunScope& RunScopeOf(std::string_view command) {
  static const std::map<std::string_view, RunScope> scopes = AllScopes();
  return scopes.at(command);
}

}  // namespace oraclegs
