#pragma once
// A small Whitted-style ray tracer: one light with an area, ambient light with contact shadows, one mirror bounce.

#include <cstdint>
#include <vector>

#include "oraclegs/demo/shapes.h"
#include "oraclegs/demo/textures.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

struct SceneObject {
  Solid shape;
  Texture texture = Texture::kRoom;
  double mirror = 0;  ///< share of light reflected at normal incidence; 0 = matt
};

/// Where the light comes from, and what is where no object is.
enum class Surroundings {
  kRoom,   ///< a lamp under the ceiling; black
  kWhite,  ///< the same lamp; plain white
  kSky,    ///< the sun; a blue that grows paler toward the horizon
};

struct RayScene {
  std::vector<SceneObject> objects;
  Surroundings around = Surroundings::kRoom;
};

/// A pinhole camera for rays, or one that sees all around (equirectangular, 360 x 180 degrees). right, down, forward
/// are orthonormal (the camera frame of camera/camera.h).
struct RayCamera {
  int width = 0, height = 0;
  double focal = 0;  ///< pixels; the principal point is the image's center; 0 = sees all around
  Vec3 center, right, down, forward;
};

struct RayTracedView {
  Image8 rgb;
  std::vector<uint16_t> depth;  ///< z along the optical axis (all around: distance) at the pixel's center, 1/1000 scene
                                ///< unit; 0 = none
};

/// Traces samples x samples rays a pixel. `view` selects the random numbers. The result does not depend on the number
/// of threads.
RayTracedView TraceView(const RayScene& scene, const RayCamera& camera, int samples, int view);

}  // namespace oraclegs
