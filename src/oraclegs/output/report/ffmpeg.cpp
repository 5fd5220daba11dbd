#include "oraclegs/output/report/ffmpeg.h"

#include <fmt/format.h>

#include "oraclegs/core/text.h"

namespace oraclegs {

std::string RunFfmpeg(ProcessRequest request) {
  request.errors_apart = true;
  request.stall_limit = StallLimit();
  const ProcessResult result = RunProcess(request);
  const std::string said = result.last_error.empty() ? "" : ": " + Printable(result.last_error);
  if (result.stalled) {
    return fmt::format("ffmpeg did nothing for {:g} s and was ended{}", request.stall_limit->count(), said);
  }
  if (result.exit_code != 0) return fmt::format("ffmpeg failed (exit code {}){}", result.exit_code, said);
  return "";
}

}  // namespace oraclegs
