#pragma once

#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// The command that opens `url`: the first one of $BROWSER (commands between colons, %s stands for the address), else
/// xdg-open where there is a display; nullopt where neither exists. It is run without a shell.
std::optional<std::vector<std::string>> BrowserCommand(const std::string& url);

/// Starts that command without waiting for its end. False when there is none, or when it fails at once.
bool OpenBrowser(const std::string& url);

}  // namespace oraclegs
