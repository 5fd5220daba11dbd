#include "oraclegs/demo/demo_kinds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "support/shape_distance.h"

namespace oraclegs {
namespace {

constexpr int kViews = 24, kWidth = 96, kHeight = 72;

RayCamera CameraOf(DemoKind kind, int i) { return DemoCamera(kind, i, kViews, kWidth, kHeight); }

RayTracedView ViewOf(DemoKind kind, int i, int samples = 1) {
  return TraceView(DemoWorld(kind), CameraOf(kind, i), samples, i);
}

double ShareWithoutDepth(const RayTracedView& view) {
  const auto none = std::count(view.depth.begin(), view.depth.end(), 0);
  return static_cast<double>(none) / static_cast<double>(view.depth.size());
}

/// Share of the pixels of view `i` whose point view `j` has in frame at the same depth, of those in frame.
double Agreement(DemoKind kind, int i, int j) {
  const RayCamera a = CameraOf(kind, i), b = CameraOf(kind, j);
  const RayTracedView from_a = ViewOf(kind, i), from_b = ViewOf(kind, j);
  int inside = 0, agree = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double z = from_a.depth[y * kWidth + x] / 1000.0;
      if (z == 0) continue;
      const Vec3 along = ((x + .5 - .5 * kWidth) / a.focal) * a.right + ((y + .5 - .5 * kHeight) / a.focal) * a.down;
      const Vec3 to_point = a.center + z * (along + a.forward) - b.center;
      const double z_b = Dot(to_point, b.forward);
      const auto u = static_cast<int>(std::floor(Dot(to_point, b.right) / z_b * b.focal + .5 * kWidth));
      const auto v = static_cast<int>(std::floor(Dot(to_point, b.down) / z_b * b.focal + .5 * kHeight));
      if (z_b <= 0 || u < 0 || v < 0 || u >= kWidth || v >= kHeight) continue;
      ++inside;
      agree += std::abs(from_b.depth[v * kWidth + u] / 1000.0 / z_b - 1) < .05;
    }
  }
  EXPECT_GT(inside, kWidth * kHeight / 10);
  return static_cast<double>(agree) / inside;
}

class EachDemoKind : public testing::TestWithParam<DemoKind> {};

TEST_P(EachDemoKind, HasTheSameBytesInTwoRuns) {
  const RayTracedView one = ViewOf(GetParam(), 3, 2), other = ViewOf(GetParam(), 3, 2);
  EXPECT_TRUE(one.rgb.data == other.rgb.data);
  EXPECT_TRUE(one.depth == other.depth);
}

TEST_P(EachDemoKind, DepthAgreesWithThatOfAnotherView) { EXPECT_GT(Agreement(GetParam(), 11, 13), .8); }

TEST_P(EachDemoKind, DepthIsWithinReach) {
  for (const int i : {0, 7, 12, 23}) {
    const auto depth = ViewOf(GetParam(), i).depth;
    EXPECT_LT(*std::max_element(depth.begin(), depth.end()), 65000) << "deeper points would all have the last value";
    for (const uint16_t z : depth) ASSERT_TRUE(z == 0 || z > 400) << "a camera stands in an object";
  }
}

TEST_P(EachDemoKind, ImagesAreNeitherDarkNorBurntOut) {
  const RayTracedView view = ViewOf(GetParam(), 5, 2);
  double sum = 0, pixels = 0;
  for (size_t i = 0; i < view.depth.size(); ++i) {
    if (view.depth[i] == 0) continue;
    sum += view.rgb.data[3 * i + 1];
    ++pixels;
  }
  EXPECT_GT(sum / pixels, 70);
  EXPECT_LT(sum / pixels, 180);
}

INSTANTIATE_TEST_SUITE_P(All, EachDemoKind,
                         testing::Values(DemoKind::kRoom, DemoKind::kObject, DemoKind::kWalls, DemoKind::kForward,
                                         DemoKind::kThin, DemoKind::kOutdoor),
                         [](const auto& info) { return Word(info.param); });

