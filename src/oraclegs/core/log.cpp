#include "oraclegs/core/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>

#include <memory>

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

std::unique_ptr<spdlog::logger> MakeLogger() {
  auto logger = std::make_unique<spdlog::logger>("oraclegs", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger->set_pattern("%^%l%$: %v");
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
