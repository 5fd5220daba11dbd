#pragma once

#include <vector>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

/// An order of the cameras in which neighbors are near: a short open path through all of them, found by going on to the
/// nearest camera and then undoing crossings. A rotation by one radian counts as a tenth of the cameras' mean distance
/// from their center. Deterministic.
std::vector<size_t> NearestOrder(const std::vector<Camera>& cameras);

}  // namespace oraclegs
