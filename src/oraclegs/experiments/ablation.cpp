#include "oraclegs/experiments/ablation.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <set>
#include <string_view>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/experiments/ablation_rows.h"
#include "oraclegs/experiments/series.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/settings/named_options.h"
#include "oraclegs/settings/plan.h"
#include "oraclegs/settings/run_size.h"
#include "oraclegs/settings/weights.h"
#include "oraclegs/stages/stage_works.h"
#include "oraclegs/workspace/stage_sharing.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kRows[] = "rows", kJson[] = "ablation.json", kMarkdown[] = "ablation.md";
constexpr std::string_view kLpipsRow = "lpips";

/// Options whose values differ from those of the row before.
json Changes(const json& before, const json& now) {
  json changes = json::object();
  for (const auto& [name, value] : now.items()) {
    if (before.at(name) != value) changes[name] = value;
  }
  return changes;
}

std::optional<double> NumberOf(const json& test, const char* name) {
  const json value = test.value(name, json());
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

AblationRun Scored(AblationRun run, const json& metrics) {
  const json& test = metrics.at("test");
  run.psnr = NumberOf(test, "psnr"), run.ssim = NumberOf(test, "ssim");
  run.lpips = NumberOf(test, "lpips");
  run.psnr_color_corrected = NumberOf(test, "psnr_color_corrected");
  run.gaussians = metrics.value("gaussians", int64_t{0});
  run.training_seconds = metrics.value("train", json::object()).value("seconds", 0.0);
  run.start = metrics.value("start", json::object()).value("source", "");
  return run;
}

class Ablator {
 public:
  Ablator(const AblationRequest& request, const Listener& listener)
      : request_(request), listener_(listener), events_(listener) {
    CheckOptions(request.options);
    CheckRunOptions(request.run.options);
    RequireAblatable(request.run.options);
    if (!request.options.dry_run) RequireNetworksOfRows(request.run.options);
    if (!request.options.shares.empty()) throw UsageError("--shares goes with --compare tampering; leave it out");
    RequireOutsideScene(request.run.out, request.run.scene);
    RequireSeriesFolder(request.run.out, {"ablation", kJson, {kRows, kJson, kMarkdown}});
    PlanRows();
  }

  std::string Commands() const {
    static const json defaults = RunOptionsToJson(RunOptions{});
    std::string text;
    for (const uint64_t seed : ablation_.seeds) {
      for (size_t r = 0; r < rows_.size(); ++r) {
        const RunRequest request = RequestOf(r, seed);
        text += fmt::format("oraclegs reconstruct {} --out {}", ShellQuoted(request.scene.string()),
                            ShellQuoted(request.out.string()));
        const json asked = Changes(defaults, RunOptionsToJson(request.options));
        for (const auto& [name, value] : asked.items()) {
          for (const std::string& word : RunOptionWords(name, value)) (text += ' ') += ShellQuoted(word);
        }
        text += "\n";
      }
    }
    return text;
  }

  Ablation Run() {
    for (size_t s = 0; s < ablation_.seeds.size(); ++s) {
      for (size_t r = 0; r < rows_.size(); ++r) RunOne(r, ablation_.seeds[s]);
    }
    listener_(FileWritten{request_.run.out / kJson});
    listener_(FileWritten{request_.run.out / kMarkdown});
    if (!scored_) std::rethrow_exception(first_failure_);
    return std::move(ablation_);
  }

 private:
  void PlanRows() {
    ablation_.scene = request_.run.scene.string();
    ablation_.command = request_.command, ablation_.version = request_.run.version;
    request_.run.options = WithUsualSizes(request_.run.options);
    const RunOptions& asked = request_.run.options;
    ablation_.iterations = asked.train.iterations.value(), ablation_.max_gaussians = asked.train.max_gaussians.value();
    for (int s = 0; s < request_.options.seeds; ++s) {
      ablation_.seeds.push_back(asked.start.seed + static_cast<uint64_t>(s));
    }
    ablation_.notes = {
        "± is the sample standard deviation over the seeds; a gain is the mean over seeds of a row's PSNR minus that "
        "of the nearest row above with scores."};
    json before = ShapingOptionsToJson(asked);
    for (const size_t row : ChooseRows(request_.options.rows)) {
      const AblationRow& part = AblationRows()[row];
      if (part.name == kLpipsRow && !request_.options.dry_run && FindLpips(asked.weights).empty()) {
        if (!request_.options.rows.empty()) {
          throw InputError("--rows names {}, which needs the weights of LPIPS; {}, or name a file with --lpips-weights",
                           kLpipsRow, HowToFetch(kLpipsModel));
        }
        ablation_.notes.push_back(
            fmt::format("There is no row for LPIPS: without weights for it, its share of a proposal's loss is L1; {}.",
                        HowToFetch(kLpipsModel)));
        before = ShapingOptionsToJson(RowOptions(row, asked));  // the next row compares with this one
        continue;
      }
      const json now = ShapingOptionsToJson(RowOptions(row, asked));
      if (!rows_.empty() && now == before) {
        ablation_.notes.push_back(
            fmt::format("Row {} ({}) is left out: the options that were asked for leave it as the "
                        "row above.",
                        row + 1, part.label));
        listener_(Note{ablation_.notes.back()});
        continue;
      }
      rows_.push_back(row);
      ablation_.rows.push_back({row + 1, part.name, part.label, part.explanation, Changes(before, now), {}});
      before = now;
    }
    seconds_.resize(rows_.size());
  }

  /// Path relative to the ablation's folder.
  std::string Folder(size_t r, uint64_t seed) const {
    return fmt::format("{}/{:02}-{}/seed-{}", kRows, ablation_.rows[r].number, ablation_.rows[r].name, seed);
  }

  /// Workspaces whose stages the next run may copy, the likeliest first: the row above of the same seed, then the
  /// others.
  std::vector<fs::path> Donors(size_t r, uint64_t seed, bool other_seeds) const {
    std::vector<std::string> folders;
    const auto add = [&](uint64_t of) {
      for (size_t above = r; above-- > 0;) folders.push_back(Folder(above, of));
      for (size_t below = r + 1; below < rows_.size(); ++below) folders.push_back(Folder(below, of));
    };
    add(seed);
    if (other_seeds) {
      for (const uint64_t other : ablation_.seeds) {
        if (other != seed) folders.push_back(Folder(r, other)), add(other);
      }
    }
    std::vector<fs::path> donors;
    for (const std::string& folder : folders) {
      // --overwrite asks for new results: workspaces of earlier calls are no donors.
      if (request_.run.overwrite && finished_.count(folder) == 0) continue;
      if (IsWorkspace(request_.run.out / folder)) donors.push_back(request_.run.out / folder);
    }
    return donors;
  }

  RunRequest RequestOf(size_t r, uint64_t seed) const {
    RunRequest request = request_.run;
    request.out = request_.run.out / Folder(r, seed);
    request.options = RowOptions(rows_[r], request_.run.options);
    request.options.start.seed = seed;
    request.options.split = WithListsRead(request.options.split);
    return request;
  }

  void TakeOver(Workspace* workspace, const RunOptions& options, size_t r, uint64_t seed) const {
    if (NeedsDepth(options)) {
      TakeOverGeometry(workspace, Donors(r, seed, true));
    } else {
      TakeOverRegistration(workspace, Donors(r, seed, true));
    }
    if (HasProposals(options)) TakeOverProposals(workspace, Donors(r, seed, !AreProposalsSeeded(options)));
  }

  oraclegs::Run Start(size_t r, uint64_t seed, const Listener& listener) {
    RunRequest request = RequestOf(r, seed);
    // The first run may find that the scene cannot be read; no folder is made before it knows.
    std::error_code none;
    if (scene_is_good_ || fs::exists(request_.run.out / kJson, none)) {
      Workspace workspace = Workspace::Claim(request.out, request.scene, request.options, request.overwrite,
                                             {SizeToJson(request.options), {}, false});
      request.overwrite = false;
      std::error_code ignored;
      if (!fs::exists(workspace.metrics(), ignored)) TakeOver(&workspace, request.options, r, seed);
    }
    oraclegs::Run run = StartRun(request, listener);
    if (!scene_is_good_) {
      const Camera camera = WorkingCamera(run.scene.views[static_cast<size_t>(run.split.train[0])], run.plan.image);
      ablation_.width = camera.width, ablation_.height = camera.height;
      ablation_.train_views = run.split.train.size(), ablation_.test_views = run.split.test.size();
      ablation_.published_views = ViewsOfPublishedSteps(request_.run.scene.filename().string(), request_.run.options);
      scene_is_good_ = true;
      if (!fs::exists(request_.run.out / kJson, none))
        Write();  // results of an earlier call stand until there are new ones
    }
    return run;
  }

  /// Notes once which parts of the results were made with networks whose licenses exclude commercial use.
  void NoteLicense(const json& metrics) {
    for (const std::string& part : metrics.value("non_commercial", std::vector<std::string>())) {
      std::string note = fmt::format("Not for commercial use: rows were made with {}.", part);
      auto& notes = ablation_.notes;
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
    }
  }

  void RunOne(size_t r, uint64_t seed) {
    ThrowIfInterrupted();
    oraclegs::Run run =
        Start(r, seed, events_.ForRun(fmt::format("row {}, seed {}: ", ablation_.rows[r].number, seed)));
    AblationRun result;
    result.seed = seed, result.workspace = Folder(r, seed);
    const bool was_trained = IsUpToDate(&run, "train");
    const auto begin = std::chrono::steady_clock::now();
    try {
      const json metrics = Reconstruct(&run);
      result = Scored(std::move(result), metrics);
      NoteLicense(metrics);
      scored_ = true;
      std::error_code ignored;  // gigabytes that nothing reads any more
      fs::remove_all(run.workspace.checkpoints(), ignored);
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& failure) {  // also out of memory, in any library
      result.failure = failure.what();
      result.failure.resize(std::min(result.failure.size(), result.failure.find('\n')));  // libtorch adds a backtrace
      if (!first_failure_) first_failure_ = std::current_exception();
      listener_(Warning{fmt::format("row {} ({}), seed {} failed: {}", ablation_.rows[r].number,
                                    ablation_.rows[r].label, seed, result.failure)});
    }
    if (!was_trained) {
      seconds_[r] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    finished_.insert(Folder(r, seed));
    ablation_.rows[r].runs.push_back(result);
    Write();
    Tell(r, result);
  }

  void Tell(size_t r, const AblationRun& run) {
    std::vector<size_t> left;
    for (const uint64_t seed : ablation_.seeds) {
      for (size_t row = 0; row < rows_.size(); ++row) {
        std::error_code ignored;
        const bool scored_before = !request_.run.overwrite &&
                                   fs::exists(WorkspacePaths(request_.run.out / Folder(row, seed)).metrics(), ignored);
        if (finished_.count(Folder(row, seed)) == 0 && !scored_before) left.push_back(row);
      }
    }
    const double seconds = SecondsLeft(seconds_, left);
    const std::string outcome = !run.failure.empty() ? "failed"
                                : run.psnr           ? fmt::format("{:.2f} dB", *run.psnr)
                                                     : "no test pixels";
    listener_(Note{fmt::format("row {} of {} ({}), seed {}: {}{}", ablation_.rows[r].number, AblationRows().size(),
                               ablation_.rows[r].label, run.seed, outcome,
                               seconds > 0 ? ", about " + FormatSeconds(seconds) + " left" : "")});
  }

  void Write() const {
    const auto replace = json::error_handler_t::replace;
    WriteFileAtomically(request_.run.out / kJson, AblationToJson(ablation_).dump(2, ' ', false, replace) + "\n");
    WriteFileAtomically(request_.run.out / kMarkdown, AblationMarkdown(ablation_));
  }

  AblationRequest request_;
  const Listener& listener_;
  SeriesListener events_;
  Ablation ablation_;
  std::vector<size_t> rows_;     ///< indices into AblationRows() of the rows in the table
  std::vector<double> seconds_;  ///< duration of the last run of each row; 0 = not known
  std::set<std::string> finished_;
  std::exception_ptr first_failure_;
  bool scene_is_good_ = false, scored_ = false;
};

}  // namespace

Ablation RunAblation(const AblationRequest& request, const Listener& listener) {
  return Ablator(request, listener).Run();
}

std::string AblationCommands(const AblationRequest& request) { return Ablator(request, Silent()).Commands(); }

double SecondsLeft(const std::vector<double>& known, const std::vector<size_t>& left) {
  double sum = 0, count = 0, seconds = 0;
  for (const double s : known) {
    sum += s;
    count += s > 0 ? 1 : 0;
  }
  if (count == 0) return 0;
  for (const size_t row : left) seconds += known[row] > 0 ? known[row] : sum / count;
  return seconds;
}

}  // namespace oraclegs
