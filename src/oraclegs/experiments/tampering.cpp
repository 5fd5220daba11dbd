#include "oraclegs/experiments/tampering.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <optional>
#include <set>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/experiments/confidence_check.h"
#include "oraclegs/experiments/series.h"
#include "oraclegs/experiments/tampered_views.h"
#include "oraclegs/experiments/tampering_report.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/settings/from_results.h"
#include "oraclegs/settings/run_size.h"
#include "oraclegs/stages/proposer_row.h"
#include "oraclegs/stages/stage_clock.h"
#include "oraclegs/workspace/stage_sharing.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kRuns[] = "runs", kTampered[] = "tampered", kTamperingJson[] = "tampering.json",
               kTamperingMarkdown[] = "tampering.md", kTamperingSvg[] = "tampering.svg";
constexpr char kModels[] = "models";
constexpr int kTamperingVersion = 2;  ///< raised when the same models give other pictures

/// Difference of a run of the suite from the options that were asked for.
struct Task {
  std::string name;  ///< name of its workspace
  TamperingTrust trust = TamperingTrust::kNone;
  size_t share = 0;  ///< index into the report's shares; unused for kNone
};

void RequireTamperable(const AblationRequest& request) {
  const RunOptions& asked = request.run.options;
  if (!request.options.rows.empty()) throw UsageError("--rows goes with --compare parts; leave it out");
  if (!asked.propose.ByProxiesAlone()) {
    throw UsageError(
        "--compare tampering makes its own proposals; leave out --proposers, --proposal-folder and --generator");
  }
  if (asked.validate.oracle == OracleKind::kUniform || asked.train.confidence_power == 0) {
    throw UsageError(
        "--oracle uniform and --set confidence-power=0 leave --compare tampering nothing to compare; leave them out");
  }
  if (!HasProposals(asked)) {
    throw UsageError("--proposals 0 and --schedule none leave --compare tampering no proposals; leave them out");
  }
  if (asked.depth.depth_prior == DepthPrior::kNone) {
    throw UsageError("--depth-prior none leaves --compare tampering no depth to propose from; leave it out");
  }
}

/// Masks, for each target, of the pixels that at most one photo sees.
std::vector<PixelMask> VoidOf(const Warper& warper, const std::vector<Target>& targets) {
  std::vector<PixelMask> masks;
  for (const Target& target : targets) {
    ThrowIfInterrupted();
    PixelMask mask;
    for (const PixelEvidence& pixel : warper.Warp(target.camera).evidence) {
      // Pixels beside an object are no void: its silhouettes show that nothing is there.
      mask.push_back(pixel.views < 1.5f && pixel.background < 0.5f ? 255 : 0);
    }
    masks.push_back(std::move(mask));
  }
  return masks;
}

class TamperingSuite {
 public:
  TamperingSuite(const AblationRequest& request, const Listener& listener)
      : request_(request), listener_(listener), events_(listener) {
    CheckOptions(request.options);
    CheckRunOptions(request.run.options);
    RequireTamperable(request);
    for (const int percent : ParseShares(request.options.shares)) report_.shares.push_back({percent, {}});
    RequireOutsideScene(out(), request.run.scene);
    RequireSeriesFolder(
        out(),
        {"tampering benchmark", kTamperingJson, {kRuns, kTampered, kTamperingJson, kTamperingMarkdown, kTamperingSvg}});
    request_.run.options = WithUsualSizes(request.run.options);
    const RunOptions& asked = request_.run.options;
    report_.scene = request.run.scene.string(), report_.command = request.command;
    report_.version = request.run.version;
    report_.iterations = asked.train.iterations.value(), report_.max_gaussians = asked.train.max_gaussians.value();
    for (int s = 0; s < request.options.seeds; ++s) {
      report_.seeds.push_back(asked.start.seed + static_cast<uint64_t>(s));
    }
    tasks_ = PlanTasks();
    seconds_.resize(kTamperingTrustNames.size());
  }

  TamperingReport Run() {
    for (const uint64_t seed : report_.seeds) {
      MakePictures(seed);
      for (const Task& task : tasks_) Train(task, seed);
    }
    for (const char* file : {kTamperingJson, kTamperingMarkdown, kTamperingSvg}) listener_(FileWritten{out() / file});
    return std::move(report_);
  }

