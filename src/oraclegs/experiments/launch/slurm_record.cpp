#include "oraclegs/experiments/launch/slurm_record.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <string_view>
#include <thread>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/sha256.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/experiments/launch/slurm_programs.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr char kFile[] = "slurm.json";

constexpr std::string_view kNamePrefix = "oraclegs-";
constexpr size_t kNameDigits = 16;

/// True when names, numbers and folders have the form that this program writes. Jobs are found and cancelled by a
/// record, which somebody else may have written.
bool IsSound(const SlurmRecord& record) {
  const std::string_view name = record.name;
  if (!name.starts_with(kNamePrefix) || name.size() != kNamePrefix.size() + kNameDigits) return false;
  if (name.find_first_not_of("0123456789abcdef", kNamePrefix.size()) != std::string_view::npos) return false;
  const bool plain_cluster = std::all_of(record.cluster.begin(), record.cluster.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  });
  return plain_cluster && std::all_of(record.submissions.begin(), record.submissions.end(), [](const auto& submission) {
           return (submission.array.empty() || IsSlurmNumber(submission.array)) && IsSlurmNumber(submission.folder);
         });
}

SlurmRecord FromJson(const nlohmann::json& json) {
  SlurmRecord record;
  record.name = json.at("name").get<std::string>();
  record.cluster = json.at("cluster").get<std::string>();
  for (const nlohmann::json& from : json.at("submissions")) {
    SlurmRecord::Submission submission;
    submission.array = from.at("array").get<std::string>();
    submission.folder = from.at("folder").get<std::string>();
    for (const nlohmann::json& task : from.at("tasks")) {
      submission.tasks.push_back({task.at("job").get<std::string>(), task.at("command").get<std::string>(),
                                  task.at("attempt").get<int>(), task.at("open").get<bool>(),
                                  task.at("cancelled").get<bool>()});
    }
    record.submissions.push_back(std::move(submission));
  }
  return record;
}

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Slurm kills tasks that do not end by themselves after KillWait, 30 s by default.
constexpr std::chrono::minutes kCancelPatience(3);
constexpr std::chrono::milliseconds kFirstPause(50), kLongestPause(2000);

bool MayRun(const SlurmRecord& record) {
  return std::any_of(record.submissions.begin(), record.submissions.end(), [](const auto& submission) {
    return std::any_of(submission.tasks.begin(), submission.tasks.end(), [](const auto& task) { return task.open; });
  });
}

/// True when the record has this array, or an array whose number it does not know.
bool MayHave(const SlurmRecord& record, const std::string& array) {
  return std::any_of(record.submissions.begin(), record.submissions.end(),
                     [&](const auto& submission) { return submission.array.empty() || submission.array == array; });
}

std::vector<SlurmTaskId> ActiveTasks(const SlurmRecord& record) {
  std::vector<SlurmTaskId> active;
  for (const auto& [task, found] : QueueOfSlurm(record.name, record.cluster)) {
    if (found.state == SlurmState::kActive && MayHave(record, task.array)) active.push_back(task);
  }
  return active;
}

void Pause(std::chrono::milliseconds time) {
  constexpr std::chrono::milliseconds kStep(50);
  for (auto left = time; left.count() > 0; left -= kStep) {
    ThrowIfInterrupted();
    std::this_thread::sleep_for(std::min(left, kStep));
  }
}

}  // namespace

std::string SlurmCommandDigest(const Job& job) {
  Sha256 digest;
  for (const std::string& word : job.command) digest.Add(word).Add(std::string_view("\0", 1));
  return digest.Hex();
}

bool HasSlurmRecord(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / kFile, ignored);
}

SlurmRecord ReadSlurmRecord(const fs::path& folder) {
  const fs::path path = folder / kFile;
  if (!HasSlurmRecord(folder)) {
    std::random_device random;
    SlurmRecord record;
    record.name = fmt::format("{}{:08x}{:08x}", kNamePrefix, random() & 0xFFFFFFFFU, random() & 0xFFFFFFFFU);
    return record;
  }
  try {
    SlurmRecord record = FromJson(ParseUniqueJson(ReadFile(path), path.string(), "file"));
    if (IsSound(record)) return record;
  } catch (const nlohmann::json::exception&) {
  }
  throw InputError("{}: is damaged; end its jobs with scancel, if there are any, and remove the folder", path.string());
}

void WriteSlurmRecord(const fs::path& folder, const SlurmRecord& record) {
  nlohmann::json json = {{"program", "oraclegs"},
                         {"name", record.name},
                         {"cluster", record.cluster},
                         {"submissions", nlohmann::json::array()}};
  for (const SlurmRecord::Submission& submission : record.submissions) {
    nlohmann::json tasks = nlohmann::json::array();
    for (const SlurmRecord::Task& task : submission.tasks) {
      tasks.push_back({{"job", task.job},
                       {"command", task.command},
                       {"attempt", task.attempt},
                       {"open", task.open},
                       {"cancelled", task.cancelled}});
    }
    json["submissions"].push_back(
        {{"array", submission.array}, {"folder", submission.folder}, {"tasks", std::move(tasks)}});
  }
  WriteFileAtomically(folder / kFile, json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void CancelOpenSlurmTasks(const fs::path& folder, const Listener& listener) {
  if (!HasSlurmRecord(folder)) return;
  const SlurmRecord record = ReadSlurmRecord(folder);
  if (!MayRun(record)) return;
  RequireSlurm();
  const FolderLock lock(folder, std::chrono::seconds(5));  // programs of a killed process may still be ending
  if (lock.state() == FolderLock::State::kHeldByAnother) {
    throw RunError("{}: {} follows these jobs; wait for it or end it", folder.string(), lock.holder());
  }
  std::vector<SlurmTaskId> active = ActiveTasks(record);
  if (active.empty()) return;
  CancelInSlurm(record.name, active, record.cluster);
  listener(Note{fmt::format("cancelled {} of an earlier start in Slurm", Counted(active.size(), "job"))});
  const auto until = Clock::now() + kCancelPatience;
  for (auto pause = kFirstPause; !active.empty(); pause = std::min(pause * 2, kLongestPause)) {
    if (Clock::now() > until) {
      throw RunError("{}: {} of array {} in Slurm were cancelled and do not end; wait for that, then run this again",
                     folder.string(), Counted(active.size(), "job"), active.front().array);
    }
    Pause(pause);
    active = ActiveTasks(record);
  }
}

}  // namespace oraclegs
