#include "terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

using std::chrono::duration;

constexpr double kRedrawSeconds = 0.1;
constexpr double kLineSeconds = 10;  // between plain lines, unless a tenth of the work is done sooner
constexpr double kMinLineSeconds = 1;
constexpr int kBarWidth = 24;

size_t TerminalWidth() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
}

/// "700/7000 iterations (10%)"; without the share where nobody knows how many there will be.
std::string CountText(const StepDone& event) {
  if (event.total <= 0) return fmt::format("{} {}", event.done, event.unit);
  return fmt::format("{}/{} {} ({}%)", event.done, event.total, event.unit, 100 * event.done / event.total);
}

std::string RateText(double per_second) {
  if (per_second <= 0) return "";
  return per_second >= 1 ? fmt::format(", {:.1f}/s", per_second) : fmt::format(", {:.1f} s each", 1 / per_second);
}

}  // namespace

void WriteOut(const std::string& text) {
  std::fputs(ForTerminal(text).c_str(), stdout);
  std::fflush(stdout);
}

void WriteError(const std::string& text) { std::fprintf(stderr, "oraclegs: error: %s\n", OneLine(text).c_str()); }

Terminal::Terminal(Verbosity verbosity)
    : verbosity_(verbosity), bar_(verbosity != Verbosity::kQuiet && isatty(STDERR_FILENO)) {
  SetVerbosity(verbosity);
}

Terminal::~Terminal() { EraseBar(); }

Listener Terminal::AsListener() {
  return [this](const Event& event) {
    run_.Add(event);
    std::visit([this](const auto& e) { On(e); }, event);
  };
}

void Terminal::On(const RunPlanned& event) {
  EraseBar();
  double total = 0;
  std::string parts;
  for (const auto& [stage, seconds] : event.stages) {
    if (seconds <= 0) return;  // a total without it would be too low
    total += seconds;
    parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", stage, FormatSeconds(seconds));
  }
  if (total > 0) Log().info("about {} in total: {}", FormatSeconds(total), parts);
}

void Terminal::On(const StageStarted& event) {
  EraseBar();
  rate_.Clear();
  const auto place = run_.PlaceOf(event.stage);
  const std::string about = place && place->seconds > 0 ? ", about " + FormatSeconds(place->seconds) : "";
  Log().info("{}: started{}", Numbered(event.stage), about);
}

void Terminal::On(const StageFinished& event) {
  EraseBar();
  rate_.Clear();
  const double left = run_.SecondsLeft(0);
  Log().info("{}: done in {}{}", Numbered(event.stage), FormatSeconds(event.seconds),
             left > 0 ? fmt::format(", {} left", FormatSeconds(left)) : "");
}

std::string Terminal::Numbered(const std::string& stage) const {
  const auto place = run_.PlaceOf(stage);
  return place ? fmt::format("[{}/{}] {}", place->number, place->of, stage) : stage;
}

std::string Terminal::LeftText(const StepDone& event, double stage_left) const {
  const double of_run = run_.PlaceOf(event.stage) ? run_.SecondsLeft(stage_left) : 0;
  const double left = of_run > 0 ? of_run : stage_left;
  return left > 0 ? FormatSeconds(left) + " left" : "";
}

void Terminal::On(const FileWritten& event) {
  EraseBar();
  Log().info("wrote {}", event.path.string());
}

void Terminal::On(const Warning& event) {
  EraseBar();
  Log().warn("{}", event.text);
}

void Terminal::On(const Note& event) {
  EraseBar();
  Log().info("{}", event.text);
}

void Terminal::On(const StepDone& event) {
  if (verbosity_ == Verbosity::kQuiet) return;
  const StepRate::Speed rate = Measure(event);
  if (!IsTimeForALine(event)) return;
  if (bar_) return DrawBar(event, rate);
  const std::string left = LeftText(event, rate.seconds_left);
  Log().info("{}: {}{}{}{}{}{}", Numbered(event.stage), left, left.empty() ? "" : ", ", CountText(event),
             RateText(rate.per_second), event.detail.empty() ? "" : ", ", event.detail);
}

StepRate::Speed Terminal::Measure(const StepDone& event) {
  if (event.stage != rate_.stage()) {
    last_line_ = bar_ ? Clock::time_point{} : Clock::now();
    last_tenth_ = event.total > 0 ? 10 * event.done / event.total : 0;
  }
  return rate_.Add(event);
}

bool Terminal::IsTimeForALine(const StepDone& event) {
  const double waited = duration<double>(Clock::now() - last_line_).count();
  const int64_t tenth = event.total > 0 ? 10 * event.done / event.total : 0;
  const bool due = bar_ ? waited >= kRedrawSeconds || event.done == event.total
                        : waited >= kLineSeconds || (tenth > last_tenth_ && waited >= kMinLineSeconds);
  if (!due) return false;
  last_line_ = Clock::now();
  last_tenth_ = tenth;
  return true;
}

void Terminal::DrawBar(const StepDone& event, const StepRate::Speed& rate) {
  // A narrow terminal cuts the end of the line: what people wait for comes first.
  std::string line = Numbered(event.stage) + " ";
  if (const std::string left = LeftText(event, rate.seconds_left); !left.empty()) line += left + " ";
  if (event.total > 0) {
    const auto filled = static_cast<int>(kBarWidth * event.done / event.total);
    line += fmt::format("[{:#>{}}{:->{}}] ", "", filled, "", kBarWidth - filled);
  }
  line += CountText(event) + RateText(rate.per_second);
  if (!event.detail.empty()) line += ", " + event.detail;
  line.resize(std::min(line.size(), TerminalWidth() - 1));
  std::fprintf(stderr, "\r\x1b[K%s", OneLine(line).c_str());
  std::fflush(stderr);
  drawn_ = true;
}

void Terminal::EraseBar() {
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace oraclegs
