#pragma once
// One run after the other, by processes that go on when the app ends.

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "oraclegs/app/library.h"

namespace oraclegs {

/// Words of the command line that reconstructs a project from what was uploaded to it.
std::vector<std::string> ReconstructArgv(const std::filesystem::path& program, const Project& project);

/// Starts the project that waits longest when no other one runs or is paused. The queue is in the projects' records:
/// a later app goes on with it.
class RunQueue {
 public:
  /// `program` is this program. The library must live longer.
  RunQueue(std::filesystem::path program, Library* library);
  ~RunQueue();
  RunQueue(const RunQueue&) = delete;
  RunQueue& operator=(const RunQueue&) = delete;

  /// Lets a project wait for its turn. Throws InputError where it has fewer than three photos and nothing else.
  void Add(const Project& project, const std::string& quality, const std::string& device);
  /// Stops a run, which keeps the best splat so far; one that waits leaves the queue.
  void Stop(const Project& project);
  /// False where nothing runs or nothing is paused.
  static bool Pause(const Project& project);
  static bool Resume(const Project& project);

  /// 1 = starts next; 0 = does not wait.
  int PositionOf(const Project& project) const;

 private:
  void Work();
  void StartNext();

  std::filesystem::path program_;
  Library* library_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace oraclegs
