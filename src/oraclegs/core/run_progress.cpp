#include "oraclegs/core/run_progress.h"

#include <algorithm>

namespace oraclegs {
namespace {

constexpr double kRateWindow = 20;  // seconds

double SecondsBetween(StepRate::Clock::time_point from, StepRate::Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

// Seconds of finished stages that count as planned right, so that a first short stage does not decide.
constexpr double kPriorSeconds = 20;
// Times as long as planned: what lies outside had nothing to do, or tried again and again, and says nothing of others.
constexpr double kUsualSlowness[] = {0.25, 4};

}  // namespace

StepRate::Speed StepRate::Add(const StepDone& step, Clock::time_point now) {
  if (step.stage != stage_) {
    stage_ = step.stage;
    recent_.clear();
  }
  recent_.emplace_back(now, step.done);
  while (recent_.size() > 2 && SecondsBetween(recent_[1].first, now) > kRateWindow) recent_.pop_front();
  const double seconds = SecondsBetween(recent_.front().first, now);
  const auto steps = static_cast<double>(step.done - recent_.front().second);
  if (seconds <= 0 || steps <= 0) return {};
  if (step.total <= 0) return {steps / seconds, 0};
  return {steps / seconds, static_cast<double>(step.total - step.done) * seconds / steps};
}

RunProgress::Row* RunProgress::Find(const std::string& stage) {
  const auto row = std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.stage == stage; });
  return row == rows_.end() ? nullptr : &*row;
}

void RunProgress::Add(const Event& event, Clock::time_point now) {
  if (const auto* planned = std::get_if<RunPlanned>(&event)) {
    rows_.clear();
    current_.clear();
    for (const auto& p : planned->stages) rows_.push_back({p.stage, p.seconds, std::nullopt});
  } else if (const auto* start = std::get_if<StageStarted>(&event)) {
    if (Find(start->stage) == nullptr) return;
    current_ = start->stage;
    since_ = now;
  } else if (const auto* end = std::get_if<StageFinished>(&event)) {
    if (Row* row = Find(end->stage)) row->took = end->seconds;
    if (end->stage == current_) current_.clear();
  } else if (const auto* kept = std::get_if<StageKept>(&event)) {
    // A stage that was read back took no time worth planning by.
    if (Row* row = Find(kept->stage)) row->planned = 0, row->took = 0;
  }
}

std::optional<RunProgress::Place> RunProgress::PlaceOf(const std::string& stage) const {
  for (size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].stage == stage)
      return Place{static_cast<int>(i) + 1, static_cast<int>(rows_.size()), rows_[i].planned};
  }
  return std::nullopt;
}

double RunProgress::Slowness() const {
  double planned = kPriorSeconds, took = kPriorSeconds;
  for (const Row& row : rows_) {
    if (!row.took || *row.took < kUsualSlowness[0] * row.planned || *row.took > kUsualSlowness[1] * row.planned)
      continue;
    planned += row.planned, took += *row.took;
  }
  return took / planned;
}

double RunProgress::SecondsLeft(double stage_left, Clock::time_point now) const {
  const double slowness = Slowness();
  double left = 0;
  for (const Row& row : rows_) {
    if (row.took) continue;
    if (row.stage != current_) {
      if (row.planned <= 0) return 0;
      left += row.planned * slowness;
    } else if (stage_left > 0) {
      left += stage_left;
    } else {
      const double spent = std::chrono::duration<double>(now - since_).count();
      left += std::max(0.0, row.planned * slowness - spent);
    }
  }
  return left;
}

}  // namespace oraclegs
