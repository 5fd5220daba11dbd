#pragma once
// The textures of the demo scenes. Every texture but paint has detail from half a unit down to a hundredth, so that
// feature matching finds something on every surface at 320 x 240.

#include "oraclegs/demo/vec3.h"

namespace oraclegs {

enum class Texture {
  kRoom,    ///< terrazzo checker floor, brick, wallpaper and painted walls
  kCrate,   ///< planks with grain and nails
  kQuilt,   ///< colored patches of two sizes
  kMarble,  ///< veins
  kCandy,   ///< speckled cells
  kTiles,   ///< bands of tiles around z
  kDonut,   ///< dough, icing, sprinkles
  kGlaze,   ///< color of the mirror ball under its reflection
  kPaint,   ///< one color for each side of the room
  kGround,  ///< grass, earth and stones around z
  kHouse,   ///< windows in plaster, tiles on the roof; of another color for each size
};

/// Linear RGB albedo in [0, 1] of a point in its shape's frame. `normal` is the outward normal there, `size` the
/// shape's size.
Vec3 Albedo(Texture texture, const Vec3& point, const Vec3& normal, const Vec3& size);

}  // namespace oraclegs
