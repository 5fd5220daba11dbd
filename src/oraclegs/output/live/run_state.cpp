#include "oraclegs/output/live/run_state.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <ctime>

namespace oraclegs {
namespace {

constexpr size_t kMaxWarnings = 100;

double SecondsSince(StepRate::Clock::time_point then) {
  return std::chrono::duration<double>(StepRate::Clock::now() - then).count();
}

}  // namespace

std::string UtcNow() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

RunState::StageState* RunState::Find(const std::string& name) {
  const auto found = std::find_if(stages_.begin(), stages_.end(), [&](const StageState& s) { return s.name == name; });
  return found == stages_.end() ? nullptr : &*found;
}

RunState::StageState& RunState::FindOrAdd(const std::string& name) {
  if (StageState* known = Find(name)) return *known;
  stages_.push_back({.name = name});
  return stages_.back();
}

void RunState::Add(const Event& event) {
  progress_.Add(event);
  if (const auto* planned = std::get_if<RunPlanned>(&event)) {
    planned_ = planned->stages;
  } else if (const auto* start = std::get_if<StageStarted>(&event)) {
    FindOrAdd(start->stage) = {.name = start->stage};
    rate_.Clear();
  } else if (const auto* step = std::get_if<StepDone>(&event)) {
    // Some stages report steps for a part that has no start of its own, such as "load".
    if (StageState* stage = Find(step->stage)) {
      stage->last = *step;
      stage->seconds_left = rate_.Add(*step).seconds_left;
    }
  } else if (const auto* end = std::get_if<StageFinished>(&event)) {
    StageState& stage = FindOrAdd(end->stage);
    stage.state = "done", stage.seconds = end->seconds, stage.seconds_left = 0;
    rate_.Clear();
  } else if (const auto* kept = std::get_if<StageKept>(&event)) {
    FindOrAdd(kept->stage).state = "unchanged";
  } else if (const auto* warning = std::get_if<Warning>(&event)) {
    if (warnings_.size() < kMaxWarnings) warnings_.push_back(warning->text);
  }
}

void RunState::SetEnd(RunEnd end, const std::string& message) {
  state_ = end == RunEnd::kFinished ? "finished" : end == RunEnd::kFailed ? "failed" : "interrupted";
  message_ = message;
  for (StageState& stage : stages_) {
    if (stage.state == "running") stage.seconds = SecondsSince(stage.since);
  }
}

nlohmann::json RunState::ToJson() const {
  nlohmann::json stages = nlohmann::json::array();
  double stage_left = 0;
  for (const StageState& stage : stages_) {
    const bool running = stage.state == "running" && !ended();
    nlohmann::json row = {{"name", stage.name},
                          {"state", stage.state},
                          {"seconds", running ? SecondsSince(stage.since) : stage.seconds},
                          {"done", stage.last.done},
                          {"total", stage.last.total},
                          {"unit", stage.last.unit},
                          {"detail", stage.last.detail},
                          {"eta_seconds", nullptr}};
    if (running && stage.seconds_left > 0) row["eta_seconds"] = stage_left = stage.seconds_left;
    stages.push_back(std::move(row));
  }
  for (const RunPlanned::Planned& planned : planned_) {
    const auto begun = [&](const StageState& stage) { return stage.name == planned.stage; };
    if (ended() || std::any_of(stages_.begin(), stages_.end(), begun)) continue;
    stages.push_back({{"name", planned.stage}, {"state", "planned"}, {"seconds", planned.seconds}});
  }
  const double left = ended() ? 0 : progress_.SecondsLeft(stage_left);
  return {{"format", 1},
          {"state", state_},
          {"message", message_},
          {"started", started_},
          {"stages", stages},
          {"warnings", warnings_},
          {"left_seconds", left > 0 ? nlohmann::json(left) : nlohmann::json()}};
}

}  // namespace oraclegs
