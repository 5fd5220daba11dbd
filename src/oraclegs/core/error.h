#pragma once
// Errors are typed by who can fix their cause; the program's exit code follows from the type.

#include <fmt/format.h>
#include <fmt/ranges.h>  // fmt::join; since fmt 11 no longer in format.h

#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace oraclegs {

/// Base of everything the library throws on purpose. what() is one line: where, what was found, how to fix it. Texts
/// out of files come into messages; their control characters become '?'.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& text);
  virtual int exit_code() const { return 4; }
};

/// The command line or a configuration file is wrong: a user error, exit code 2.
class UsageError : public Error {
 public:
  template <class... Args>
  explicit UsageError(fmt::format_string<Args...> format, Args&&... args)
      : Error(fmt::format(format, std::forward<Args>(args)...)) {}
  int exit_code() const override { return 2; }
};

/// A file or folder given as input is wrong: a user error, exit code 3. The message names the file and how to fix
/// it.
class InputError : public Error {
 public:
  template <class... Args>
  explicit InputError(fmt::format_string<Args...> format, Args&&... args)
      : Error(fmt::format(format, std::forward<Args>(args)...)) {}
  int exit_code() const override { return 3; }
};

/// The run failed for a reason outside the input (disk full, a child program died, out of memory): exit code 4.
class RunError : public Error {
 public:
  template <class... Args>
  explicit RunError(fmt::format_string<Args...> format, Args&&... args)
      : Error(fmt::format(format, std::forward<Args>(args)...)) {}
};

/// Memory ended. The message says how much of it was needed for what, and which options lower it. Whoever catches it
/// may go on.
class OutOfMemory : public RunError {
 public:
  using RunError::RunError;
};

/// SIGINT, SIGTERM or SIGHUP was received and the work stopped at a safe point: exit code 130.
class Interrupted : public Error {
 public:
  using Error::Error;
  int exit_code() const override { return 130; }
};

/// An array has the wrong shape: a bug of the caller.
class ShapeError : public std::logic_error {
 public:
  template <class... Args>
  explicit ShapeError(fmt::format_string<Args...> format, Args&&... args)
      : std::logic_error(fmt::format(format, std::forward<Args>(args)...)) {}
};

/// The system's words for an errno, with how to fix it where that is known: "No space left on device; make room there".
std::string SystemReason(int error);
std::string SystemReason(const std::error_code& error);

}  // namespace oraclegs