 private:
  const fs::path& out() const { return request_.run.out; }
  fs::path WorkspaceOf(const std::string& name, uint64_t seed) const {
    return out() / kRuns / fmt::format("seed-{}", seed) / name;
  }
  fs::path TamperedFolder(uint64_t seed) const { return out() / kTampered / fmt::format("seed-{}", seed); }
  fs::path ShareFolder(size_t share, uint64_t seed) const {
    return TamperedFolder(seed) / fmt::format("share-{}", report_.shares[share].percent);
  }

  std::vector<Task> PlanTasks() const {
    std::vector<Task> tasks = {{"none", TamperingTrust::kNone, 0}};
    for (size_t s = 0; s < report_.shares.size(); ++s) {
      const int percent = report_.shares[s].percent;
      for (const TamperingTrust trust : {TamperingTrust::kUniform, TamperingTrust::kOracle, TamperingTrust::kIdeal}) {
        // An ideal oracle equals the uniform one where all pixels are honest, and no proposals where none is.
        if (trust == TamperingTrust::kIdeal && (percent == 0 || percent == 100)) continue;
        tasks.push_back(
            {fmt::format("share-{}-{}", percent, kTamperingTrustNames[static_cast<size_t>(trust)]), trust, s});
      }
    }
    return tasks;
  }

  RunRequest RequestOf(const std::string& name, uint64_t seed) const {
    RunRequest request = request_.run;
    request.out = WorkspaceOf(name, seed);
    request.options.start.seed = seed;
    request.options.split = WithListsRead(request.options.split);
    // A user's folder has no proxy models with it, so no run may use them.
    const bool proposes = name == kModels;
    request.options.propose.proposers = std::string(proposes ? kProxiesWord : kNoneWord);
    // Also of photos that would train alone: a lie needs a proposal.
    if (proposes && request.options.trajectory.proposals.is_auto())
      request.options.trajectory.proposals = kMostProposals;
    return request;
  }

  RunRequest RequestOf(const Task& task, uint64_t seed) const {
    RunRequest request = RequestOf(task.name, seed);
    if (task.trust == TamperingTrust::kNone) return request;
    const bool ideal = task.trust == TamperingTrust::kIdeal;
    request.options.propose.proposal_folder =
        fs::absolute(ShareFolder(task.share, seed) / (ideal ? "ideal" : "pictures"));
    if (task.trust == TamperingTrust::kUniform) request.options.validate.oracle = OracleKind::kUniform;
    return request;
  }

  oraclegs::Run Start(RunRequest request, const Listener& listener) {
    std::error_code none;
    // The first run may find that the scene cannot be read; no folder is made before it knows.
    if (has_started_ || fs::exists(out() / kTamperingJson, none)) {
      Workspace workspace = Workspace::Claim(request.out, request.scene, request.options, request.overwrite,
                                             {SizeToJson(request.options), {}, false});
      request.overwrite = false;
      if (!fs::exists(workspace.metrics(), none)) TakeOverGeometry(&workspace, donors_);
    }
    oraclegs::Run run = StartRun(request, listener);
    if (!has_started_) {
      const Camera camera = WorkingCamera(run.scene.views[static_cast<size_t>(run.split.train[0])], run.plan.image);
      report_.width = camera.width, report_.height = camera.height;
      report_.train_views = run.split.train.size(), report_.test_views = run.split.test.size();
      has_started_ = true;
    }
    donors_.push_back(request.out);
    return run;
  }

