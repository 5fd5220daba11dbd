#pragma once
// A program and its children, none of which outlives this process.

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace oraclegs {

struct ProgramStart {
  const std::vector<std::string>& argv;                               ///< argv[0] is found in PATH
  const std::vector<std::pair<std::string, std::string>>& variables;  ///< environment variables, beside this process's
  int input = -1;                                                     ///< becomes stdin; -1 = nothing is read
  int output = -1;                                                    ///< becomes stdout; -1 = that of this process
  int errors = -1;                                                    ///< becomes stderr, likewise
};

inline constexpr int kKilledBySignal = 128;  ///< exit_code() is this plus the signal: the shell's convention

/// A running program in a process group of its own. The group is ended with the object, and when this process dies,
/// however it dies; the folder locks that this process had (core/folder_lock.h) stay held until then. A child that
/// leaves the group (setsid) is let go.
class ProcessGroup {
 public:
  /// start_error() tells why when nothing runs. The descriptors are the caller's to close.
  explicit ProcessGroup(const ProgramStart& start);
  ~ProcessGroup() { End(); }
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;

  /// errno of the start; 0 = it runs.
  int start_error() const { return start_error_; }

  /// Whether the program has ended; its children may still run.
  bool HasEnded() const;

  /// Ends what runs of the group: SIGTERM, and after three seconds SIGKILL.
  void End();

  /// After End(): of the program, 128 + n when signal n ended it.
  int exit_code() const;

  /// After End(): the largest memory that the program, or one of its children that it waited for, held at once; at
  /// least what this process held when it started the program. 0 = nothing was started.
  int64_t peak_bytes() const { return peak_bytes_; }

  /// Seconds that the processes of the group have computed so far.
  double CpuSeconds() const;

 private:
  pid_t program_ = 0;  ///< also the number of the group; 0 = ended and waited for
  pid_t guard_ = 0;    ///< ends the group when this process dies
  int guard_pipe_ = -1;
  int status_ = 0;
  int start_error_ = 0;
  int64_t peak_bytes_ = 0;
};

}  // namespace oraclegs
