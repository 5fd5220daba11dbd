#include "oraclegs/settings/options.h"

#include <nlohmann/json.hpp>

#include "oraclegs/baselines/methods.h"
#include "oraclegs/core/user_command.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/validate/vggt_oracle.h"

namespace oraclegs {

nlohmann::json ShapingOptionsToJson(const RunOptions& options) {
  nlohmann::json json = nlohmann::json::object();
  RunOptions::ForEachShapingGroup(options, [&](const char*, const auto& group) { json.update(OptionsToJson(group)); });
  return json;
}

nlohmann::json RunOptionsToJson(const RunOptions& options) {
  nlohmann::json json = nlohmann::json::object();
  RunOptions::ForEachGroup(options, [&](const char*, const auto& group) { json.update(OptionsToJson(group)); });
  return json;
}

void CheckRunOptions(const RunOptions& options) {
  RunOptions::ForEachGroup(options, [](const char*, const auto& group) { CheckOptions(group); });
  CheckOptions(options.capture);
  AttentionLayersOf(options.validate);
  CheckScale(options.frame.scale);
  if (options.train.horizon > 0 && !options.train.iterations.is_auto() &&
      options.train.horizon < options.train.iterations.value()) {
    throw UsageError("--set horizon={} is below --iterations {}; rates and weights would end before training does",
                     options.train.horizon, options.train.iterations.value());
  }
  const BaselineSettings baseline = options.method.Settings();
  CheckBaseline("--set method=" + options.method.method, baseline, options.train);
  if (options.depth.depth_prior == DepthPrior::kNone && baseline.UsesDepth()) {
    throw UsageError("--set method={} needs depth, and --depth-prior none finds none; leave one of them out",
                     options.method.method);
  }
  CheckProposers(options.propose);
  RequireUtf8Command("--masks", options.masks.masks);
}

}  // namespace oraclegs