  /// Trains the models of a seed, and renders tampered views of them at the proposals' poses.
  void MakePictures(uint64_t seed) {
    ThrowIfInterrupted();
    const Listener listener = events_.ForRun(fmt::format("models, seed {}: ", seed));
    oraclegs::Run run = Start(RequestOf(kModels, seed), listener);
    RunStage(&run, "propose");
    const StageResults& known = *run.results;
    if (known.targets.empty() || known.proxies.empty()) {
      throw InputError("{}: shows too little for proposals that could be tampered with; see the warnings above",
                       request_.run.scene.string());
    }
    targets_ = known.targets;
    report_.proposals = targets_.size();
    std::error_code none;  // results of an earlier call stand until there are new ones
    if (!fs::exists(out() / kTamperingJson, none)) Write();
    const std::string key =
        fmt::format("{} {} {}", kTamperingVersion, known.keys.at("propose"), known.keys.at("proxies"));
    if (HasPictures(seed, key)) return;
    const StageClock clock("tampering", listener);
    const RunOptions& options = run.options;
    const ViewTamperer tamperer(
        known.proxies,
        {BackgroundColor(options.image.Settled().background), options.train.sh_degree, options.train.antialiased},
        targets_, seed);
    const std::vector<PixelMask> unseen = VoidOf(ProposersOf(&run).warper(), targets_);
    for (size_t t = 0; t < targets_.size(); ++t) {
      WriteMask(TamperedFolder(seed) / "void" / (targets_[t].name + ".png"), unseen[t], targets_[t].camera);
    }
    for (size_t s = 0; s < report_.shares.size(); ++s) {
      const double wanted = report_.shares[s].percent / 100.0;
      const TamperedViews views = tamperer.Reach(wanted);
      if (views.share < wanted) {
        listener(Warning{fmt::format("share {} %, seed {}: {} lies make {:.1f} % of the pixels differ, and no more",
                                     report_.shares[s].percent, seed, views.lies, 100 * views.share)});
      }
      WriteTamperedViews(ShareFolder(s, seed), views, RunFromScene(run.frame).Inverse());
      const json record = {{"key", key}, {"tampered", views.share}, {"lies", views.lies}};
      WriteFileAtomically(RecordOf(s, seed), record.dump(2) + "\n");
      listener(StepDone{"tampering", static_cast<int64_t>(s + 1), static_cast<int64_t>(report_.shares.size()), "shares",
                        ""});
    }
    clock.Finish();
  }

  fs::path RecordOf(size_t share, uint64_t seed) const { return ShareFolder(share, seed) / "tampering.json"; }

  json ReadRecord(size_t share, uint64_t seed) const {
    std::error_code ignored;
    if (!fs::exists(RecordOf(share, seed), ignored)) return json::object();
    const json record = ParseJsonOrDiscard(ReadFile(RecordOf(share, seed)));
    return record.is_object() ? record : json::object();
  }

  /// True when the pictures of this key are complete. Otherwise removes what remains of others.
  bool HasPictures(uint64_t seed, const std::string& key) const {
    bool complete = true;
    for (size_t s = 0; s < report_.shares.size(); ++s) {
      if (ReadRecord(s, seed).value("key", "") == key) continue;
      complete = false;
      std::error_code ignored;
      fs::remove_all(ShareFolder(s, seed), ignored);
    }
    return complete;
  }

