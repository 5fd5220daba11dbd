#pragma once

#include <string>
#include <vector>

namespace oraclegs {

/// File names without extension for images of these views, in their order: "left/0001.jpg" becomes "left_0001". No
/// two are the same, and none is another with "_gt" added, so that NAME.png and NAME_gt.png of all views fit into one
/// folder. Where that would not be so, the views concerned keep their extension too ("1_jpg", "1_png"), and where even
/// that is taken they are numbered ("1_jpg_2").
std::vector<std::string> ImageNames(const std::vector<std::string>& views);

}  // namespace oraclegs
