#pragma once
// From VGGT's outputs for its input to cameras in the images' own pixels and a cloud of points
// (docs/method.md#vggt-camera-head, docs/method.md#vggt-cameras-and-cloud).

#include <string>
#include <vector>

#include "oraclegs/networks/networks.h"
#include "oraclegs/networks/vggt/input.h"
#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs::vggt {

/// Cameras in the pixels of the images as they were before PrepareInput; `names` are the images', for errors. Throws
/// InputError naming the images whose focal length is infinite or whose camera is not finite.
std::vector<Camera> ImageCameras(const Tensor& encoding, const Input& input, const std::vector<Image8>& images,
                                 const std::vector<std::string>& names);

/// Sources of a cloud, one entry an image. The referenced objects must outlive it.
struct CloudSources {
  const std::vector<Camera>& cameras;  ///< ImageCameras
  const std::vector<Image8>& images;
  const Input& input;
  const DepthPrediction& depth;
};

/// Points on a lattice of pixels over all images, about `max_points` before selection. Selected are pixels in the
/// higher half of the depth confidence whose surface at least one other image's depth confirms to 5 %.
std::vector<CloudPoint> MakeCloud(const CloudSources& sources, size_t max_points);

}  // namespace oraclegs::vggt
