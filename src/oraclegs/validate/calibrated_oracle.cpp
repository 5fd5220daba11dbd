#include "oraclegs/validate/calibrated_oracle.h"

#include <algorithm>
#include <array>

#include "oraclegs/core/text.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/validate/vggt_oracle.h"

namespace oraclegs {
namespace {

// Targets whose images are held at once, and that VGGT looks at together unless another number is asked for.
constexpr size_t kOracleChunk = 8;
constexpr size_t kImagesOfPass = 96;  // of all images and proposals, in the paper's code

double GiB(double bytes) { return bytes / (1024.0 * 1024 * 1024); }

HeldOutCandidates AskHeldOut(const std::vector<LoadedView>& views, const Proposers& proposers) {
  std::vector<Target> targets;
  std::vector<std::optional<int>> held_out;
  const std::vector<size_t> learned = LearnedViews(views.size());
  for (const size_t v : learned) {
    targets.push_back({views[v].name, views[v].camera});
    held_out.emplace_back(static_cast<int>(v));
  }
  std::vector<std::vector<Proposal>> asked = proposers.Ask(targets, held_out);
  HeldOutCandidates candidates{views, std::vector<std::vector<Proposal>>(views.size())};
  for (size_t k = 0; k < learned.size(); ++k) candidates.candidates[learned[k]] = std::move(asked[k]);
  return candidates;
}

bool IsNothing(const ConfidenceMap& map) {
  return std::all_of(map.begin(), map.end(), [](float confidence) { return confidence == 0; });
}

}  // namespace

size_t ChooseChunk(const std::function<int64_t(int64_t)>& bytes, const ChunkRequest& request, uint64_t available,
                   const Listener& listener) {
  const Auto<int>& asked = request.asked;
  const auto fits = [&](int64_t chunk) { return available == 0 || static_cast<uint64_t>(bytes(chunk)) <= available; };
  const double free = GiB(static_cast<double>(available));
  if (!asked.is_auto() && asked.value() > 0) {
    if (!fits(asked.value())) {
      listener(Warning{fmt::format("--set oracle-chunk={}: a pass needs about {:.1f} GiB, {:.1f} GiB are free",
                                   asked.value(), GiB(static_cast<double>(bytes(asked.value()))), free)});
    }
    return static_cast<size_t>(asked.value());
  }
  const int64_t most = static_cast<int64_t>(std::max<size_t>(asked.is_auto() ? request.usual : request.all, 1));
  int64_t chunk = most;
  while (chunk > 1 && !fits(chunk)) --chunk;
  if (!fits(chunk)) {
    throw RunError(
        "VGGT needs about {:.1f} GiB of memory for one proposal beside an image, {:.1f} GiB are free; free some, or "
        "use --oracle consistency",
        GiB(static_cast<double>(bytes(1))), free);
  }
  if (chunk < most) {
    listener(
        Warning{fmt::format("VGGT looks at {} images at a time, not {}, for {:.1f} GiB of memory are free; --set "
                            "oracle-chunk={} gives the same confidence again",
                            chunk, most, free, chunk)});
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

CalibratedOracle::CalibratedOracle(const OracleSetup& setup, const std::vector<LoadedView>& views,
                                   const Proposers& proposers, const Listener& listener)
    : rule_(setup.options.pick), together_(kOracleChunk) {
  if (setup.kind == OracleKind::kUniform) {
    uniform_ = MakeUniformOracle();
    return;
  }
  if (!setup.vggt.empty()) LoadSecond(setup, views, listener);
  const bool calibrate = setup.options.calibrate;
  if (!calibrate && setup.kind == OracleKind::kVggt) {
    progress_->total = setup.targets;
    return;
  }
  const Warper& warper = proposers.warper();
  const Evidence evidence = setup.kind == OracleKind::kVggt ? Evidence::kSecond : Evidence::kBoth;
  const FeatureSource features = second_ ? FeatureSource(warper, *second_, evidence) : FeatureSource(warper);
  const LevelRule rule = calibrate ? LevelRule::kFitted : LevelRule::kAsIs;
  calibrated_ = std::make_unique<ConsistencyOracle>(features, views, rule);
  const HeldOutCandidates held_out = AskHeldOut(views, proposers);
  if (progress_) {
    size_t max_candidates = 0;
    for (const auto& of_one : held_out.candidates) max_candidates = std::max(max_candidates, of_one.size());
    const size_t of_each = max_candidates > 1 ? max_candidates + 1 : max_candidates;  // and what is mixed from them
    progress_->total = (LearnedViews(views.size()).size() + setup.targets) * of_each;
    if (setup.unknown_errors) progress_->total += TamperTrainedOracle::TrainingSamples(views.size());
  }
  Calibrate(held_out);
  if (setup.unknown_errors) {
    tamper_trained_ = std::make_unique<TamperTrainedOracle>(features, proposers, held_out, rule, setup.seed);
  }
}

CalibratedOracle::~CalibratedOracle() = default;

const Oracle& CalibratedOracle::oracle() const {
  if (uniform_) return *uniform_;
  if (calibrated_) return *calibrated_;
  return *second_;
}

void CalibratedOracle::LoadSecond(const OracleSetup& setup, const std::vector<LoadedView>& views,
                                  const Listener& listener) {
  const ValidateOptions& asked = setup.options;
  std::unique_ptr<AttentionNetwork> network = GetNetworks().OpenAttention(
      setup.vggt, {asked.oracle_mode, AttentionLayersOf(asked), setup.precision}, setup.device);
  const std::vector<Camera> cameras = CamerasOf(views);
  VggtOracleOptions options;
  options.pass = asked.oracle_pass, options.seed = setup.seed;
  const bool all = options.pass == OraclePass::kAll;
  const ChunkRequest request =
      all ? ChunkRequest{asked.oracle_chunk, std::min(kImagesOfPass, views.size() + setup.targets),
                         views.size() + setup.targets}
          : ChunkRequest{asked.oracle_chunk, kOracleChunk, std::max(setup.targets, views.size())};
  const auto bytes = [&](int64_t images) { return network->PassBytes(cameras, all ? images : images + 1); };
  options.chunk = ChooseChunk(bytes, request, setup.free_bytes, listener);
  const auto chunk = static_cast<int64_t>(options.chunk);
  listener(Note{fmt::format("VGGT looks at {} at once, which needs about {:.3g} GB",
                            Counted(all ? chunk : chunk + 1, "image"), Gigabytes(bytes(chunk)))});
  together_ = all ? std::max<size_t>(setup.targets, 1) : options.chunk;
  progress_ = std::make_shared<Progress>();
  progress_->listener = listener;
  options.on_pass = [progress = progress_](size_t images) { progress->Add(images); };
  network->Load();
  second_ = std::make_unique<VggtOracle>(std::move(network), std::move(options), views);
}

void CalibratedOracle::Calibrate(const HeldOutCandidates& held_out) {
  const auto& candidates = held_out.candidates;
  std::vector<Query> queries;
  for (size_t v = 0; v < candidates.size(); ++v) {
    for (const Proposal& p : candidates[v]) {
      queries.push_back({p, static_cast<int>(v)});
      calibrated_sources_.insert(p.source);
    }
  }
  const bool mixes =
      std::any_of(candidates.begin(), candidates.end(), [](const auto& of_one) { return of_one.size() > 1; });
  if (!mixes) return calibrated_->Calibrate(queries);
  const std::vector<ConfidenceMap> confidence = calibrated_->CalibrateAndPredict(queries);
  std::vector<Query> mixed;
  auto next = confidence.begin();
  for (size_t v = 0; v < candidates.size(); ++v) {
    const auto end = next + static_cast<int64_t>(candidates[v].size());
    if (candidates[v].size() > 1) {
      mixed.push_back({Pick(candidates[v], {next, end}, rule_).proposal, static_cast<int>(v)});
    }
    next = end;
  }
  std::erase_if(mixed, [](const Query& query) { return query.proposal.source != kMixed; });
  if (!mixed.empty()) calibrated_->Calibrate(mixed);
}

std::vector<ConfidenceMap> CalibratedOracle::Predict(const std::vector<Proposal>& proposals,
                                                     const std::vector<bool>& unknown) const {
  std::array<std::vector<Proposal>, 2> parts;
  for (size_t p = 0; p < proposals.size(); ++p) parts[unknown[p] ? 1 : 0].push_back(proposals[p]);
  std::array<std::vector<ConfidenceMap>, 2> maps;
  if (!parts[0].empty()) maps[0] = oracle().Predict(parts[0]);
  if (!parts[1].empty()) maps[1] = tamper_trained_->Predict(parts[1]);
  std::array<size_t, 2> next = {0, 0};
  std::vector<ConfidenceMap> all;
  for (const bool part : unknown) all.push_back(std::move(maps[part ? 1 : 0][next[part ? 1 : 0]++]));
  return all;
}

std::vector<Validated> CalibratedOracle::Classify(std::vector<std::vector<Proposal>> candidates) const {
  std::erase_if(candidates, [](const auto& of_one) { return of_one.empty(); });
  const auto has_unknown_errors = [&](const Proposal& p) {
    return tamper_trained_ && calibrated_sources_.count(p.source) == 0;
  };
  std::vector<Proposal> all;
  std::vector<bool> unknown;
  for (const auto& of_one : candidates) {
    for (const Proposal& p : of_one) all.push_back(p), unknown.push_back(has_unknown_errors(p));
  }
  std::vector<ConfidenceMap> confidence = Predict(all, unknown);
  std::vector<Validated> picked;
  std::vector<Proposal> mixed;
  std::vector<bool> mixed_unknown;
  auto next = confidence.begin();
  for (auto& of_one : candidates) {
    std::vector<ConfidenceMap> maps;
    for (size_t c = 0; c < of_one.size(); ++c) maps.push_back(std::move(*next++));
    for (size_t c = of_one.size(); c-- > 0 && of_one.size() > 1;) {
      if (!has_unknown_errors(of_one[c]) || !IsNothing(maps[c])) continue;
      of_one.erase(of_one.begin() + static_cast<int64_t>(c)), maps.erase(maps.begin() + static_cast<int64_t>(c));
    }
    picked.push_back(Pick(of_one, maps, rule_));
    if (picked.back().proposal.source != kMixed) continue;
    mixed.push_back(picked.back().proposal);
    mixed_unknown.push_back(std::any_of(of_one.begin(), of_one.end(), has_unknown_errors));
  }
  confidence = Predict(mixed, mixed_unknown);
  next = confidence.begin();
  for (Validated& v : picked) {
    if (v.proposal.source == kMixed) v.confidence = std::move(*next++);
  }
  return picked;
}

}  // namespace oraclegs
