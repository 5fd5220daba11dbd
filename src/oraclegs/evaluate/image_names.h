#pragma once

#include <string>
#include <vector>

namespace oraclegs {

/// File names without extension for images of these views, in their order: "left/0001.jpg" becomes "left_0001". All
/// differ, and none is another with "_gt" added, so that NAME.png and NAME_gt.png of all views fit into one folder.
/// Views whose names would collide keep their extension ("1_jpg", "1_png"), and where even that is taken get a number
/// ("1_jpg_2").
std::vector<std::string> ImageNames(const std::vector<std::string>& views);

}  // namespace oraclegs
