#include "oraclegs/core/log.h"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <memory>
#include <string>
#include <utility>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

spdlog::level::level_enum LevelOf(Verbosity verbosity) {
  switch (verbosity) {
    case Verbosity::kQuiet:
      return spdlog::level::warn;
    case Verbosity::kNormal:
      return spdlog::level::info;
    case Verbosity::kVerbose:
      return spdlog::level::debug;
  }
  return spdlog::level::info;
}

/// The message as one line: what files and other programs say goes into it.
class LineOfLog : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& to) override {
    const std::string line = OneLine({message.payload.data(), message.payload.size()});
    to.append(line.data(), line.data() + line.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<LineOfLog>(); }
};

std::unique_ptr<spdlog::logger> MakeLogger() {
  auto logger = std::make_unique<spdlog::logger>("oraclegs", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<LineOfLog>('*').set_pattern("%^%l%$: %*");
  logger->set_formatter(std::move(formatter));
  logger->set_level(LevelOf(Verbosity::kNormal));
  logger->flush_on(spdlog::level::debug);
  return logger;
}

}  // namespace

spdlog::logger& Log() {
  static const std::unique_ptr<spdlog::logger> logger = MakeLogger();
  return *logger;
}

void SetVerbosity(Verbosity verbosity) { Log().set_level(LevelOf(verbosity)); }

}  // namespace oraclegs
