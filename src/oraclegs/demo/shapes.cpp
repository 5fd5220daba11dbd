#include "oraclegs/demo/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace oraclegs {
namespace {

/// A hit in the shape's own frame.
struct LocalHit {
  double t;
  Vec3 normal;
};
using MaybeHit = std::optional<LocalHit>;

struct Limits {
  double low, high;
  bool Hold(double t) const { return t > low && t < high; }
};

/// Real roots of a t^2 + 2 b t + c, ascending.
std::optional<std::pair<double, double>> Roots(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (a == 0 || discriminant < 0) return std::nullopt;
  const double root = std::sqrt(discriminant);
  return std::pair{(-b - root) / a, (-b + root) / a};
}

MaybeHit HitSphere(double radius, const Ray& ray, const Limits& limits) {
  const auto roots = Roots(1, Dot(ray.origin, ray.direction), Dot(ray.origin, ray.origin) - radius * radius);
  if (!roots) return std::nullopt;
  const double t = limits.Hold(roots->first) ? roots->first : roots->second;
  if (!limits.Hold(t)) return std::nullopt;
  return LocalHit{t, (ray.origin + t * ray.direction) * (1 / radius)};
}

/// Slab test of a box: where the line enters and leaves it, and through which axis.
struct Slabs {
  double enter = -1e300, leave = 1e300;
  int enter_axis = 0, leave_axis = 0;
};

Slabs CrossSlabs(const Vec3& half, const Ray& ray) {
  const std::array<double, 3> o{ray.origin.x, ray.origin.y, ray.origin.z};
  const std::array<double, 3> d{ray.direction.x, ray.direction.y, ray.direction.z};
  const std::array<double, 3> h{half.x, half.y, half.z};
  Slabs slabs;
  for (int i = 0; i < 3; ++i) {
    if (d[i] == 0) {
      if (o[i] < -h[i] || o[i] > h[i]) slabs.leave = -1e300;
      continue;
    }
    double near = (-h[i] - o[i]) / d[i], far = (h[i] - o[i]) / d[i];
    if (near > far) std::swap(near, far);
    if (near > slabs.enter) slabs.enter = near, slabs.enter_axis = i;
    if (far < slabs.leave) slabs.leave = far, slabs.leave_axis = i;
  }
  return slabs;
}

/// The unit vector of axis i, its sign that of the ray's component times `sign`.
Vec3 AxisNormal(int i, const Ray& ray, double sign) {
  const double d = i == 0 ? ray.direction.x : (i == 1 ? ray.direction.y : ray.direction.z);
  const double s = d > 0 ? sign : -sign;
  return {i == 0 ? s : 0, i == 1 ? s : 0, i == 2 ? s : 0};
}

MaybeHit HitBox(const Vec3& half, const Ray& ray, const Limits& limits) {
  const Slabs slabs = CrossSlabs(half, ray);
  if (slabs.enter > slabs.leave) return std::nullopt;
  if (limits.Hold(slabs.enter)) return LocalHit{slabs.enter, AxisNormal(slabs.enter_axis, ray, -1)};
  if (limits.Hold(slabs.leave)) return LocalHit{slabs.leave, AxisNormal(slabs.leave_axis, ray, 1)};
  return std::nullopt;
}

MaybeHit HitRoom(const Vec3& half, const Ray& ray, const Limits& limits) {
  const Slabs slabs = CrossSlabs(half, ray);
  if (slabs.enter > slabs.leave || !limits.Hold(slabs.leave)) return std::nullopt;
  return LocalHit{slabs.leave, AxisNormal(slabs.leave_axis, ray, 1)};
}

MaybeHit HitCylinder(const Vec3& size, const Ray& ray, const Limits& limits) {
  MaybeHit best;
  const auto keep = [&](double t, const Vec3& normal) {
    if (limits.Hold(t) && (!best || t < best->t)) best = LocalHit{t, normal};
  };
  const Vec3 &o = ray.origin, &d = ray.direction;
  if (const auto roots = Roots(d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y, o.x * o.x + o.y * o.y - size.x * size.x)) {
    for (const double t : {roots->first, roots->second}) {
      const Vec3 p = o + t * d;
      if (p.z >= -size.z && p.z <= size.z) keep(t, Vec3{p.x / size.x, p.y / size.x, 0});
    }
  }
  if (d.z != 0) {
    for (const double side : {-1.0, 1.0}) {
      const double t = (side * size.z - o.z) / d.z;
      const Vec3 p = o + t * d;
      if (p.x * p.x + p.y * p.y <= size.x * size.x) keep(t, Vec3{0, 0, side});
    }
  }
  return best;
}

/// Signed distance to the torus. Walking it is slower than solving the quartic, but it needs square roots only.
double TorusDistance(const Vec3& size, const Vec3& p) {
  const double ring = std::sqrt(p.x * p.x + p.y * p.y) - size.x;
  return std::sqrt(ring * ring + p.z * p.z) - size.y;
}

MaybeHit HitTorus(const Vec3& size, const Ray& ray, const Limits& limits) {
  constexpr double kSurface = 1e-7;  // scene units; far below a depth step
  const auto span =
      Roots(1, Dot(ray.origin, ray.direction), Dot(ray.origin, ray.origin) - (size.x + size.y) * (size.x + size.y));
  if (!span) return std::nullopt;
  const double end = std::min(limits.high, span->second);
  double t = std::max(limits.low, span->first);
  for (int step = 0; step < 200 && t < end; ++step) {
    const Vec3 p = ray.origin + t * ray.direction;
    const double distance = TorusDistance(size, p);
    if (distance < kSurface) {
      const double ring = std::sqrt(p.x * p.x + p.y * p.y);
      const double k = 1 - size.x / ring;
      const Vec3 normal = Normalized({p.x * k, p.y * k, p.z});
      if (limits.Hold(t) && Dot(normal, ray.direction) < 0) return LocalHit{t, normal};
      t += 10 * kSurface;  // leaving the surface it started on
      continue;
    }
    t += distance;
  }
  return std::nullopt;
}

MaybeHit HitLocal(const Solid& shape, const Ray& ray, const Limits& limits) {
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return HitSphere(shape.size.x, ray, limits);
    case ShapeKind::kBox:
      return HitBox(shape.size, ray, limits);
    case ShapeKind::kCylinder:
      return HitCylinder(shape.size, ray, limits);
    case ShapeKind::kTorus:
      return HitTorus(shape.size, ray, limits);
    case ShapeKind::kRoom:
      return HitRoom(shape.size, ray, limits);
  }
  return std::nullopt;
}

