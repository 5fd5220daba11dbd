#pragma once
// The folder colmap reads: photographs linked, grouped by camera, with masks where pixels must not count.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Where one view stands below work_dir/images.
struct StagedView {
  std::string name;     ///< "camera0/0001.jpg", unique, without blanks
  int camera = 0;       ///< views of one lens (of one size, when lenses are unknown) share it
  bool turned = false;  ///< the EXIF tag turns it: colmap ignores the tag, so an upright copy is written
};

/// One entry per element of `views`. Reads headers of the photographs, writes nothing.
/// Throws InputError for a photograph of unknown size that cannot be read.
std::vector<StagedView> PlanStaging(const Scene& scene, const std::vector<int>& views);

/// Makes work_dir/images and work_dir/masks anew as planned; returns whether there are masks. Photographs are linked,
/// and copied only where links are not possible. A mask (masks/NAME.png) joins the view's mask file and its alpha
/// channel: black where features must not be found.
/// Throws InputError for a photograph or mask that cannot be read, RunError when work_dir cannot be written.
bool StageImages(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                 const std::filesystem::path& work_dir);

/// What a result depends on: of each view name, content of photograph and mask, lens and pose. Throws InputError for a
/// file that cannot be read.
nlohmann::json DescribeInputs(const Scene& scene, const std::vector<int>& views);

}  // namespace oraclegs
