// The program: runs the command line, reports what it throws. Exit codes: 0, 2 usage, 3 bad input, 4 failed run,
// 130 interrupted.

#include <csignal>
#include <exception>
#include <filesystem>
#include <new>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "program.h"

namespace oraclegs {
namespace {

constexpr int kFailed = 4;
constexpr const char* kMemoryAdvice =
    "out of memory; lower --max-gaussians or --random-points, or raise --downscale, and run the same command again";

int Main(int argc, char** argv) {
  InstallInterruptHandlers();
  std::signal(SIGPIPE, SIG_IGN);  // `oraclegs info ... | head` is no crash
  std::signal(SIGXFSZ, SIG_IGN);  // a file that outgrows its limit is reported as a failed write
  try {
    Program program;
    return program.Run(argc, argv);
  } catch (const Error& e) {
    return Fail(e.what(), e.exit_code());
  } catch (const std::bad_alloc&) {
    return Fail(kMemoryAdvice, kFailed);
  } catch (const std::filesystem::filesystem_error& e) {
    return Fail(fmt::format("{}: {}", e.path1().string(), e.code().message()), kFailed);
  } catch (const std::exception& e) {
    return Fail(fmt::format("internal error, please report it: {}", e.what()), kFailed);
  }
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) { return oraclegs::Main(argc, argv); }
