#pragma once
// Lists of views as users write them: "IMG_1.jpg,IMG_7", ":0,:8,:16", "@split.json".

#include <string>
#include <vector>

#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// The views that a list names, as indices into Scene::views, ascending, each once. An item is a view's name with or
/// without folder and extension, the most exact reading that fits any view decides; or :N, the N-th view by name, from
/// 0. `option` is the list's name in messages. Throws InputError for an item that is no view, could be several, or has
/// no image file.
std::vector<int> NamedViews(const Scene& scene, const std::string& option, const std::string& list);

/// A list that begins with @ names a file: one view a line (empty lines and those that begin with # do not count), or a
/// JSON object such as a run's split.json, whose array `role` ("train" or "test") is taken. Returns the names, joined
/// by commas; any other list is returned as it is. Throws InputError naming the file: unreadable, over 1 MiB, not
/// UTF-8, damaged JSON, without names, or with a name that holds a comma.
std::string ExpandViewList(const std::string& list, const std::string& role);

}  // namespace oraclegs
