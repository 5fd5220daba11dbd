#pragma once
// The pages of web/ that are part of the program: HTML, scripts and styles of the viewer and of the report.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace oraclegs {

/// An embedded file. The bytes live as long as the program.
struct WebAsset {
  std::string_view bytes;
  std::string_view type;  ///< MIME type for the Content-Type header, with the charset of texts
};

/// The embedded file of that name: "viewer.html", "viewer.js", "viewer.css", "report.html" (the template of
/// SelfContainedPage), "report.js", "report.css". nullopt for any other name, and for every name when the pages were
/// not built.
std::optional<WebAsset> FindWebAsset(std::string_view name);

/// Whether the pages are part of this program. They are when web/node_modules existed at build time.
bool WebPagesBuilt();

/// Advice on how to get the pages, the end of a message: one sentence without a full stop.
std::string_view HowToBuildWebPages();

/// The report as one file that opens offline: the page report.html with its style, its script and the run document. It
/// needs no other file and no network when every "url" of the document is a data: URI. Text of the document cannot end
/// its element: "<" is escaped. Throws RunError when the pages were not built.
std::string SelfContainedPage(const nlohmann::json& document);

}  // namespace oraclegs
