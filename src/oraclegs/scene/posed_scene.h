#pragma once

#include "oraclegs/scene/frame.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/split.h"

namespace oraclegs {

/// A scene with poses, in its frame, and which of its views train and test.
struct PosedScene {
  Scene scene;
  Split split;
  SceneFrame frame = {};
};

}  // namespace oraclegs
