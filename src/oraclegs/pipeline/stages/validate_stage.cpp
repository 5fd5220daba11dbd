#include "oraclegs/pipeline/stages/validate_stage.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "oraclegs/core/files.h"
#include "oraclegs/depth/depth_files.h"
#include "oraclegs/pipeline/workspace/fingerprint.h"
#include "oraclegs/pipeline/stages/calibrated_oracle.h"
#include "oraclegs/pipeline/workspace/non_commercial.h"
#include "oraclegs/scene/scene_validation.h"
#include "oraclegs/validate/view_chunks.h"

namespace oraclegs {
namespace {

constexpr double kValidateVersion = 3;  // raised when the same inputs give other confidences
constexpr double kLeastTrust = 0.02;    // mean confidence of a proposal that is of any use

Image8 Grey(const ConfidenceMap& map, const Camera& camera) {
  Image8 image{camera.width, camera.height, 1, {}};
  for (const float c : map) image.data.push_back(static_cast<uint8_t>(std::lround(255 * std::clamp(c, 0.f, 1.f))));
  return image;
}

/// The proposal beside its confidence in the paper's colours.
Image8 Preview(const Validated& validated) {
  const Camera& camera = validated.proposal.camera;
  const Image8 left = ToImage8(validated.proposal.rgb);
  Image8 image{2 * camera.width, camera.height, 3, {}};
  for (int y = 0; y < camera.height; ++y) {
    const auto row = left.data.begin() + static_cast<int64_t>(y) * camera.width * 3;
    image.data.insert(image.data.end(), row, row + int64_t{3} * camera.width);
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3f color = MapColor(validated.confidence[static_cast<size_t>(y) * camera.width + x]);
      for (int c = 0; c < 3; ++c) image.data.push_back(static_cast<uint8_t>(std::lround(255 * color[c])));
    }
  }
  return image;
}

/// Paths relative to the workspace.
std::vector<std::string> Write(const Workspace& workspace, const Validated& validated) {
  const std::string& name = validated.proposal.name;
  std::vector<std::string> files = {fmt::format("proposals/{}.png", name), fmt::format("confidence/{}.png", name)};
  WritePng(workspace.root() / files[0], ToImage8(validated.proposal.rgb));
  WritePng(workspace.root() / files[1], Grey(validated.confidence, validated.proposal.camera));
  WritePng(workspace.confidence() / "preview" / (name + ".png"), Preview(validated));
  return files;
}

Buffer<float> ReadPicture(const std::filesystem::path& path, const Camera& camera, int channels) {
  Image8 image = ReadImage(path);
  if (image.width != camera.width || image.height != camera.height || image.channels != 3) {
    throw InputError("{}: is {} x {} with {} channels, not {} x {}; delete it and run again", path.string(),
                     image.width, image.height, image.channels, camera.width, camera.height);
  }
  const ImageF values = ToFloat(image);
  const Buffer<float> rgb =
      torch::from_blob(const_cast<float*>(values.data.data()), {camera.height, camera.width, 3}, torch::kFloat);
  return channels == 3 ? rgb.Clone() : rgb.select(2, 0).Clone();
}

/// What an earlier validation left, first of all that it was finished.
void RemoveOld(Run* run) {
  run->workspace.MarkUndone("validate");
  std::error_code ignored;
  std::filesystem::remove_all(run->workspace.confidence(), ignored);
  std::filesystem::remove(run->workspace.root() / "oracle.json", ignored);
  std::vector<std::filesystem::path> pictures;
  for (const auto& entry : std::filesystem::directory_iterator(run->workspace.proposals(), ignored)) {
    if (entry.path().extension() == ".png") pictures.push_back(entry.path());
  }
  for (const auto& picture : pictures) std::filesystem::remove(picture, ignored);
}

/// Proposals of which nothing counts, and what is left of them all.
void TellRejected(const Run& run, const std::vector<std::string>& names, size_t of, bool none_left) {
  if (names.empty()) return;
  const std::string look = (run.workspace.confidence() / "preview").string();
  const char* then = none_left ? "; none is left, and the photographs alone are trained on: another --trajectory or "
                                 "more photographs may help"
                               : "";
  run.listener(Warning{fmt::format("the oracle trusts nothing of {} of {} proposals, which are left out: {} (see {}){}",
                                   names.size(), of, SomeNames(names), look, then)});
}

}  // namespace

