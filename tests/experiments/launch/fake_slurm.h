#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "support/temp_dir.h"

namespace oraclegs {

/// sbatch, squeue, sacct and scancel that are found first while the scope lasts. sbatch really runs the tasks of an
/// array, as processes of this machine that outlive it. State is in files:
///   next              number of the last array
///   ID_TASK.state     PENDING, RUNNING, ...; a task may write its own last one to $FAKE_STATE_FILE
///   refuse, silent, killer, no_accounts   when they exist: what sbatch says; squeue fails; sbatch kills its parent
///                     once it has submitted; sacct keeps no accounts
///   asked             gets a line of each squeue that is silent
class FakeSlurm {
 public:
  FakeSlurm() : old_path_(std::getenv("PATH")) {
    for (const char* name : {"sbatch", "squeue", "sacct", "scancel"}) {
      WriteText(dir_ / "bin" / name, kScript);
      std::filesystem::permissions(dir_ / "bin" / name, std::filesystem::perms::owner_all);
    }
    std::filesystem::create_directories(dir_ / "state");
    setenv("FAKE_SLURM", (dir_ / "state").c_str(), 1);
    setenv("PATH", ((dir_ / "bin").string() + ":" + old_path_).c_str(), 1);
  }
  ~FakeSlurm() {
    // What still runs would write to the folder while it is removed.
    if (std::system("for f in \"$FAKE_SLURM\"/*.pid; do kill -s KILL -- -$(cat \"$f\"); done >/dev/null 2>&1") != 0) {
      // Nothing ran any more.
    }
    setenv("PATH", old_path_.c_str(), 1);
    unsetenv("FAKE_SLURM");
  }
  FakeSlurm(const FakeSlurm&) = delete;
  FakeSlurm& operator=(const FakeSlurm&) = delete;

  void Set(const std::string& name, const std::string& text = "") const { WriteText(dir_ / "state" / name, text); }
  void Unset(const std::string& name) const { std::filesystem::remove(dir_ / "state" / name); }
  std::string Get(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(dir_ / "state" / name).rdbuf();
    return text.str();
  }
  /// How often sbatch was called with success.
  int Arrays() const { return std::atoi(Get("next").c_str()); }
  /// Arguments of sbatch, a line each call.
  std::string Calls() const { return Get("calls"); }

 private:
  static constexpr const char* kScript = R"bash(#!/bin/bash
cd "$FAKE_SLURM" || exit 1
set_state() { echo "$2" >"$1.state.part" && mv "$1.state.part" "$1.state"; }

run_task() {  # ID TASK SCRIPT
  [[ $(cat "$1_$2.state") == PENDING ]] || return
  set_state "$1_$2" RUNNING
  echo $BASHPID >"$1_$2.pid"
  (
    cd "$directory" || exit 1
    export SLURM_ARRAY_JOB_ID=$1 SLURM_ARRAY_TASK_ID=$2 FAKE_STATE_FILE=$FAKE_SLURM/$1_$2.own FAKE_TASK=$1_$2
    bash "$3"
  )
  local code=$?
  [[ $(cat "$1_$2.state") == RUNNING ]] || return
  rm -f "$1_$2.pid"
  echo "$code" >"$1_$2.code"
  if [[ -e $1_$2.own ]]; then
    set_state "$1_$2" "$(cat "$1_$2.own")"
  elif ((code == 0)); then
    set_state "$1_$2" COMPLETED
  else
    set_state "$1_$2" FAILED
  fi
}

case ${0##*/} in
  sbatch)
    echo "$*" >>calls
    if [[ -e refuse ]]; then
      echo "sbatch: error: a line before" >&2
      echo "sbatch: error: $(cat refuse)" >&2
      exit 1
    fi
    for word in "$@"; do
      case $word in
        --array=*) range=${word#--array=} ;;
        --job-name=*) name=${word#--job-name=} ;;
      esac
    done
    limit=1000
    if [[ $range == *%* ]]; then
      limit=${range#*%}
      range=${range%\%*}
    fi
    export limit first=${range%-*} last=${range#*-} directory=$OLDPWD
    export id=$(($(cat next 2>/dev/null || echo 0) + 1))
    cp "${!#}" "$id.script"
    echo "$name" >"$id.name"
    for ((task = first; task <= last; ++task)); do set_state "${id}_$task" PENDING; done
    echo "$id" >next
    export -f run_task set_state
    setsid bash -c '
      touch "$id.up"
      for ((task = first; task <= last; ++task)); do
        if ((task - first >= limit)); then wait -n; fi
        setsid bash -c "run_task $id $task $FAKE_SLURM/$id.script" &
      done
      wait' </dev/null >/dev/null 2>&1 &
    until [[ -e $id.up ]]; do sleep 0.01; done  # or it ends with the group of this process
    if [[ -e killer ]]; then
      rm killer
      kill -KILL $PPID
      sleep 5
    fi
    echo "a word of the site"
    echo "$id"
    ;;
  squeue)
    if [[ -e silent ]]; then
      echo >>asked
      echo "slurm_load_jobs error: Unable to contact slurm controller (connect failure)" >&2
      exit 1
    fi
    for word in "$@"; do
      if [[ $word == --name=* ]]; then name=${word#--name=}; fi
    done
    for file in *.name; do
      [[ -e $file && $(cat "$file") == "$name" ]] || continue
      for state in "${file%.name}"_*.state; do
        task=${state%.state}
        echo "${task%_*}|${task#*_}|$(cat "$state")|None"
      done
    done
    ;;
  sacct)
    if [[ -e no_accounts ]]; then
      echo "Slurm accounting storage is disabled" >&2
      exit 1
    fi
    for state in *_*.state; do
      task=${state%.state}
      echo "$task|$(cat "$state")|$(cat "$task.code" 2>/dev/null || echo 0):0||3"
      echo "$task.batch|$(cat "$state")|0:0|2048K|3"
    done
    ;;
  scancel)
    echo "$*" >>cancelled
    for task in "$@"; do
      case $(cat "$task.state") in
        PENDING) set_state "$task" CANCELLED ;;
        RUNNING)
          set_state "$task" CANCELLED
          kill -TERM -- -"$(cat "$task.pid")"
          rm -f "$task.pid"
          ;;
      esac
    done
    ;;
esac
exit 0
)bash";

  TempDir dir_;
  std::string old_path_;
};

}  // namespace oraclegs
