#pragma once
// From what VGGT says of its input to cameras in the photographs' own pixels and a cloud of points
// (docs/method.md#vggt-camera-head, docs/method.md#vggt-cameras-and-cloud).

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/image/image.h"
#include "oraclegs/networks/vggt/input.h"
#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs {

/// The cameras of the photographs, in the pixels of the photographs as they were before PrepareVggtInput; `names` are
/// theirs, for errors. Throws InputError naming the photographs whose focal length is infinite or whose camera is not
/// finite.
std::vector<Camera> PhotographCameras(const Tensor& encoding, const VggtInput& input, const std::vector<Image8>& photos,
                                      const std::vector<std::string>& names);

/// Where a point stands in one photograph.
struct CloudSight {
  int photograph = 0;
  Eigen::Vector2d pixel;  ///< from the photograph's top-left corner
};

struct CloudPoint {
  Eigen::Vector3d xyz;
  std::array<uint8_t, 3> rgb{};
  std::vector<CloudSight> sights;  ///< at least two, by photograph
};

/// What a cloud is made from; one of each for every photograph. The referenced objects must outlive it.
struct CloudSources {
  const std::vector<Camera>& cameras;  ///< PhotographCameras
  const std::vector<Image8>& photos;
  const VggtInput& input;
  const DepthPrediction& depth;
};

/// Points on a lattice of pixels over all photographs, about `most` before they are sifted: the surer half of the depth
/// counts, and a point only where the depth of at least one other photograph has the same surface, to 5 %.
std::vector<CloudPoint> MakeCloud(const CloudSources& sources, size_t most);

}  // namespace oraclegs