std::vector<TrainView> RunValidate(Run* run, const std::vector<LoadedView>& photos, const Geometry& geometry,
                                   const ProposalPlan& plan) {
  if (plan.targets.empty() && plan.folder.proposals.empty()) {
    run->workspace.MarkUndone("validate");
    return {};
  }
  const OracleChoice choice = ChooseOracle(run->options);
  const std::string key = Fingerprint()
                              .Add(kValidateVersion)
                              .Add(plan.key)
                              .Add(OptionsToJson(run->options.validate).dump())
                              .Add(choice.Key())
                              .Hex();
  const StageClock clock("validate", run->listener);
  TellOracle(run->options, choice, run->listener);
  if (!run->workspace.IsDone("validate", key)) {
    RemoveOld(run);
    const Proposers proposers(*run, photos, geometry, plan.opinions);
    const auto& ready_made = plan.folder.confidence;
    const bool asked = !plan.targets.empty() ||
                       std::any_of(ready_made.begin(), ready_made.end(), [](const auto& map) { return map.empty(); });
    std::optional<Judge> judge;
    if (asked) judge.emplace(*run, photos, proposers, choice, plan.targets.size());
    std::vector<std::string> files;
    nlohmann::json means = nlohmann::json::object();
    const size_t total = plan.targets.size() + plan.folder.proposals.size();
    const auto take = [&](const Validated& validated) {
      double sum = 0;
      for (const float c : validated.confidence) sum += static_cast<double>(c);
      means[validated.proposal.name] = sum / static_cast<double>(validated.confidence.size());
      for (std::string& file : Write(run->workspace, validated)) files.push_back(std::move(file));
      if (judge && judge->tells_progress()) return;
      run->listener(StepDone{"validate", static_cast<int64_t>(means.size()), static_cast<int64_t>(total), "views", ""});
    };
    for (const auto& [begin, end] : EvenRuns(plan.targets.size(), judge ? judge->together() : 1)) {
      const std::vector<Target> chunk(plan.targets.begin() + static_cast<int64_t>(begin),
                                      plan.targets.begin() + static_cast<int64_t>(end));
      for (const Validated& validated : (*judge)(proposers.Ask(chunk, std::vector<int>(chunk.size(), -1))))
        take(validated);
    }
    std::vector<size_t> open;
    for (size_t p = 0; p < plan.folder.proposals.size(); ++p) {
      if (ready_made[p].empty()) open.push_back(p);
      if (!ready_made[p].empty()) take({plan.folder.proposals[p], ready_made[p]});
    }
    for (const auto& [begin, end] : EvenRuns(open.size(), judge ? judge->together() : 1)) {
      std::vector<std::vector<Proposal>> some;
      for (size_t i = begin; i < end; ++i) some.push_back({plan.folder.proposals[open[i]]});
      for (const Validated& validated : (*judge)(std::move(some))) take(validated);
    }
    nlohmann::json record = {{"key", key},
                             {"seconds", clock.Seconds()},
                             {"oracle", choice.oracle},
                             {"mean_confidence", means},
                             {"files", files}};
    if (choice.weights) record["chunk"] = judge ? judge->together() : 0;
    if (judge && choice.weights) NoteNetwork(*choice.weights, &record);
    run->workspace.MarkDone("validate", record);
  }
  std::vector<Target> targets = plan.targets;
  for (const Proposal& p : plan.folder.proposals) targets.push_back({p.name, p.camera});
  std::vector<TrainView> views;
  std::vector<std::string> rejected;
  double trust = 0;
  for (const Target& target : targets) {
    const auto picture = run->workspace.proposals() / (target.name + ".png");
    std::error_code ignored;
    if (!std::filesystem::exists(picture, ignored)) continue;  // no proposer answered
    TrainView view{target.name, target.camera, ReadPicture(picture, target.camera, 3),
                   ReadPicture(run->workspace.confidence() / (target.name + ".png"), target.camera, 1)};
    const double mean = view.confidence.mean().item<double>();
    if (mean < kLeastTrust) {
      rejected.push_back(target.name);
    } else {
      trust += mean;
      views.push_back(std::move(view));
    }
  }
  clock.Finish();
  TellRejected(*run, rejected, targets.size(), views.empty());
  if (views.empty()) return views;
  run->listener(Note{fmt::format("{} proposals, trusted to {:.0f} % in the mean ({})", views.size(),
                                 100 * trust / static_cast<double>(views.size()),
                                 (run->workspace.confidence() / "preview").string())});
  return views;
}

}  // namespace oraclegs
