#pragma once
// From what VGGT says of its input to cameras in the photographs' own pixels and a cloud of points
// (docs/method.md#vggt-camera-head, docs/method.md#vggt-cameras-and-cloud).

#include <string>
#include <vector>

#include "oraclegs/networks/networks.h"
#include "oraclegs/networks/vggt/input.h"
#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs::vggt {

/// The cameras of the photographs, in the pixels of the photographs as they were before PrepareInput; `names` are
/// theirs, for errors. Throws InputError naming the photographs whose focal length is infinite or whose camera is not
/// finite.
std::vector<Camera> ImageCameras(const Tensor& encoding, const Input& input, const std::vector<Image8>& photos,
                                 const std::vector<std::string>& names);

/// What a cloud is made from; one of each for every photograph. The referenced objects must outlive it.
struct CloudSources {
  const std::vector<Camera>& cameras;  ///< ImageCameras
  const std::vector<Image8>& photos;
  const Input& input;
  const DepthPrediction& depth;
};

/// Points on a lattice of pixels over all photographs, about `most` before they are sifted: the surer half of the depth
/// counts, and a point only where the depth of at least one other photograph has the same surface, to 5 %.
std::vector<CloudPoint> MakeCloud(const CloudSources& sources, size_t most);

}  // namespace oraclegs::vggt
