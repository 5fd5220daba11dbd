#pragma once
// The report as one file that opens offline.

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace oraclegs {

/// The page report.html with its style, its script and the run document. It needs no other file and no network when
/// every "url" of the document is a data: URI. Text of the document cannot end its element: "<" is escaped. Throws
/// RunError when the pages were not built (assets.h).
std::string SelfContainedPage(const nlohmann::json& document);

}  // namespace oraclegs
