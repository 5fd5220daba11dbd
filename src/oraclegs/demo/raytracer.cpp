#include "oraclegs/demo/raytracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

constexpr double kEpsilon = 1e-5;  // scene units a secondary ray starts off its surface
constexpr double kFar = 1e9;

// The lamp hangs just under the ceiling.
constexpr Vec3 kLightCenter{-.9, -1.0, 3.55};
constexpr double kLightHalf = .55;
constexpr Vec3 kLightColor{31, 28, 23.5};
constexpr Vec3 kToSun{-.42, -.62, .66};
constexpr double kSunHalf = .03;  // of kToSun's length; a wider sun than ours has softer shadows
constexpr Vec3 kSunColor{1.5, 1.36, 1.12};
constexpr Vec3 kHorizon{.52, .68, .92}, kZenith{.03, .12, .48};
constexpr Vec3 kBackdrop{2, 2, 2};           // white after the tone curve
constexpr Vec3 kSkyLight{.46, .50, .60};     // ambient on what faces up
constexpr Vec3 kBounceLight{.34, .26, .20};  // and on what faces down
constexpr double kContactReach = .9;         // scene units within which a neighbor darkens the ambient light

struct Hit {
  ShapeHit at;
  const SceneObject* object = nullptr;
};

Hit Nearest(const std::vector<SceneObject>& objects, const Ray& ray) {
  Hit best;
  best.at.t = kFar;
  for (const SceneObject& object : objects) {
    if (const auto hit = Intersect(object.shape, ray, kEpsilon, best.at.t)) best = {*hit, &object};
  }
  return best;
}

bool Blocked(const std::vector<SceneObject>& objects, const Ray& ray, double reach) {
  return std::any_of(objects.begin(), objects.end(),
                     [&](const SceneObject& o) { return Intersect(o.shape, ray, kEpsilon, reach).has_value(); });
}

/// The random numbers of one ray, all in [0, 1).
struct Jitter {
  double pixel_x, pixel_y;
  double light_u, light_v;
  double sky_u, sky_v;
};

double Unit(uint32_t bits) { return bits * 0x1.0p-32; }

class Tracer {
 public:
  Tracer(const RayScene& scene, const RayCamera& camera, int samples, int view)
      : objects_(scene.objects), around_(scene.around), camera_(camera), samples_(samples), view_(view) {}

  Vec3 Pixel(int x, int y) const {
    Vec3 sum;
    for (int s = 0; s < samples_ * samples_; ++s) {
      const Jitter jitter = JitterOf(x, y, s);
      const Vec3 color = Radiance(CameraRay(x + jitter.pixel_x, y + jitter.pixel_y), jitter, 1);
      // Tone-mapped before averaging, so that one very bright ray leaves no jagged edge.
      sum = sum + Vec3{ToneMap(color.x), ToneMap(color.y), ToneMap(color.z)};
    }
    return sum * (1.0 / (samples_ * samples_));
  }

  uint16_t Depth(int x, int y) const {
    const Ray ray = CameraRay(x + .5, y + .5);
    const Hit hit = Nearest(objects_, ray);
    if (hit.object == nullptr) return 0;
    const double z = hit.at.t * (camera_.focal == 0 ? 1 : Dot(ray.direction, camera_.forward));
    return static_cast<uint16_t>(std::min(65535.0, std::floor(1000 * z + .5)));
  }

 private:
  /// Strata for the pixel and, in another order, for the light, so that samples x samples rays cover both evenly.
  Jitter JitterOf(int x, int y, int s) const {
    const int strata = samples_ * samples_;
    const uint64_t pixel = (static_cast<uint64_t>(view_) * camera_.height + y) * camera_.width + x;
    const auto draw = [&](uint64_t k) {
      return Philox::Draw(k, static_cast<uint64_t>(RandomStream::kDemoScene), pixel * strata + s);
    };
    const Philox a = draw(0), b = draw(1);
    const auto shuffle =
        static_cast<int>(Philox::Draw(2, static_cast<uint64_t>(RandomStream::kDemoScene), pixel).x[0] % strata);
    const int light = (s * 5 + shuffle) % strata, sky = (s * 3 + shuffle) % strata;
    const double cell = 1.0 / samples_;
    return {(s % samples_ + Unit(a.x[0])) * cell,     (s / samples_ + Unit(a.x[1])) * cell,
            (light % samples_ + Unit(a.x[2])) * cell, (light / samples_ + Unit(a.x[3])) * cell,
            (sky % samples_ + Unit(b.x[0])) * cell,   (sky / samples_ + Unit(b.x[1])) * cell};
  }

  Ray CameraRay(double px, double py) const {
    if (camera_.focal == 0) {
      const SinCos longitude = SinCosOfTurns(px / camera_.width - .5),
                   latitude = SinCosOfTurns((py / camera_.height - .5) / 2);
      const Vec3 level = longitude.sin * camera_.right + longitude.cos * camera_.forward;
      return {camera_.center, Normalized(latitude.cos * level + latitude.sin * camera_.down)};
    }
    const double x = (px - .5 * camera_.width) / camera_.focal, y = (py - .5 * camera_.height) / camera_.focal;
    return {camera_.center, Normalized(x * camera_.right + y * camera_.down + camera_.forward)};
  }

