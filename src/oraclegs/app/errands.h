#pragma once
// Short work that the app has other processes of the program do: checks of photos, and exports.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "oraclegs/app/library.h"

namespace oraclegs {

/// A way in which a splat can be saved.
struct ExportFormat {
  const char* id;         ///< as the page names it
  const char* label;      ///< as people do
  const char* extension;  ///< of the file
};
const std::vector<ExportFormat>& ExportFormats();
/// nullptr for an id that is none.
const ExportFormat* FindExportFormat(const std::string& id);

/// Words of the command line that saves a project in a format to `file`.
std::vector<std::string> ExportArgv(const std::filesystem::path& program, const Project& project,
                                    const ExportFormat& format, const std::filesystem::path& file);

/// File of a project's export in a format.
std::filesystem::path ExportFile(const Project& project, const ExportFormat& format);

/// One thread that does one errand after the other; one that is asked for twice is done once.
class Errands {
 public:
  struct Outcome {
    std::string state = "none";  ///< none, running, done or failed
    std::string message;         ///< why it failed
    nlohmann::json result;       ///< of a check
  };

  /// `program` is this program.
  explicit Errands(std::filesystem::path program);
  ~Errands();
  Errands(const Errands&) = delete;
  Errands& operator=(const Errands&) = delete;

  /// Has the photos of a project looked at, once nothing has asked for it for a second: not after each of many photos.
  void Check(const Project& project);
  Outcome CheckOf(const std::string& project) const;
  /// Has a file of a project made.
  void Export(const Project& project, const ExportFormat& format);
  Outcome ExportOf(const std::string& project, const ExportFormat& format) const;
  /// Forgets what is known of a project that was deleted, or of an export whose splat or edits change.
  void Forget(const std::string& project);
  void ForgetExport(const std::string& project, const ExportFormat& format);

  /// Bytes of a project's folder, as they were counted last; counting goes on meanwhile.
  uint64_t BytesOf(const Project& project);

 private:
  using Clock = std::chrono::steady_clock;
  struct Task {
    std::string key;
    std::function<Outcome()> work;
    Clock::time_point due = Clock::now();  ///< begins then at the earliest
  };
  void Ask(Task task);
  void Work();
  Outcome Find(const std::string& key) const;

  std::filesystem::path program_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Task> tasks_;
  std::map<std::string, Outcome> outcomes_;
  std::map<std::string, std::pair<uint64_t, double>> sizes_;  ///< bytes, and when they were counted
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace oraclegs
