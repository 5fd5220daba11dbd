#include "oraclegs/core/error.h"

#include <cerrno>

#include "oraclegs/core/text.h"

namespace oraclegs {

Error::Error(const std::string& text) : std::runtime_error(OneLine(text)) {}

std::string SystemReason(int error) { return SystemReason(std::error_code(error, std::generic_category())); }

std::string SystemReason(const std::error_code& error) {
  const bool is_full = error == std::errc::no_space_on_device || error.value() == EDQUOT;
  return error.message() + (is_full ? "; make room there" : "");
}

}  // namespace oraclegs