  void Train(const Task& task, uint64_t seed) {
    ThrowIfInterrupted();
    oraclegs::Run run = Start(RequestOf(task, seed), events_.ForRun(fmt::format("{}, seed {}: ", task.name, seed)));
    const bool was_trained = IsUpToDate(&run, "train");
    const auto begin = std::chrono::steady_clock::now();
    const json metrics = Reconstruct(&run);
    if (!was_trained) {
      seconds_[static_cast<size_t>(task.trust)] =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    std::error_code ignored;  // gigabytes that nothing reads any more
    fs::remove_all(run.workspace.checkpoints(), ignored);
    const json psnr = metrics.at("test").value("psnr", json());
    TamperingRun result{seed, task.trust, fs::relative(run.workspace.root(), out(), ignored).generic_string(),
                        psnr.is_number() ? std::optional(psnr.get<double>()) : std::nullopt};
    finished_.insert(fmt::format("{} {}", task.name, seed));
    Add(task, result);
    if (task.trust == TamperingTrust::kOracle) CheckConfidence(task.share, seed, run.workspace.confidence());
    NoteNonCommercialParts(metrics);
    Write();
    Report(result, task);
  }

  /// Adds the run wherever it counts; one run may stand for trainings that would be the same.
  void Add(const Task& task, const TamperingRun& run) {
    if (task.trust == TamperingTrust::kNone) report_.none.push_back(run);
    for (size_t s = 0; s < report_.shares.size(); ++s) {
      TamperingShare& share = report_.shares[s];
      const bool is_of_share = task.trust != TamperingTrust::kNone && task.share == s;
      if (is_of_share) share.runs.push_back(run);
      if ((share.percent == 100 && task.trust == TamperingTrust::kNone) ||
          (share.percent == 0 && is_of_share && task.trust == TamperingTrust::kUniform)) {
        share.runs.push_back(run);
        share.runs.back().trust = TamperingTrust::kIdeal;
      }
    }
  }

  void CheckConfidence(size_t share, uint64_t seed, const fs::path& confidence) {
    ConfidenceCheck check;
    for (const Target& target : targets_) {
      const std::string file = target.name + ".png";
      std::error_code ignored;
      if (!fs::exists(confidence / file, ignored)) continue;
      const fs::path pictures = ShareFolder(share, seed);
      check.Add({ReadMask(confidence / file, target.camera), ReadMask(pictures / "masks" / file, target.camera),
                 ReadMask(TamperedFolder(seed) / "void" / file, target.camera),
                 ReadMask(pictures / "kinds" / file, target.camera)});
    }
    TamperedConfidence found = check.Result();
    const json record = ReadRecord(share, seed);
    found.seed = seed, found.tampered = record.value("tampered", 0.0), found.lies = record.value("lies", size_t{0});
    report_.shares[share].confidence.push_back(found);
  }

  void NoteNonCommercialParts(const json& metrics) {
    for (const std::string& part : metrics.value("non_commercial", std::vector<std::string>())) {
      std::string note = fmt::format("Not for commercial use: runs were made with {}.", part);
      auto& notes = report_.notes;
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
    }
  }

  void Report(const TamperingRun& run, const Task& task) const {
    std::vector<size_t> left;
    for (const uint64_t seed : report_.seeds) {
      for (const Task& other : tasks_) {
        std::error_code ignored;
        const bool scored =
            !request_.run.overwrite && fs::exists(WorkspacePaths(WorkspaceOf(other.name, seed)).metrics(), ignored);
        if (finished_.count(fmt::format("{} {}", other.name, seed)) == 0 && !scored) {
          left.push_back(static_cast<size_t>(other.trust));
        }
      }
    }
    const double seconds = SecondsLeft(seconds_, left);
    listener_(Note{fmt::format("{}, seed {}: {}{}", task.name, run.seed,
                               run.psnr ? fmt::format("{:.2f} dB", *run.psnr) : "no test pixels",
                               seconds > 0 ? ", about " + FormatSeconds(seconds) + " left" : "")});
  }

  void Write() const {
    const auto replace = json::error_handler_t::replace;
    WriteFileAtomically(out() / kTamperingJson, TamperingToJson(report_).dump(2, ' ', false, replace) + "\n");
    WriteFileAtomically(out() / kTamperingMarkdown, TamperingMarkdown(report_));
    WriteFileAtomically(out() / kTamperingSvg, TamperingPlot(report_));
  }

  AblationRequest request_;
  const Listener& listener_;
  SeriesListener events_;
  TamperingReport report_;
  std::vector<Task> tasks_;
  std::vector<double> seconds_;   ///< duration of a training with each trust; 0 = not known
  std::vector<Target> targets_;   ///< targets of the current seed
  std::vector<fs::path> donors_;  ///< workspaces of this call, whose geometry others may copy
  std::set<std::string> finished_;
  bool has_started_ = false;
};

}  // namespace

std::vector<int> ParseShares(const std::string& words) {
  if (words.empty()) return {0, 10, 30, 50, 100};
  std::set<int> shares;
  for (size_t begin = 0; begin <= words.size();) {
    const size_t end = std::min(words.find(',', begin), words.size());
    std::string word = words.substr(begin, end - begin);
    word.erase(0, std::min(word.find_first_not_of(' '), word.size()));
    word.erase(word.find_last_not_of(' ') + 1);
    int percent = -1;
    const auto [last, error] = std::from_chars(word.data(), word.data() + word.size(), percent);
    if (error != std::errc() || last != word.data() + word.size() || percent < 0 || percent > 100) {
      throw UsageError("--shares names '{}', must be whole numbers of per cent in 0 .. 100, separated by commas", word);
    }
    shares.insert(percent);
    begin = end + 1;
  }
  return {shares.begin(), shares.end()};
}

TamperingReport RunTampering(const AblationRequest& request, const Listener& listener) {
  return TamperingSuite(request, listener).Run();
}

}  // namespace oraclegs
