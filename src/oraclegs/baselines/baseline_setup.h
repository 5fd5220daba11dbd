#pragma once

#include <functional>

#include "oraclegs/baselines/settings.h"
#include "oraclegs/camera/camera.h"
#include "oraclegs/core/buffer.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// An inverse depth, up to a factor and an offset.
struct DepthTarget {
  Buffer<float> inv_depth;  ///< [H,W]
  Buffer<float> mask;       ///< [H,W] in [0,1], weight of each pixel; undefined = 1 everywhere
};

/// Takes the depth that a render should have; returns dL/d(inv_depth) of the loss between the two.
using CompareDepth = std::function<Buffer<float>(const DepthTarget&)>;

/// Source of the depth that a render from a place without a photo should have, all on the host. Calls `compare` once
/// with the depth of `image` [H,W,3], seen from `camera`, and returns dL/d(image) [H,W,3]; undefined where the depth
/// does not depend on the image. An empty function stands for no source.
using PseudoDepth =
    std::function<Buffer<float>(const Camera& camera, const Buffer<float>& image, const CompareDepth& compare)>;

/// Inputs of a published method's training. AddBaseline (baselines/methods.h) makes its densifier and parts of them.
struct BaselineSetup : TrainSetup {
  BaselineSettings baseline = {};
  TrainDeviceMaker make_device = {};  ///< for a second model
  PseudoDepth pseudo_depth = {};      ///< only where pseudo_depth_weight is set
};

}  // namespace oraclegs
