// oraclegs.reconstruct: a run in this process. It works in a thread of its own; the thread that called it delivers
// events to the callback and looks for Ctrl-C.

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "bindings.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/image.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/settings/named_options.h"

namespace oraclegs::python {
namespace {

constexpr auto kPause = std::chrono::milliseconds(50);  // between two looks for Ctrl-C

/// Events on their way from the run to the thread that called it.
class EventQueue {
 public:
  void Push(Event event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
    changed_.notify_one();
  }
  void Finish() {
    const std::lock_guard lock(mutex_);
    finished_ = true;
    changed_.notify_one();
  }
  /// The next event, nothing after a pause without one. `finished`: the run has ended and all events were taken.
  std::optional<Event> Pop(bool* finished) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPause, [&] { return finished_ || !events_.empty(); });
    *finished = finished_ && events_.empty();
    if (events_.empty()) return std::nullopt;
    Event event = std::move(events_.front());
    events_.pop_front();
    return event;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Event> events_;
  bool finished_ = false;
};

/// Calls progress(stage, done, total, detail).
void Report(const Event& event, const py::function& progress) {
  if (const auto* started = std::get_if<StageStarted>(&event)) {
    progress(started->stage, 0, 0, "started");
  } else if (const auto* step = std::get_if<StepDone>(&event)) {
    progress(step->stage, step->done, step->total, step->detail.empty() ? step->unit : step->detail);
  } else if (const auto* finished = std::get_if<StageFinished>(&event)) {
    progress(finished->stage, 1, 1, "finished");
  } else if (const auto* kept = std::get_if<StageKept>(&event)) {
    progress(kept->stage, 1, 1, "kept");
  } else if (const auto* note = std::get_if<Note>(&event)) {
    progress("note", 0, 0, note->text);
  }
}

void WarnInPython(const Event& event) {
  const auto* warning = std::get_if<Warning>(&event);
  if (!warning) return;
  if (PyErr_WarnEx(PyExc_UserWarning, OneLine(warning->text).c_str(), 2) != 0) throw py::error_already_set();
}

/// One run at a time in a process: a request to stop it concerns all.
class OnlyRun {
 public:
  OnlyRun() {
    if (busy_.exchange(true)) throw UsageError("another run is going on in this process; wait for it");
    RequestInterrupt(false);
  }
  ~OnlyRun() {
    RequestInterrupt(false);
    busy_ = false;
  }

 private:
  static inline std::atomic<bool> busy_ = false;
};

RunRequest RequestOf(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& out,
                     const std::string& options, bool overwrite) {
  RunRequest request;
  if (inputs.empty()) throw UsageError("there is nothing to reconstruct; name a folder of photos");
  request.inputs = inputs;
  request.out = out;
  request.overwrite = overwrite;
  request.version = ORACLEGS_VERSION;
  SetRunOptions(nlohmann::json::parse(options), UnknownOption::kError, &request.options);
  return request;
}

/// Returns the text of metrics.json. `options` is the text of a JSON object.
std::string RunReconstruct(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& out,
                           const std::string& options, bool overwrite, const std::optional<py::function>& progress) {
  const RunRequest request = RequestOf(inputs, out, options, overwrite);
  const OnlyRun only;
  SetNumThreads(request.options.machine.threads);
  SetMaxMegapixels(request.options.file_limits.max_megapixels);
  EventQueue queue;
  std::string metrics;
  std::exception_ptr failure, of_python;
  std::thread run([&] {
    try {
      metrics = Reconstruct(request, [&](const Event& event) { queue.Push(event); }).dump();
    } catch (...) {
      failure = std::current_exception();
    }
    queue.Finish();
  });
  for (bool finished = false; !finished;) {
    std::optional<Event> event;
    {
      const py::gil_scoped_release release;
      event = queue.Pop(&finished);
    }
    if (of_python) continue;  // the run is on its way to a safe point
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (event) WarnInPython(*event);
      if (event && progress) Report(*event, *progress);
    } catch (...) {
      of_python = std::current_exception();
      RequestInterrupt(true);
    }
  }
  run.join();
  if (of_python) std::rethrow_exception(of_python);
  if (failure) std::rethrow_exception(failure);
  return metrics;
}

}  // namespace

void BindRun(py::module_& m) {
  m.def("reconstruct", &RunReconstruct);
  m.def("option_names", &RunOptionNames);
}

}  // namespace oraclegs::python
