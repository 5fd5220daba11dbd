#include "oraclegs/experiments/launch/slurm_script.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/experiments/launch/slurm_programs.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Script after the line that sets `folder`. It needs bash 4.3 and coreutils only. Processes that a command leaves
/// running end with the task, since Slurm ends all processes of a job.
constexpr const char* kScript = R"(task=$SLURM_ARRAY_TASK_ID
source "$folder/$task.sh"  # sets log, directory and the positional parameters: the command

# A file that is there is whole.
write() {
  printf '%s\n' "$2" >"$folder/$task.$1.part" && mv -f "$folder/$task.$1.part" "$folder/$task.$1"
}

microseconds() {
  if [[ -n ${EPOCHREALTIME:-} ]]; then
    now=${EPOCHREALTIME//[^0-9]/}
  else
    now=$(date +%s)000000
  fi
}

# The largest resident set so far of a process and of those that it started.
peak=0
see() {
  local key value rest children child
  while read -r key value rest; do
    if [[ $key == VmHWM: ]]; then
      if ((value > peak)); then peak=$value; fi
      break
    fi
  done <"/proc/$1/status"
  for children in /proc/"$1"/task/*/children; do
    started=()
    read -r -a started <"$children"
    for child in "${started[@]}"; do see "$child"; done
  done
}
watch_memory() {
  local largest=0
  while :; do
    see "$1"
    if ((peak > largest)); then
      largest=$peak
      write memory "$peak"
    fi
    sleep 1
  done
}

# Slurm sends it to the command, too: a second one would end that without a clean stop.
asked_to_end=0
trap 'asked_to_end=1' TERM

write start "$SLURM_ARRAY_JOB_ID"
microseconds
began=$now
cd -- "$directory" 2>>"$log" || {
  write end "1 0 0 0"
  exit 1
}
(
  trap - TERM
  exec "$@"
) </dev/null >>"$log" 2>&1 &
program=$!
watch_memory "$program" </dev/null >/dev/null 2>&1 &
watch=$!

# wait also returns when the trap has run.
while :; do
  wait "$program"
  code=$?
  kill -0 "$program" 2>/dev/null || break
done
# bash may lose an end that comes together with the signal: it would wait for as long as it has another child, and
# says 127 or -1 then.
kill "$watch" 2>/dev/null
wait "$program" 2>/dev/null
again=$?
if ((again >= 0 && again != 127)); then code=$again; fi
kilobytes=0
if [[ -r $folder/$task.memory ]]; then read -r kilobytes <"$folder/$task.memory"; fi
microseconds
write end "$code $((now - began)) $kilobytes $asked_to_end"
exit "$code"
)";

std::string Script(const fs::path& folder) {
  return "#!/bin/bash\n# Written by oraclegs. Slurm starts it for each task of an array.\nfolder=" +
         ShellQuoted(folder.string()) + "\n" + kScript;
}

std::string TaskFile(const Job& job) {
  std::string text = "# " + OneLine(job.name) + "\n";
  text += "log=" + ShellQuoted(fs::absolute(job.log).string()) + "\n";
  text += "directory=" + ShellQuoted(fs::current_path().string()) + "\n";
  text += "set --";
  for (const std::string& word : job.command) text += " " + ShellQuoted(word);
  return text + "\n";
}

}  // namespace

void WriteSlurmTasks(const fs::path& folder, const std::vector<Job>& jobs) {
  for (size_t task = 0; task < jobs.size(); ++task) {
    WriteFileAtomically(folder / fmt::format("{}.sh", task), TaskFile(jobs[task]));
    std::error_code ignored;  // the job's own output reports it better
    fs::create_directories(fs::absolute(jobs[task].log).parent_path(), ignored);
  }
  WriteFileAtomically(folder / "batch.sh", Script(folder));
}

std::optional<SlurmTaskEnd> ReadSlurmTaskEnd(const fs::path& folder, int task) {
  const fs::path path = folder / fmt::format("{}.end", task);
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return std::nullopt;
  try {
    std::istringstream text(ReadFile(path, 4096));
    double microseconds = 0;
    int64_t kilobytes = 0;
    SlurmTaskEnd end;
    if (!(text >> end.exit_code >> microseconds >> kilobytes >> end.asked_to_end)) return std::nullopt;
    end.seconds = std::max(0.0, microseconds * 1e-6);
    end.peak_bytes = std::max(int64_t{0}, kilobytes) * 1024;
    return end;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::string ArrayOfStartedTasks(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() != ".start") continue;
    try {
      const std::vector<std::string> words = SplitTrimmed(ReadFile(entry.path(), 4096), '\n');
      if (!words.empty() && IsSlurmNumber(words.front())) return words.front();
    } catch (const InputError&) {
      continue;  // another task's file may say it
    }
  }
  return "";
}

fs::path SlurmOutput(const fs::path& folder, int task) { return folder / fmt::format("slurm-{}.out", task); }

std::string SlurmOutputPattern(const fs::path& folder) {
  std::string pattern;
  for (const char c : folder.string()) pattern += c == '%' ? std::string("%%") : std::string(1, c);
  return pattern + "/slurm-%a.out";
}

}  // namespace oraclegs
