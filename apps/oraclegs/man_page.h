#pragma once

#include <string>

#include "command_info.h"

namespace oraclegs {

/// oraclegs(1) in roff (the macros of man(7)): every command with all its options. Options that several commands share
/// are explained once, with the first of them.
std::string ManPage(const Catalog& commands, const std::string& version);

}  // namespace oraclegs
