#pragma once

#include <string>
#include <system_error>

namespace oraclegs {

/// The system's words for an errno, with how to fix it where that is known: "No space left on device; make room there".
std::string SystemReason(int error);
std::string SystemReason(const std::error_code& error);

}  // namespace oraclegs
