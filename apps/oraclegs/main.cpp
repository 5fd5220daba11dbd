// The program: runs the command line, reports what it throws. Exit codes: 0, 2 usage, 3 bad input, 4 failed run,
// 130 interrupted.

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "program.h"

namespace oraclegs {
namespace {

constexpr int kFailed = 4;
constexpr const char* kMemoryAdvice =
    "out of memory; lower --max-gaussians or --set random-points, or raise --downscale, and run the same command again";

/// True when output was lost, other than because its reader ended or there is no output.
bool OutputIsLost() {
  const bool failed = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
  if (!failed || fcntl(STDOUT_FILENO, F_GETFD) < 0) return false;
  pollfd output{STDOUT_FILENO, 0, 0};
  return poll(&output, 1, 0) <= 0 || (output.revents & POLLERR) == 0;
}

int Main(int argc, char** argv) {
  InstallInterruptHandlers();
  std::signal(SIGPIPE, SIG_IGN);  // `oraclegs info ... | head` is no crash
  std::signal(SIGXFSZ, SIG_IGN);  // a file that outgrows its limit is reported as a failed write
  try {
    Program program;
    const int code = program.Run(argc, argv);
    return code == 0 && OutputIsLost() ? Fail("standard output: cannot be written; what was printed is lost", kFailed)
                                       : code;
  } catch (const Error& e) {
    return Fail(e.what(), e.exit_code());
  } catch (const std::bad_alloc&) {
    return Fail(kMemoryAdvice, kFailed);
  } catch (const std::filesystem::filesystem_error& e) {
    return Fail(fmt::format("{}: {}", e.path1().string(), SystemReason(e.code())), kFailed);
  } catch (const std::exception& e) {
    const std::string text = e.what();  // of some libraries, with a backtrace below
    return Fail("internal error, please report it: " + text.substr(0, text.find('\n')), kFailed);
  }
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) { return oraclegs::Main(argc, argv); }
