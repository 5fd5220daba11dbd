#pragma once

#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// The command that opens `url`: the first one of $BROWSER (commands between colons, %s stands for the address), else
/// xdg-open where there is a display. Nothing where neither is there. No shell sees it.
std::optional<std::vector<std::string>> BrowserCommand(const std::string& url);

/// Starts that command, which goes on by itself. False when there is none, or when it fails at once.
bool OpenBrowser(const std::string& url);

}  // namespace oraclegs
