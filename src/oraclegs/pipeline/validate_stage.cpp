#include "oraclegs/pipeline/validate_stage.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "oraclegs/core/files.h"
#include "oraclegs/depth/depth_files.h"
#include "oraclegs/pipeline/fingerprint.h"
#include "oraclegs/scene/view_list.h"
#include "oraclegs/validate/consistency.h"
#include "oraclegs/validate/pick.h"

namespace oraclegs {
namespace {

constexpr double kValidateVersion = 2;  // raised when the same inputs give other confidences
constexpr size_t kChunk = 8;            // targets whose pictures are held at once
constexpr double kLeastTrust = 0.02;    // mean confidence of a proposal that is of any use

PickRule RuleOf(const std::string& word) {
  return word == "view" ? PickRule::kView : word == "pixel" ? PickRule::kPixel : PickRule::kBlend;
}

/// The oracle, which knows candidates and what is mixed from them.
class Judge {
 public:
  Judge(const Run& run, const std::vector<Photo>& photos, const Proposers& proposers)
      : rule_(RuleOf(run.options.validate.pick)) {
    if (run.options.validate.confidence == "uniform") {
      oracle_ = MakeUniformOracle();
      return;
    }
    auto oracle = std::make_unique<ConsistencyOracle>(proposers.warper(), photos);
    Teach(photos, proposers, oracle.get());
    oracle_ = std::move(oracle);
  }

  /// One of each target that has candidates, in their order.
  std::vector<Validated> operator()(std::vector<std::vector<Proposal>> candidates) const {
    std::erase_if(candidates, [](const auto& of_one) { return of_one.empty(); });
    std::vector<Proposal> all;
    for (const auto& of_one : candidates) all.insert(all.end(), of_one.begin(), of_one.end());
    auto confidence = oracle_->Validate(all);
    std::vector<Validated> picked;
    auto next = confidence.begin();
    for (const auto& of_one : candidates) {
      const auto end = next + static_cast<int64_t>(of_one.size());
      picked.push_back(Pick(of_one, {std::make_move_iterator(next), std::make_move_iterator(end)}, rule_));
      next = end;
    }
    std::vector<Proposal> mixed;
    for (const Validated& v : picked) {
      if (v.proposal.source == kMixed) mixed.push_back(v.proposal);
    }
    confidence = oracle_->Validate(mixed);
    next = confidence.begin();
    for (Validated& v : picked) {
      if (v.proposal.source == kMixed) v.confidence = std::move(*next++);
    }
    return picked;
  }

 private:
  void Teach(const std::vector<Photo>& photos, const Proposers& proposers, ConsistencyOracle* oracle) const {
    std::vector<Target> targets;
    std::vector<int> numbers;
    for (size_t v = 0; v < photos.size(); ++v) {
      targets.push_back({photos[v].name, photos[v].camera});
      numbers.push_back(static_cast<int>(v));
    }
    const std::vector<std::vector<Proposal>> answers = proposers.Ask(targets, numbers);
    std::vector<HiddenPhotograph> hidden;
    for (size_t v = 0; v < answers.size(); ++v) {
      for (const Proposal& p : answers[v]) hidden.push_back({numbers[v], p});
    }
    oracle->Learn(hidden);
    const std::vector<ConfidenceMap> confidence = oracle->Judge(hidden);
    std::vector<HiddenPhotograph> mixed;
    auto next = confidence.begin();
    for (size_t v = 0; v < answers.size(); ++v) {
      const auto end = next + static_cast<int64_t>(answers[v].size());
      if (answers[v].size() > 1) mixed.push_back({numbers[v], Pick(answers[v], {next, end}, rule_).proposal});
      next = end;
    }
    std::erase_if(mixed, [](const HiddenPhotograph& h) { return h.proposal.source != kMixed; });
    if (!mixed.empty()) oracle->Learn(mixed);
  }

  PickRule rule_;
  std::unique_ptr<Oracle> oracle_;
};

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

Tensor ReadPicture(const std::filesystem::path& path, const Camera& camera, int channels) {
  Image8 image = ReadImage(path);
  if (image.width != camera.width || image.height != camera.height || image.channels != 3) {
    throw InputError("{}: is {} x {} with {} channels, not {} x {}; delete it and run again", path.string(),
                     image.width, image.height, image.channels, camera.width, camera.height);
  }
  const ImageF values = ToFloat(image);
  const Tensor rgb =
      torch::from_blob(const_cast<float*>(values.data.data()), {camera.height, camera.width, 3}, torch::kFloat);
  return channels == 3 ? rgb.clone() : rgb.select(2, 0).contiguous().clone();
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

}  // namespace

std::vector<TrainView> RunValidate(Run* run, const std::vector<Photo>& photos, const Geometry& geometry,
                                   const ProposalPlan& plan) {
  if (plan.targets.empty() && plan.folder.proposals.empty()) {
    run->workspace.MarkUndone("validate");
    return {};
  }
  const std::string key =
      Fingerprint().Add(kValidateVersion).Add(plan.key).Add(OptionsToJson(run->options.validate).dump()).Hex();
  const StageClock clock("validate", run->listener);
  if (!run->workspace.IsDone("validate", key)) {
    RemoveOld(run);
    const Proposers proposers(*run, photos, geometry, plan.opinions);
    const auto& ready_made = plan.folder.confidence;
    const bool asked = !plan.targets.empty() ||
                       std::any_of(ready_made.begin(), ready_made.end(), [](const auto& map) { return map.empty(); });
    std::optional<Judge> judge;
    if (asked) judge.emplace(*run, photos, proposers);
    std::vector<std::string> files;
    nlohmann::json means = nlohmann::json::object();
    const size_t total = plan.targets.size() + plan.folder.proposals.size();
    const auto take = [&](const Validated& validated) {
      double sum = 0;
      for (const float c : validated.confidence) sum += static_cast<double>(c);
      means[validated.proposal.name] = sum / static_cast<double>(validated.confidence.size());
      for (std::string& file : Write(run->workspace, validated)) files.push_back(std::move(file));
      run->listener(StepDone{"validate", static_cast<int64_t>(means.size()), static_cast<int64_t>(total), "views", ""});
    };
    for (size_t first = 0; first < plan.targets.size(); first += kChunk) {
      const std::vector<Target> chunk(
          plan.targets.begin() + static_cast<int64_t>(first),
          plan.targets.begin() + static_cast<int64_t>(std::min(first + kChunk, plan.targets.size())));
      for (const Validated& validated : (*judge)(proposers.Ask(chunk, std::vector<int>(chunk.size(), -1))))
        take(validated);
    }
    for (size_t p = 0; p < plan.folder.proposals.size(); ++p) {
      const ConfidenceMap& ready = plan.folder.confidence[p];
      take(ready.empty() ? (*judge)({{plan.folder.proposals[p]}})[0] : Validated{plan.folder.proposals[p], ready});
    }
    run->workspace.MarkDone("validate",
                            {{"key", key}, {"seconds", clock.Seconds()}, {"mean_confidence", means}, {"files", files}});
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
  if (!rejected.empty()) {
    run->listener(Warning{fmt::format("the oracle trusts nothing of {} of {} proposals, which are left out: {}",
                                      rejected.size(), targets.size(), SomeNames(rejected))});
  }
  run->listener(Note{fmt::format("{} proposals, trusted to {:.0f} % in the mean ({})", views.size(),
                                 100 * trust / static_cast<double>(std::max<size_t>(1, views.size())),
                                 (run->workspace.confidence() / "preview").string())});
  return views;
}

}  // namespace oraclegs
