#include "oraclegs/sfm/known_poses.h"

namespace oraclegs {

void TriangulateAtPoses(const ColmapRunner& colmap, const std::filesystem::path& poses,
                        const std::filesystem::path& made, const ColmapOptions& more) {
  ColmapOptions options = more;
  options.insert({{"image_path", colmap.images().string()},
                  {"input_path", poses.string()},
                  {"output_path", made.string()},
                  {"clear_points", "1"},
                  {"Mapper.tri_ignore_two_view_tracks", "0"},
                  {"Mapper.ba_refine_focal_length", "0"},
                  {"Mapper.ba_refine_principal_point", "0"},
                  {"Mapper.ba_refine_extra_params", "0"},
                  {"Mapper.fix_existing_images", "1"}});
  colmap.Run("point_triangulator", options, "triangulating");
}

}  // namespace oraclegs