TEST(DemoCamera, OfSpheresSeesAllAroundWhatPinholesSee) {
  constexpr int kAround = 720;
  constexpr double kPi = 3.14159265358979323846;
  const RayScene world = DemoWorld(DemoKind::kSpheres);
  const RayCamera sphere = DemoCamera(DemoKind::kSpheres, 3, 8, kAround, kAround / 2);
  const RayTracedView around = TraceView(world, sphere, 1, 0);
  EXPECT_EQ(std::count(around.depth.begin(), around.depth.end(), 0), 0) << "the room has walls everywhere";
  for (const auto& [right, down, forward] :
       {std::array{sphere.right, sphere.down, sphere.forward}, std::array{-sphere.forward, sphere.down, sphere.right},
        std::array{sphere.right, sphere.forward, -sphere.down}}) {
    const RayCamera flat{40, 40, 20, sphere.center, right, down, forward};
    const RayTracedView view = TraceView(world, flat, 1, 0);
    int agree = 0;
    for (int i = 0; i < 1600; ++i) {
      const double x = (i % 40 + .5 - 20) / 20, y = (i / 40 + .5 - 20) / 20;
      const Vec3 ray = x * right + y * down + forward;
      const double longitude = std::atan2(Dot(ray, sphere.right), Dot(ray, sphere.forward)),
                   latitude = std::asin(Dot(ray, sphere.down) / Length(ray));
      const auto u = static_cast<int>((longitude / (2 * kPi) + .5) * kAround) % kAround;
      const auto v = std::min(static_cast<int>((latitude / kPi + .5) * kAround / 2), kAround / 2 - 1);
      agree += std::abs(view.depth[i] * Length(ray) / around.depth[v * kAround + u] - 1) < .02;
    }
    EXPECT_GT(agree, 1500);
  }
}

TEST(DemoWorld, OnlyOneBallOfTheRoomReflects) {
  int mirrors = 0;
  for (const SceneObject& object : DemoWorld(DemoKind::kRoom).objects) mirrors += object.mirror > 0;
  EXPECT_EQ(mirrors, 1);
}

TEST(DemoWorld, ObjectStandsBeforePlainWhite) {
  for (int i = 0; i < kViews; ++i) {
    const RayTracedView view = ViewOf(DemoKind::kObject, i);
    EXPECT_LT(ShareWithoutDepth(view), .9) << "the object is in the image";
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const size_t at = static_cast<size_t>(y) * kWidth + x;
        if (x > 0 && y > 0 && x < kWidth - 1 && y < kHeight - 1) continue;
        ASSERT_EQ(view.depth[at], 0) << "view " << i << ": the object is whole";
        for (int c = 0; c < 3; ++c) ASSERT_EQ(view.rgb.data[3 * at + c], 255);
      }
    }
  }
}

TEST(DemoWorld, PiecesOfTheObjectTouch) {
  constexpr int kRays = 4000;
  const auto objects = DemoWorld(DemoKind::kObject).objects;
  for (const SceneObject& object : objects) {
    double nearest = 1;
    for (int k = 0; k < kRays; ++k) {
      const double z = 1 - 2 * (k + .5) / kRays, r = std::sqrt(1 - z * z);
      const SinCos turn = SinCosOfTurns(.618033988749895 * k);
      const Vec3 inward{r * turn.cos, r * turn.sin, z};
      const Ray ray{object.shape.center - 5 * inward, inward};
      const auto hit = Intersect(object.shape, ray, 1e-9, 10);
      if (!hit) continue;
      for (const SceneObject& other : objects) {
        if (&other == &object) continue;
        nearest = std::min(nearest, DistanceToSurface(other.shape, ray.origin + hit->t * inward));
      }
    }
    EXPECT_LT(nearest, .02) << "texture " << static_cast<int>(object.texture);
  }
}

