#pragma once
// Shell completion: commands, options, words and paths, from what the commands say of themselves.

#include <string>

#include "command_info.h"

namespace oraclegs {

/// The script for "bash", "zsh" or "fish". Throws UsageError for another shell.
std::string CompletionOf(const std::string& shell, const Catalog& commands);

}  // namespace oraclegs
