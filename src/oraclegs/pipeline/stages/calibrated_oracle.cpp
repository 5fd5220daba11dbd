#include "oraclegs/pipeline/stages/calibrated_oracle.h"

#include <algorithm>

#include "oraclegs/networks/vggt/weights_file.h"
#include "oraclegs/networks/vggt/memory.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/validate/vggt_oracle.h"

namespace oraclegs {
namespace {

constexpr size_t kChunk = 8;  // targets whose pictures are held at once

PickRule RuleOf(const std::string& word) {
  return word == "view" ? PickRule::kView : word == "pixel" ? PickRule::kPixel : PickRule::kBlend;
}

AttentionMode ModeOf(const std::string& word) {
  return word == "official" ? AttentionMode::kOfficial
         : word == "others" ? AttentionMode::kOthers
                            : AttentionMode::kReference;
}

/// What a pass over `views` pictures of at most this size needs, weights and all.
int64_t PassBytes(const VggtFile& file, const std::vector<LoadedView>& photos, AttentionMode mode, int64_t views) {
  const int64_t patch = file.network.aggregator.backbone.patch;
  VggtPass pass{views, patch, file.side, {}};
  if (mode == AttentionMode::kOfficial) pass.height = file.side;
  for (const LoadedView& photo : photos) {
    const int64_t a = photo.camera.width, b = photo.camera.height;
    const int64_t shorter = (file.side * std::min(a, b) / std::max(a, b) / patch + 1) * patch;
    pass.height = std::max(pass.height, std::min(shorter, file.side));
  }
  return VggtWeightBytes(file.network, {}) + VggtPassBytes(file.network, pass);
}

}  // namespace

/// Pictures that VGGT has looked at, told to the listener.
struct Judge::Progress {
  Listener listener;
  size_t done = 0, total = 0;

  void Add(size_t pictures) {
    done += pictures;
    total = std::max(total, done);
    listener(StepDone{"validate", static_cast<int64_t>(done), static_cast<int64_t>(total), "pictures", "VGGT"});
  }
};

Judge::Judge(const Run& run, const std::vector<LoadedView>& photos, const Proposers& proposers, const OracleChoice& choice,
             size_t targets)
    : rule_(RuleOf(run.options.validate.pick)), together_(kChunk) {
  if (choice.oracle == "uniform") {
    uniform_ = MakeUniformOracle();
    return;
  }
  if (choice.weights) LoadSecond(run, photos, *choice.weights);
  const bool calibrate = run.options.validate.calibrate;
  if (!calibrate && choice.oracle == "vggt") {
    progress_->total = targets;
    return;
  }
  if (second_) {
    const Evidence evidence = choice.oracle == "vggt" ? Evidence::kSecond : Evidence::kBoth;
    calibrated_ = std::make_unique<ConsistencyOracle>(proposers.warper(), photos, *second_, evidence);
  } else {
    calibrated_ = std::make_unique<ConsistencyOracle>(proposers.warper(), photos);
  }
  if (!calibrate) calibrated_->LeaveLevel();
  Teach(photos, proposers, targets);
}

const Oracle& Judge::oracle() const {
  if (uniform_) return *uniform_;
  if (calibrated_) return *calibrated_;
  return *second_;
}

void Judge::LoadSecond(const Run& run, const std::vector<LoadedView>& photos, const VggtWeights& weights) {
  const ValidateOptions& asked = run.options.validate;
  const VggtFile file = ReadVggtFile(weights.path);
  const VggtPlacement placement = PlaceVggt(ChooseDevice(run.options.device.device, ProbeDevices()));
  VggtOracleOptions options;
  options.mode = ModeOf(asked.oracle_mode);
  options.side = file.side;
  options.layers = file.oracle_layers;
  options.weights = file.oracle_weights;
  options.chunk = ChooseChunk([&](int64_t chunk) { return PassBytes(file, photos, options.mode, chunk + 1); },
                              asked.oracle_chunk, static_cast<uint64_t>(FreeBytes(placement.device)), run.listener);
  together_ = options.chunk;
  progress_ = std::make_shared<Progress>();
  progress_->listener = run.listener;
  options.looked = [progress = progress_](size_t pictures) { progress->Add(pictures); };
  second_ = std::make_unique<VggtOracle>(LoadVggt({weights.path}, {}, placement, file.network).aggregator,
                                         std::move(options), photos);
}

void Judge::Teach(const std::vector<LoadedView>& photos, const Proposers& proposers, size_t targets_to_come) {
  std::vector<Target> targets;
  std::vector<int> numbers;
  for (size_t v = 0; v < photos.size(); ++v) {
    targets.push_back({photos[v].name, photos[v].camera});
    numbers.push_back(static_cast<int>(v));
  }
  const std::vector<std::vector<Proposal>> answers = proposers.Ask(targets, numbers);
  std::vector<HiddenPhotograph> hidden;
  size_t most = 0;
  for (size_t v = 0; v < answers.size(); ++v) {
    for (const Proposal& p : answers[v]) hidden.push_back({numbers[v], p});
    most = std::max(most, answers[v].size());
  }
  if (progress_) {
    const size_t of_each = most > 1 ? most + 1 : most;  // the candidates, and what is mixed from them
    progress_->total = (photos.size() + targets_to_come) * of_each;
  }
  calibrated_->Look(&hidden);
  calibrated_->Learn(hidden);
  const std::vector<ConfidenceMap> confidence = calibrated_->Judge(hidden);
  std::vector<HiddenPhotograph> mixed;
  auto next = confidence.begin();
  for (size_t v = 0; v < answers.size(); ++v) {
    const auto end = next + static_cast<int64_t>(answers[v].size());
    if (answers[v].size() > 1) mixed.push_back({numbers[v], Pick(answers[v], {next, end}, rule_).proposal});
    next = end;
  }
  std::erase_if(mixed, [](const HiddenPhotograph& h) { return h.proposal.source != kMixed; });
  if (!mixed.empty()) calibrated_->Learn(mixed);
}

std::vector<Validated> Judge::operator()(std::vector<std::vector<Proposal>> candidates) const {
  std::erase_if(candidates, [](const auto& of_one) { return of_one.empty(); });
  std::vector<Proposal> all;
  for (const auto& of_one : candidates) all.insert(all.end(), of_one.begin(), of_one.end());
  auto confidence = oracle().Validate(all);
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
  confidence = oracle().Validate(mixed);
  next = confidence.begin();
  for (Validated& v : picked) {
    if (v.proposal.source == kMixed) v.confidence = std::move(*next++);
  }
  return picked;
}

}  // namespace oraclegs