TEST(DemoWorld, PaintedWallsHaveNoTexture) {
  // Neighbors on the back wall differ only by the light's noise.
  const auto roughness = [](DemoKind kind) {
    const RayTracedView view = ViewOf(kind, 11, 4);
    double sum = 0;
    for (int y = 0; y < 6; ++y) {
      for (int x = 1; x < kWidth; ++x) {
        const size_t at = 3 * (static_cast<size_t>(y) * kWidth + x);
        sum += std::abs(view.rgb.data[at] - view.rgb.data[at - 3]);
      }
    }
    return sum / (6 * (kWidth - 1));
  };
  EXPECT_LT(roughness(DemoKind::kWalls), 4);
  EXPECT_GT(roughness(DemoKind::kRoom), 8);
}

TEST(DemoWorld, ThinStructuresAreThin) {
  const size_t of_room = DemoWorld(DemoKind::kRoom).objects.size();
  int thin = 0;
  for (const SceneObject& object : DemoWorld(DemoKind::kThin).objects) {
    const double radius = object.shape.kind == ShapeKind::kTorus ? object.shape.size.y : object.shape.size.x;
    if (radius > .02) continue;
    ++thin;
    for (int i = 0; i < kViews; ++i) {
      const RayCamera camera = DemoCamera(DemoKind::kThin, i, kViews, 320, 240);
      const double pixels = 2 * radius * camera.focal / Dot(object.shape.center - camera.center, camera.forward);
      EXPECT_GT(pixels, 1);
      EXPECT_LT(pixels, 4);
    }
  }
  EXPECT_EQ(of_room + thin, DemoWorld(DemoKind::kThin).objects.size());
  EXPECT_GT(thin, 10);
}

TEST(DemoWorld, OutdoorHasFarHousesAndASky) {
  double far = 0, sky = 0;
  for (const int i : {0, 5, 12, 18, 23}) {
    const RayTracedView view = ViewOf(DemoKind::kOutdoor, i);
    sky += ShareWithoutDepth(view) / 5;
    for (const uint16_t z : view.depth) far += z > 10000 ? .2 / (kWidth * kHeight) : 0;
  }
  EXPECT_GT(sky, .05);
  EXPECT_LT(sky, .4);
  EXPECT_GT(far, .1);
}

TEST(DemoCamera, AxesAreOrthonormalAndLevel) {
  for (const auto& entry : EnumWords<DemoKind>::kWords) {
    for (int i = 0; i < kViews; ++i) {
      const RayCamera camera = CameraOf(entry.value, i);
      EXPECT_NEAR(Dot(camera.right, camera.down), 0, 1e-12);
      EXPECT_NEAR(Length(Cross(camera.right, camera.down) - camera.forward), 0, 1e-12);
      EXPECT_NEAR(camera.right.z, 0, 1e-12);
      EXPECT_LT(camera.down.z, 0);
    }
  }
}

TEST(DemoCamera, ForwardPlacesAreApartOnAPlane) {
  const RayCamera first = CameraOf(DemoKind::kForward, 0);
  for (int i = 1; i < kViews; ++i) {
    const RayCamera camera = CameraOf(DemoKind::kForward, i);
    EXPECT_EQ(Length(camera.forward - first.forward), 0);
    EXPECT_NEAR(Dot(camera.center - first.center, first.forward), 0, 1e-12);
    for (int j = 0; j < i; ++j) EXPECT_GT(Length(camera.center - CameraOf(DemoKind::kForward, j).center), .08);
  }
}

TEST(DemoCamera, ObjectIsSeenFromAllAroundAtTwoHeights) {
  std::set<int> heights, quarters;
  for (int i = 0; i < kViews; ++i) {
    const RayCamera camera = CameraOf(DemoKind::kObject, i);
    heights.insert(static_cast<int>(std::lround(1000 * camera.center.z)));
    quarters.insert((camera.center.x > 0 ? 1 : 0) + (camera.center.y > 0 ? 2 : 0));
  }
  EXPECT_EQ(heights.size(), 2u);
  EXPECT_EQ(quarters.size(), 4u);
}

}  // namespace
}  // namespace oraclegs
