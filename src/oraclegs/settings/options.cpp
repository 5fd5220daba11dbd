#include "oraclegs/settings/options.h"

#include <nlohmann/json.hpp>

#include "oraclegs/core/text.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/train/methods/make_parts.h"
#include "oraclegs/validate/attention_layers.h"

namespace oraclegs {

namespace {

/// First option set that needs depth; "" = none.
std::string OptionThatNeedsDepth(const BaselineOptions& options) {
  if (options.hard_depth) return "--hard-depth";
  if (options.soft_depth_start > 0) return "--soft-depth-start";
  if (options.covisibility_weights) return "--covisibility-weights";
  return options.pseudo_depth_weight > 0 ? "--pseudo-depth-weight" : "";
}

}  // namespace

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
  CheckMethodOptions(options.train);
  const std::string needs_depth = OptionThatNeedsDepth(options.train.baseline);
  if (options.depth.depth_prior == DepthPrior::kNone && !needs_depth.empty()) {
    throw UsageError("{} needs depth, and --depth-prior none finds none; leave one of them out", needs_depth);
  }
  const ProposerChoice proposers = options.propose.Choice();
  const std::string& generator = options.propose.generator;
  if (proposers == ProposerChoice::kCommand && generator.empty()) {
    throw UsageError(
        "--proposers command needs --generator \"COMMAND\", which generates the views; see docs/generators.md");
  }
  if (proposers == ProposerChoice::kNone && !generator.empty()) {
    throw UsageError("--generator is given, but --proposers none proposes nothing; say --proposers command");
  }
  if (!IsUtf8(generator)) throw UsageError("--generator is not valid UTF-8: {}", EscapeBytes(generator));
}

}  // namespace oraclegs
