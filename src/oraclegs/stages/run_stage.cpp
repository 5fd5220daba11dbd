#include "oraclegs/stages/stage.h"

#include <algorithm>
#include <map>

#include "oraclegs/core/error.h"
#include "oraclegs/core/function_ref.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/stages/run_observer.h"
#include "oraclegs/stages/stage_clock.h"

namespace oraclegs {
namespace {

enum class Needs { kBringUpToDate, kTakeAsTheyAre };

class StageRunner {
 public:
  StageRunner(Run* run, const std::vector<Stage>& stages, Needs needs) : run_(run), stages_(stages), needs_(needs) {}

  const Stage& Find(const std::string& name) const { return StageNamed(stages_, name); }

  std::string Key(const Stage& stage) {
    if (!stage.work.wanted(*run_)) return "";
    if (const auto known = keys_.find(stage.name); known != keys_.end()) return known->second;
    Fingerprint print;
    print.Add(stage.name).Add(stage.version);
    for (const std::string& need : stage.needs) print.Add(KeyOfNeed(need));
    stage.work.own(run_, &print);
    return keys_[stage.name] = print.Hex();
  }

  bool IsDone(const Stage& stage) { return run_->workspace.IsDone(stage.name, Key(stage)); }

  /// `asked`: it is the stage that was asked for, not one that another one needs.
  void Bring(const Stage& stage, bool asked) {
    if (!stage.work.wanted(*run_)) {
      run_->workspace.MarkUndone(stage.name);
      return;
    }
    std::map<std::string, std::string>& held = run_->results->keys;
    if (const auto found = held.find(stage.name); found != held.end() && found->second == Key(stage)) return;
    const bool done = IsDone(stage) && IsWhole(stage);
    if (done && !stage.work.load) {
      run_->listener(StageKept{stage.name});
      if (asked) run_->listener(Note{fmt::format("{}: nothing has changed, {} is kept", stage.name, stage.work.file)});
      return;
    }
    if (!done) Undo(stage);
    if (needs_ == Needs::kBringUpToDate) {
      for (const std::string& need : stage.needs) Bring(Find(need), false);
      keys_.erase(stage.name);  // a file of theirs that it reads may be another one now
    }
    const std::string key = Key(stage);
    const StageClock clock(stage.name, run_->listener);
    if (!done) {
      Make(stage, key, clock);
    } else if (Load(stage)) {
      clock.Finish();
      run_->listener(StageKept{stage.name});
    } else {
      Undo(stage);
      Make(stage, key, clock);
    }
    if (stage.work.load) run_->results->keys[stage.name] = key;
    if (stage.work.report) stage.work.report(run_);
    if (run_->observer && stage.work.load && !run_->split.train.empty()) run_->observer->Show(run_, stage.name);
  }

 private:
  std::string KeyOfNeed(const std::string& name) {
    if (needs_ == Needs::kBringUpToDate) return Key(Find(name));
    const nlohmann::json record = run_->workspace.Record(name);
    return record.is_object() ? record.value("key", "") : "";
  }

  /// False, after a warning, when what the stage wrote is damaged.
  bool Load(const Stage& stage) {
    return Survives(stage, [&] { return stage.work.load(run_); });
  }

  bool IsWhole(const Stage& stage) {
    if (!stage.work.check) return true;
    return Survives(stage, [&] { return stage.work.check(*run_), true; });
  }

  bool Survives(const Stage& stage, FunctionRef<bool()> read) {
    try {
      return read();
    } catch (const InputError& damage) {
      const std::string text = damage.what();  // without the mend, of which there is no need
      run_->listener(Warning{fmt::format("{}; stage {} is made again", text.substr(0, text.find("; ")), stage.name)});
      return false;
    }
  }

  void Undo(const Stage& stage) {
    const nlohmann::json record = run_->workspace.Record(stage.name);
    run_->workspace.MarkUndone(stage.name);
    if (stage.work.undo) stage.work.undo(run_, record);
  }

  void Make(const Stage& stage, const std::string& key, const StageClock& clock) {
    const double cpu_before = CpuSeconds();
    std::optional<nlohmann::json> record = stage.work.make(run_, key);
    if (!record) {
      clock.Finish();
      return;
    }
    if (!record->contains("seconds")) (*record)["seconds"] = clock.Seconds();
    if (!record->contains("cpu_seconds")) (*record)["cpu_seconds"] = CpuSeconds() - cpu_before;
    (*record)["key"] = key;
    if (const auto predicted = run_->predicted.find(stage.name); predicted != run_->predicted.end()) {
      (*record)["predicted_seconds"] = predicted->second;
    }
    clock.Finish(record->at("seconds").get<double>());
    run_->workspace.MarkDone(stage.name, *record);
    if (*stage.work.file != '\0') run_->listener(FileWritten{run_->workspace.root() / stage.work.file});
  }

  Run* run_;
  const std::vector<Stage>& stages_;
  Needs needs_;
  std::map<std::string, std::string> keys_;
};

}  // namespace

std::string StageKey(Run* run, const std::vector<Stage>& stages, const std::string& name) {
  StageRunner runner(run, stages, Needs::kBringUpToDate);
  return runner.Key(runner.Find(name));
}

bool IsUpToDate(Run* run, const std::vector<Stage>& stages, const std::string& name) {
  StageRunner runner(run, stages, Needs::kBringUpToDate);
  return runner.IsDone(runner.Find(name));
}

void RunStage(Run* run, const std::vector<Stage>& stages, const std::string& name) {
  StageRunner runner(run, stages, Needs::kBringUpToDate);
  Guarded(run->observer.get(), [&] { runner.Bring(runner.Find(name), true); });
}

void RunStageAlone(Run* run, const std::vector<Stage>& stages, const std::string& name) {
  StageRunner runner(run, stages, Needs::kTakeAsTheyAre);
  Guarded(run->observer.get(), [&] { runner.Bring(runner.Find(name), true); });
}

}  // namespace oraclegs