  Vec3 Background(const Vec3& direction) const {
    switch (around_) {
      case Surroundings::kWhite:
        return kBackdrop;
      case Surroundings::kSky:
        return Mix(kHorizon, kZenith, Clamp01(2 * direction.z));
      default:
        return {};
    }
  }

  bool SeesLamp(const Ray& ray, double t_surface) const {
    if (around_ == Surroundings::kSky || ray.direction.z <= 0) return false;
    const double t = (kLightCenter.z - ray.origin.z) / ray.direction.z;
    const Vec3 p = ray.origin + t * ray.direction - kLightCenter;
    return t > 0 && t < t_surface && std::abs(p.x) < kLightHalf && std::abs(p.y) < kLightHalf;
  }

  Vec3 Radiance(const Ray& ray, const Jitter& jitter, int bounces) const {
    const Hit hit = Nearest(objects_, ray);
    if (SeesLamp(ray, hit.at.t)) return {6, 5.8, 5.4};
    if (hit.object == nullptr) return Background(ray.direction);
    const Vec3 point = ray.origin + hit.at.t * ray.direction;
    const Vec3 albedo = Albedo(hit.object->texture, hit.at.local, hit.at.local_normal, hit.object->shape.size);
    const Vec3 direct = around_ == Surroundings::kSky ? SunLight(point, hit.at.normal, jitter)
                                                      : LampLight(point, hit.at.normal, jitter);
    const Vec3 matt = albedo * (direct + AmbientLight(point, hit.at.normal, jitter));
    if (hit.object->mirror == 0 || bounces == 0) return matt;
    const double cosine = -Dot(hit.at.normal, ray.direction);
    const double rest = 1 - cosine, rest2 = rest * rest;
    const double share = hit.object->mirror + (1 - hit.object->mirror) * rest2 * rest2 * rest;  // Schlick
    const Vec3 direction = ray.direction + 2 * cosine * hit.at.normal;
    return matt + share * Radiance({point, Normalized(direction)}, jitter, bounces - 1);
  }

  Vec3 LampLight(const Vec3& point, const Vec3& normal, const Jitter& jitter) const {
    const Vec3 on_light =
        kLightCenter + Vec3{(2 * jitter.light_u - 1) * kLightHalf, (2 * jitter.light_v - 1) * kLightHalf, 0};
    const Vec3 to_light = on_light - point;
    const double distance2 = Dot(to_light, to_light), distance = std::sqrt(distance2);
    const Vec3 direction = to_light * (1 / distance);
    const double facing = Dot(direction, normal);
    if (facing <= 0 || direction.z <= 0) return {};
    if (Blocked(objects_, {point, direction}, distance - kEpsilon)) return {};
    constexpr double kArea = 4 * kLightHalf * kLightHalf;
    return kLightColor * (kArea * facing * direction.z / distance2 * .318309886183790671538);
  }

  Vec3 SunLight(const Vec3& point, const Vec3& normal, const Jitter& jitter) const {
    const Vec3 direction =
        Normalized(kToSun + Vec3{(2 * jitter.light_u - 1) * kSunHalf, (2 * jitter.light_v - 1) * kSunHalf, 0});
    const double facing = Dot(direction, normal);
    if (facing <= 0 || Blocked(objects_, {point, direction}, kFar)) return {};
    return kSunColor * facing;
  }

  Vec3 AmbientLight(const Vec3& point, const Vec3& normal, const Jitter& jitter) const {
    // A cosine-weighted direction: the normal plus a point on the unit sphere.
    const double z = 1 - 2 * jitter.sky_u, r = std::sqrt(std::max(0.0, 1 - z * z));
    const SinCos turn = SinCosOfTurns(jitter.sky_v);
    const Vec3 sum = normal * (1 + 1e-6) + Vec3{r * turn.cos, r * turn.sin, z};
    const bool dark = Blocked(objects_, {point, Normalized(sum)}, kContactReach);
    return Mix(kBounceLight, kSkyLight, .5 + .5 * normal.z) * (dark ? .35 : 1.0);
  }

  /// A film curve with a straight start and a soft shoulder, then gamma 2: a square root is the same on every machine.
  static double ToneMap(double v) {
    const double film = v * (1 + v * .12) / (1 + v * .62);
    return std::sqrt(Clamp01(film));
  }

  const std::vector<SceneObject>& objects_;
  Surroundings around_;
  const RayCamera& camera_;
  int samples_, view_;
};

}  // namespace

RayTracedView TraceView(const RayScene& scene, const RayCamera& camera, int samples, int view) {
  const int width = camera.width, height = camera.height;
  const size_t pixels = static_cast<size_t>(width) * height;
  RayTracedView out{{width, height, 3, std::vector<uint8_t>(3 * pixels)}, std::vector<uint16_t>(pixels)};
  const Tracer tracer(scene, camera, samples, view);
  ParallelFor(height, [&](int64_t y) {
    for (int x = 0; x < width; ++x) {
      const Vec3 color = tracer.Pixel(x, static_cast<int>(y));
      const size_t at = static_cast<size_t>(y) * width + x;
      for (int c = 0; c < 3; ++c) {
        const double v = c == 0 ? color.x : (c == 1 ? color.y : color.z);
        out.rgb.data[3 * at + c] = static_cast<uint8_t>(std::floor(255 * Clamp01(v) + .5));
      }
      out.depth[at] = tracer.Depth(x, static_cast<int>(y));
    }
  });
  return out;
}

}  // namespace oraclegs
