#include "oraclegs/pipeline/stages/calibrated_oracle.h"

#include <algorithm>

#include "oraclegs/networks/loader.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/validate/vggt_oracle.h"

namespace oraclegs {
namespace {

constexpr size_t kChunk = 8;  // targets whose images are held at once, and that VGGT looks at together

double GiB(double bytes) { return bytes / (1024.0 * 1024 * 1024); }

}  // namespace

size_t ChooseChunk(const std::function<int64_t(int64_t)>& bytes, const Auto<int>& asked, uint64_t available,
                   const Listener& listener) {
  const auto fits = [&](int64_t chunk) { return available == 0 || static_cast<uint64_t>(bytes(chunk)) <= available; };
  const double free = GiB(static_cast<double>(available));
  if (!asked.is_auto()) {
    if (!fits(asked.value())) {
      listener(Warning{fmt::format("--oracle-chunk {}: a pass needs about {:.1f} GiB, {:.1f} GiB are free",
                                   asked.value(), GiB(static_cast<double>(bytes(asked.value()))), free)});
    }
    return static_cast<size_t>(asked.value());
  }
  int64_t chunk = kChunk;
  while (chunk > 1 && !fits(chunk)) --chunk;
  if (!fits(chunk)) {
    throw RunError(
        "VGGT needs about {:.1f} GiB of memory for one proposal beside an image, {:.1f} GiB are free; free some, or "
        "use "
        "--oracle consistency",
        GiB(static_cast<double>(bytes(1))), free);
  }
  if (chunk < static_cast<int64_t>(kChunk)) {
    listener(Warning{fmt::format(
        "VGGT looks at {} proposals at a time, not {}, for {:.1f} GiB of memory are free; --oracle-chunk {} gives the "
        "same confidence again",
        chunk, kChunk, free, chunk)});
  }
  return static_cast<size_t>(chunk);
}

/// Images that VGGT has looked at, reported to the listener.
struct CalibratedOracle::Progress {
  Listener listener;
  size_t done = 0, total = 0;

  void Add(size_t images) {
    done += images;
    total = std::max(total, done);
    listener(StepDone{"validate", static_cast<int64_t>(done), static_cast<int64_t>(total), "images", "VGGT"});
  }
};

CalibratedOracle::CalibratedOracle(const Run& run, const TrainingViews& training, const Proposers& proposers,
                                   size_t targets)
    : rule_(run.options.validate.pick), together_(kChunk) {
  const OracleChoice& choice = run.plan.oracle;
  if (choice.kind == OracleKind::kUniform) {
    uniform_ = MakeUniformOracle();
    return;
  }
  if (choice.weights) LoadSecond(run, training.views, *choice.weights);
  const bool calibrate = run.options.validate.calibrate;
  if (!calibrate && choice.kind == OracleKind::kVggt) {
    progress_->total = targets;
    return;
  }
  const Warper& warper = proposers.warper();
  const Evidence evidence = choice.kind == OracleKind::kVggt ? Evidence::kSecond : Evidence::kBoth;
  calibrated_ =
      std::make_unique<ConsistencyOracle>(second_ ? FeatureSource(warper, *second_, evidence) : FeatureSource(warper),
                                          training.views, calibrate ? LevelRule::kFitted : LevelRule::kAsIs);
  Calibrate(training.views, proposers, targets);
}

CalibratedOracle::~CalibratedOracle() = default;

const Oracle& CalibratedOracle::oracle() const {
  if (uniform_) return *uniform_;
  if (calibrated_) return *calibrated_;
  return *second_;
}

void CalibratedOracle::LoadSecond(const Run& run, const std::vector<LoadedView>& views, const VggtWeights& weights) {
  const ValidateOptions& asked = run.options.validate;
  const Networks& networks = GetNetworks();
  const Device device = DeviceOfNetworks(networks, run.plan.device, run.listener);
  std::unique_ptr<AttentionNetwork> network = networks.OpenAttention(weights.path, asked.oracle_mode, device);
  std::vector<Camera> cameras;
  for (const LoadedView& view : views) cameras.push_back(view.camera);
  VggtOracleOptions options;
  options.chunk = ChooseChunk([&](int64_t chunk) { return network->PassBytes(cameras, chunk + 1); }, asked.oracle_chunk,
                              static_cast<uint64_t>(FreeBytes(device)), run.listener);
  together_ = options.chunk;
  progress_ = std::make_shared<Progress>();
  progress_->listener = run.listener;
  options.on_pass = [progress = progress_](size_t images) { progress->Add(images); };
  network->Load();
  second_ = std::make_unique<VggtOracle>(std::move(network), std::move(options), views);
}

void CalibratedOracle::Calibrate(const std::vector<LoadedView>& views, const Proposers& proposers,
                                 size_t targets_to_come) {
  std::vector<Target> targets;
  std::vector<std::optional<int>> held_out;
  for (size_t v = 0; v < views.size(); ++v) {
    targets.push_back({views[v].name, views[v].camera});
    held_out.emplace_back(static_cast<int>(v));
  }
  const std::vector<std::vector<Proposal>> candidates = proposers.Ask(targets, held_out);
  std::vector<Query> queries;
  size_t max_candidates = 0;
  for (size_t v = 0; v < candidates.size(); ++v) {
    for (const Proposal& p : candidates[v]) queries.push_back({p, held_out[v]});
    max_candidates = std::max(max_candidates, candidates[v].size());
  }
  if (progress_) {
    const size_t of_each = max_candidates > 1 ? max_candidates + 1 : max_candidates;  // and what is mixed from them
    progress_->total = (views.size() + targets_to_come) * of_each;
  }
  const std::vector<ConfidenceMap> confidence = calibrated_->CalibrateAndPredict(queries);
  std::vector<Query> mixed;
  auto next = confidence.begin();
  for (size_t v = 0; v < candidates.size(); ++v) {
    const auto end = next + static_cast<int64_t>(candidates[v].size());
    if (candidates[v].size() > 1) mixed.push_back({Pick(candidates[v], {next, end}, rule_).proposal, held_out[v]});
    next = end;
  }
  std::erase_if(mixed, [](const Query& query) { return query.proposal.source != kMixed; });
  if (!mixed.empty()) calibrated_->Calibrate(mixed);
}

std::vector<Validated> CalibratedOracle::Classify(std::vector<std::vector<Proposal>> candidates) const {
  std::erase_if(candidates, [](const auto& of_one) { return of_one.empty(); });
  std::vector<Proposal> all;
  for (const auto& of_one : candidates) all.insert(all.end(), of_one.begin(), of_one.end());
  auto confidence = oracle().Predict(all);
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
  confidence = oracle().Predict(mixed);
  next = confidence.begin();
  for (Validated& v : picked) {
    if (v.proposal.source == kMixed) v.confidence = std::move(*next++);
  }
  return picked;
}

}  // namespace oraclegs
