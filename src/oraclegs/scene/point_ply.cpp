#include "oraclegs/scene/point_ply.h"

#include <fmt/format.h>

#include <iterator>
#include <string>

#include "oraclegs/core/files.h"

namespace oraclegs {

void WritePointPly(const std::filesystem::path& path, const std::vector<ScenePoint>& points) {
  std::string ply = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      points.size());
  for (const ScenePoint& p : points) {
    fmt::format_to(std::back_inserter(ply), "{:.9g} {:.9g} {:.9g} {} {} {}\n", p.xyz.x(), p.xyz.y(), p.xyz.z(),
                   p.rgb[0], p.rgb[1], p.rgb[2]);
  }
  WriteFileAtomically(path, ply);
}

}  // namespace oraclegs
