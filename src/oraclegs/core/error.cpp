#include "oraclegs/core/error.h"

#include "oraclegs/core/text.h"

namespace oraclegs {

Error::Error(const std::string& text) : std::runtime_error(OneLine(text)) {}

}  // namespace oraclegs
