#include "oraclegs/demo/demo_kinds.h"

namespace oraclegs {
namespace {

constexpr Vec3 kTarget{.02, .05, .6};       // what the cameras on an arc look at
constexpr Vec3 kHeapMiddle{-.1, -.1, .72};  // and those around the object

SceneObject OnFloor(ShapeKind kind, const Vec3& size, const Vec3& place, Texture texture) {
  const double height = kind == ShapeKind::kSphere ? size.x : (kind == ShapeKind::kTorus ? size.y : size.z);
  return {MakeSolid(kind, size, {place.x, place.y, height}, place.z), texture, 0};
}

/// The objects of the room, most of them apart. Place: x, y and a turn.
std::vector<SceneObject> StandingObjects() {
  std::vector<SceneObject> objects;
  objects.push_back(OnFloor(ShapeKind::kSphere, {.36, 0, 0}, {.42, -.42, .1}, Texture::kGlaze));
  objects.back().mirror = .32;
  objects.push_back(OnFloor(ShapeKind::kBox, {.42, .36, .34}, {-.48, .22, .07}, Texture::kCrate));
  objects.push_back({MakeSolid(ShapeKind::kBox, {.2, .2, .2}, {-.58, .26, .88}, .21), Texture::kQuilt, 0});
  objects.push_back(OnFloor(ShapeKind::kCylinder, {.25, 0, .62}, {.62, .62, .03}, Texture::kTiles));
  objects.push_back({MakeSolid(ShapeKind::kSphere, {.22, 0, 0}, {.62, .62, 1.46}, .3, .1), Texture::kCandy, 0});
  objects.push_back(OnFloor(ShapeKind::kTorus, {.27, .125, 0}, {-.42, -.72, .15}, Texture::kDonut));
  objects.push_back(OnFloor(ShapeKind::kSphere, {.27, 0, 0}, {1.22, .02, .4}, Texture::kMarble));
  objects.push_back({MakeSolid(ShapeKind::kSphere, {.2, 0, 0}, {-1.22, -.3, .2}, .2, .3), Texture::kCandy, 0});
  return objects;
}

/// These objects around the crate, each touching it or a neighbor. None reflects: of plain white it would show
/// nothing else.
std::vector<SceneObject> HeapedObjects() {
  std::vector<SceneObject> objects;
  objects.push_back(OnFloor(ShapeKind::kBox, {.42, .36, .34}, {0, 0, .07}, Texture::kCrate));
  objects.push_back({MakeSolid(ShapeKind::kBox, {.2, .2, .2}, {-.1, .04, .88}, .21), Texture::kQuilt, 0});
  objects.push_back(OnFloor(ShapeKind::kCylinder, {.25, 0, .62}, {.606, .285, .03}, Texture::kTiles));
  objects.push_back({MakeSolid(ShapeKind::kSphere, {.22, 0, 0}, {.606, .285, 1.46}, .3, .1), Texture::kCandy, 0});
  objects.push_back(OnFloor(ShapeKind::kSphere, {.36, 0, 0}, {.217, -.694, .1}, Texture::kGlaze));
  objects.push_back(OnFloor(ShapeKind::kTorus, {.27, .125, 0}, {-.738, -.347, .15}, Texture::kDonut));
  objects.push_back(OnFloor(ShapeKind::kSphere, {.27, 0, 0}, {-.268, .57, .4}, Texture::kMarble));
  objects.push_back({MakeSolid(ShapeKind::kSphere, {.2, 0, 0}, {.66, -.389, .2}, .2, .3), Texture::kCandy, 0});
  return objects;
}

/// A room whose back wall stands at y = 2.6.
SceneObject Room(Texture texture) { return {MakeSolid(ShapeKind::kRoom, {3.6, 3.3, 1.8}, {0, -.7, 1.8}), texture, 0}; }

/// A place on a circle around the target, before it at turn 0.
Vec3 AroundTarget(double turns, double radius, double height) {
  const SinCos azimuth = SinCosOfTurns(turns);
  return {kTarget.x + radius * azimuth.sin, kTarget.y - radius * azimuth.cos, height};
}

/// Poles, a grating of wires and rings between the cameras of the arc, which are 1.4 to 4.4 units away, and the
/// objects. Seen from there, no radius below is thinner than a pixel or thicker than four.
void AddThinStructures(std::vector<SceneObject>* objects) {
  constexpr double kNear = 1.38;  // from the target
  constexpr double kPole = .85;   // half of its height
  const auto pole = [&](double turns, double radius, Texture texture) {
    objects->push_back(
        {MakeSolid(ShapeKind::kCylinder, {radius, 0, kPole}, AroundTarget(turns, kNear, kPole)), texture});
  };
  pole(-.155, .0066, Texture::kTiles);
  pole(-.1, .009, Texture::kCandy);
  pole(.045, .0075, Texture::kQuilt);
  pole(.15, .0098, Texture::kTiles);

  constexpr double kAt = -.03, kHeight = .75, kHalf = .27;
  constexpr int kWires = 5;
  const SinCos turn = SinCosOfTurns(kAt);
  for (int i = 0; i < kWires; ++i) {
    const double along = kHalf * (2. * i / (kWires - 1) - 1);
    const double radius = i == 0 || i == kWires - 1 ? .0092 : .0066;
    const Vec3 middle = AroundTarget(kAt, kNear, kHeight);
    const Vec3 upright = middle + Vec3{turn.cos, turn.sin, 0} * along, level = middle + Vec3{0, 0, along};
    objects->push_back({MakeSolid(ShapeKind::kCylinder, {radius, 0, kHalf}, upright), Texture::kCandy});
    objects->push_back({MakeSolid(ShapeKind::kCylinder, {radius, 0, kHalf}, level, kAt + .25, .25), Texture::kTiles});
  }

  objects->push_back(
      {MakeSolid(ShapeKind::kTorus, {.2, .009, 0}, AroundTarget(.1, kNear, 1), .1, .25), Texture::kDonut});
  objects->push_back(
      {MakeSolid(ShapeKind::kTorus, {.16, .0075, 0}, AroundTarget(.1, kNear, .8), .28, .25), Texture::kCandy});
  objects->push_back(
      {MakeSolid(ShapeKind::kTorus, {.24, .0085, 0}, AroundTarget(.07, kNear, .45), .1, .04), Texture::kQuilt});
}

/// Open ground and houses, some of which hide others.
void AddLandscape(std::vector<SceneObject>* objects) {
  constexpr double kGround = 55;  // radius
  objects->push_back({MakeSolid(ShapeKind::kCylinder, {kGround, 0, .5}, {0, 0, -.5}), Texture::kGround});
  const auto house = [&](const Vec3& half, double x, double y, double yaw) {
    objects->push_back({MakeSolid(ShapeKind::kBox, half, {x, y, half.z}, yaw), Texture::kHouse});
  };
  house({2, 1.5, 1.6}, -6, 9, .04);
  house({1.6, 2, 1.9}, 6.5, 12, .9);
  house({2.5, 2, 2}, 14, 6, .12);
  house({3, 2, 1.7}, -16, 4, .2);
  house({2.2, 2.6, 2.2}, -13, 20, .07);
  house({3.4, 3, 2}, 1, 30, .02);
  house({2.6, 3, 3.4}, 18, 24, .11);
  house({3, 3, 2.5}, 33, 8, .05);
  house({4, 4, 3.5}, -34, 12, .13);
  house({4, 4, 5}, -9, 42, .03);
  house({4, 4, 4}, -29, 33, .09);
  house({5, 4, 4.5}, 13, 48, .06);
  house({5, 4, 4}, 38, 30, .12);
}

/// A camera that is held level.
RayCamera LookFrom(const Vec3& center, const Vec3& forward) {
  RayCamera camera;
  camera.center = center;
  camera.forward = Normalized(forward);
  camera.right = Normalized(Cross(camera.forward, {0, 0, 1}));
  camera.down = Cross(camera.forward, camera.right);
  return camera;
}

/// A 120 degree arc, every other view from higher up, the radius swinging slowly.
RayCamera OnArc(int i, int views, double low, double high) {
  const double along = static_cast<double>(i) / (views - 1);
  const double radius = 2.95 + .2 * SinCosOfTurns(1.5 * along).sin;
  const Vec3 center = AroundTarget((along - .5) / 3, radius, i % 2 == 0 ? low : high);
  return LookFrom(center, kTarget - center);
}

/// A whole turn, every third view from higher up: of every eighth view, some are, too.
RayCamera OnTurn(int i, int views) {
  const SinCos azimuth = SinCosOfTurns(static_cast<double>(i) / views);
  const bool high = i % 3 == 1;
  const double radius = high ? 3.1 : 3.5;
  const Vec3 to_center{radius * azimuth.sin, -radius * azimuth.cos, high ? 1.7 : .45};
  return LookFrom(kHeapMiddle + to_center, -to_center);
}

/// A turn around the objects, every other view from higher up.
RayCamera AmidRoom(int i, int views) {
  const Vec3 center = AroundTarget(static_cast<double>(i) / views, 1.9, i % 2 == 0 ? 1.2 : 1.75);
  return LookFrom(center, Vec3{kTarget.x, kTarget.y, center.z} - center);
}

/// A rectangle .9 x .6 units upright to the direction of view, which any number of places fills evenly: their sequence
/// is additive, by powers of the plastic number.
RayCamera OnPlane(int i) {
  const Vec3 middle{.1, -2.95, 1.3};
  RayCamera camera = LookFrom(middle, kTarget - middle);
  const double u = .7548776662466927 * i, v = .5698402909980532 * i;
  camera.center =
      middle + camera.right * (.9 * (u - std::floor(u) - .5)) + camera.down * (.6 * (v - std::floor(v) - .5));
  return camera;
}

RayCamera Posed(DemoKind kind, int i, int views) {
  switch (kind) {
    case DemoKind::kObject:
      return OnTurn(i, views);
    case DemoKind::kForward:
      return OnPlane(i);
    case DemoKind::kSpheres:
      return AmidRoom(i, views);
    case DemoKind::kOutdoor:
      return OnArc(i, views, .8, 1.3);  // low enough for the sky
    default:
      return OnArc(i, views, 1.05, 1.75);
  }
}

}  // namespace

RayScene DemoWorld(DemoKind kind) {
  if (kind == DemoKind::kObject) return {HeapedObjects(), Surroundings::kWhite};
  RayScene scene{StandingObjects()};
  if (kind == DemoKind::kOutdoor) {
    scene.around = Surroundings::kSky;
    AddLandscape(&scene.objects);
    return scene;
  }
  if (kind == DemoKind::kThin) AddThinStructures(&scene.objects);
  scene.objects.push_back(Room(kind == DemoKind::kWalls ? Texture::kPaint : Texture::kRoom));
  return scene;
}

RayCamera DemoCamera(DemoKind kind, int i, int views, int width, int height) {
  RayCamera camera = Posed(kind, i, views);
  camera.width = width;
  camera.height = height;
  camera.focal = kind == DemoKind::kSpheres ? 0 : .92 * width;
  return camera;
}

}  // namespace oraclegs
