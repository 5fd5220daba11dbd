#pragma once
// The kinds of demo scenes: what stands in each, and from where it is seen.

#include "oraclegs/core/enum_words.h"
#include "oraclegs/demo/raytracer.h"

namespace oraclegs {

enum class DemoKind {
  kRoom,     ///< textured objects in a textured room, seen from an arc
  kObject,   ///< objects that touch, before plain white, seen from all around
  kWalls,    ///< the room with walls, floor and ceiling of one color each
  kForward,  ///< the room from places on a plane, all looking the same way
  kThin,     ///< the room with poles, a grating and rings, 1 to 4 pixels thick at 320 x 240, before the objects
  kOutdoor,  ///< the objects on open ground, with houses 10 to 55 units away, below a smooth sky
  kSpheres,  ///< the room all around, from places between its objects and walls
};
template <>
struct EnumWords<DemoKind> {
  static constexpr EnumWord<DemoKind> kWords[] = {{DemoKind::kRoom, "room"},      {DemoKind::kObject, "object"},
                                                  {DemoKind::kWalls, "walls"},    {DemoKind::kForward, "forward"},
                                                  {DemoKind::kThin, "thin"},      {DemoKind::kOutdoor, "outdoor"},
                                                  {DemoKind::kSpheres, "spheres"}};
};

/// The objects of a kind and what is around them. z is up, the floor or the ground is z = 0, the room's inside is about
/// 7 units wide; nothing is 65 units or more from a camera, which is as far as the depth images reach.
RayScene DemoWorld(DemoKind kind);

/// Camera of view `i` of `views`, in a size in pixels; of kSpheres it sees all around.
RayCamera DemoCamera(DemoKind kind, int i, int views, int width, int height);

}  // namespace oraclegs
