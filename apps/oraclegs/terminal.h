#pragma once
// What the user sees while a stage runs.

#include <chrono>
#include <string>

#include "oraclegs/core/log.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/core/run_progress.h"

namespace oraclegs {

// All that the program prints passes one of the two below or core/log.h, which replace what steers a terminal: names
// and texts of files go into it.

/// Prints to stdout, tabs and ends of lines as they are.
void WriteOut(const std::string& text);

/// Prints the line of an error to stderr.
void WriteError(const std::string& text);

/// Shows events on stderr: on a terminal one line that is drawn again and again, elsewhere a plain line about every ten
/// seconds or ten percent; with kQuiet only warnings.
class Terminal {
 public:
  explicit Terminal(Verbosity verbosity);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  Listener AsListener();

 private:
  using Clock = std::chrono::steady_clock;
  void On(const RunPlanned& event);
  void On(const StageStarted& event);
  void On(const StepDone& event);
  void On(const StageFinished& event);
  void On(const StageKept&) {}  ///< notes say what matters of it
  void On(const FileWritten& event);
  void On(const Warning& event);
  void On(const Note& event);

  /// "[2/7] depth"; the name alone where nothing was planned.
  std::string Numbered(const std::string& stage) const;
  /// "9:30 left": of the whole run where that is known, else of the stage; "" where nobody knows
  std::string LeftText(const StepDone& event, double stage_left) const;
  StepRate::Speed Measure(const StepDone& event);
  bool IsTimeForALine(const StepDone& event);
  void DrawBar(const StepDone& event, const StepRate::Speed& rate);
  void EraseBar();

  Verbosity verbosity_;
  bool bar_;            ///< stderr is a terminal
  bool drawn_ = false;  ///< the cursor stands on a drawn line
  StepRate rate_;
  RunProgress run_;
  Clock::time_point last_line_;
  int64_t last_tenth_ = 0;
};

}  // namespace oraclegs
