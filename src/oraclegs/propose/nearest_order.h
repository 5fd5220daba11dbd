#pragma once

#include <vector>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

/// The angle by which one camera is turned against the other, radians.
double TurnBetween(const Camera& a, const Camera& b);

/// An order of the cameras in which neighbors are near: a short open path through all of them, by always going on to
/// the nearest one and then undoing crossings. A rotation by one radian counts as a tenth of the cameras' mean distance
/// from their center. The same cameras give the same order.
std::vector<size_t> NearestOrder(const std::vector<Camera>& cameras);

}  // namespace oraclegs