double BoundRadius(ShapeKind kind, const Vec3& size) {
  switch (kind) {
    case ShapeKind::kSphere:
      return size.x;
    case ShapeKind::kCylinder:
      return std::sqrt(size.x * size.x + size.z * size.z);
    case ShapeKind::kTorus:
      return size.x + size.y;
    default:
      return Length(size);
  }
}

}  // namespace

Solid MakeSolid(ShapeKind kind, const Vec3& size, const Vec3& center, double yaw, double tilt) {
  const SinCos a = SinCosOfTurns(yaw), b = SinCosOfTurns(tilt);
  Solid shape;
  shape.kind = kind;
  shape.size = size;
  shape.center = center;
  shape.axis_x = {a.cos, a.sin, 0};
  const Vec3 flat_y{-a.sin, a.cos, 0}, up{0, 0, 1};
  shape.axis_y = b.cos * flat_y + b.sin * up;
  shape.axis_z = b.cos * up - b.sin * flat_y;
  shape.bound = BoundRadius(kind, size) * (1 + 1e-9);
  return shape;
}

std::optional<ShapeHit> Intersect(const Solid& shape, const Ray& ray, double t_min, double t_max) {
  if (MissesBound(shape, ray)) return std::nullopt;
  const auto to_local = [&](const Vec3& v) {
    return Vec3{Dot(v, shape.axis_x), Dot(v, shape.axis_y), Dot(v, shape.axis_z)};
  };
  const Ray local{to_local(ray.origin - shape.center), to_local(ray.direction)};
  const auto hit = HitLocal(shape, local, {t_min, t_max});
  if (!hit) return std::nullopt;
  Vec3 normal = hit->normal.x * shape.axis_x + hit->normal.y * shape.axis_y + hit->normal.z * shape.axis_z;
  if (Dot(normal, ray.direction) > 0) normal = -normal;
  return ShapeHit{hit->t, normal, local.origin + hit->t * local.direction, hit->normal};
}

}  // namespace oraclegs
