#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/experiments/launch/slurm_launcher.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"
#include "support/wait_until.h"

namespace oraclegs {

/// Jobs that note that they ran, and a launcher for them.
class SlurmJobs : public testing::Test {
 protected:
  SlurmJobs() { options_.poll_seconds = 0.05; }
  ~SlurmJobs() override { RequestInterrupt(false); }

  /// A job that notes that it began, then does `body`.
  Job Shell(const std::string& name, const std::string& body) const {
    return {.name = name,
            .command = {"bash", "-c", "echo \"$1\" >>\"$2\"; " + body, "job", name, (dir_ / "ran").string()},
            .log = dir_ / "logs" / (name + ".log")};
  }
  /// The ends by name of job.
  std::map<std::string, JobResult> Run(const std::vector<Job>& jobs) {
    std::map<std::string, JobResult> ends;
    MakeSlurmLauncher(options_, folder_)
        ->Run(
            jobs,
            [&](size_t job, const JobResult& result) {
              EXPECT_TRUE(ends.emplace(jobs[job].name, result).second) << jobs[job].name << " ended twice";
            },
            events_.AsListener());
    EXPECT_EQ(ends.size(), jobs.size());
    return ends;
  }
  /// How often a job began.
  int Starts(const std::string& name) const {
    std::ifstream file(dir_ / "ran");
    int starts = 0;
    for (std::string line; std::getline(file, line);) starts += line == name ? 1 : 0;
    return starts;
  }
  void WaitForStart(const std::string& name) const {
    ASSERT_TRUE(WaitUntil([&] { return Starts(name) > 0; }));
  }

  TempDir dir_;
  std::filesystem::path folder_ = dir_ / "slurm of it's";  // a path that has to be quoted
  SlurmOptions options_;
  EventRecorder events_;
};

/// A bash process that holds that many megabytes until the batch script has noted them in its file N.memory; two
/// minutes at most.
inline std::string HoldMemory(int megabytes, const std::filesystem::path& noted) {
  const std::string file = ShellQuoted(noted.string());
  return fmt::format(
      "x=$(head -c {0}000000 /dev/zero | tr '\\0' a); for i in {{1..1200}}; do "
      "[[ -e {1} ]] && (($(<{1}) > {0}000)) && break; sleep 0.1; done; echo ${{#x}}",
      megabytes, file);
}

/// Starts the launcher in a process of its own. Returns its process number.
template <class Body>
pid_t Fork(Body&& body) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      body();
    } catch (...) {
      _exit(1);
    }
    _exit(0);
  }
  return child;
}

}  // namespace oraclegs
