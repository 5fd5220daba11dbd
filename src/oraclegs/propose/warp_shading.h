#pragma once
// Color and evidence of one pixel of the forward warp whose depth is known, for host and device.

#include "oraclegs/propose/warp_math.h"

namespace oraclegs {

struct ShadedPixel {
  Vec3f color;              ///< RGB
  float known = 0;          ///< weight of the color in PushPull
  uint16_t provenance = 0;  ///< as in Proposal
  PixelEvidence evidence;   ///< without the ring
};

/// Bilinear sample at the mean exposure; (u, v) must be inside the image.
ORACLEGS_HD inline Vec3f ColorAt(const WarpSource& from, float u, float v) {
  const float x = std::clamp(u - 0.5f, 0.f, static_cast<float>(from.width - 1));
  const float y = std::clamp(v - 0.5f, 0.f, static_cast<float>(from.height - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, from.width - 1), y1 = std::min(y0 + 1, from.height - 1);
  const float a = x - static_cast<float>(x0), b = y - static_cast<float>(y0);
  const auto width = static_cast<size_t>(from.width);
  const float* top = from.rgb + 3 * width * static_cast<size_t>(y0);
  const float* bottom = from.rgb + 3 * width * static_cast<size_t>(y1);
  float color[3];
  for (int c = 0; c < 3; ++c) {
    color[c] = (1 - b) * ((1 - a) * top[3 * x0 + c] + a * top[3 * x1 + c]) +
               b * ((1 - a) * bottom[3 * x0 + c] + a * bottom[3 * x1 + c]);
    if (from.exposed) color[c] = std::min(color[c] / from.gain[c], 1.f);
  }
  return {color[0], color[1], color[2]};
}

/// The views that a pixel's color is mixed from, by falling weight, ties by number.
struct Blend {
  struct Shown {
    float weight = 0;
    int source = 0;
    float u = 0, v = 0;
  };
  Shown shown[kBlended];
  int count = 0;

  /// Offers a view; call in the order of the sources.
  ORACLEGS_HD inline void Offer(const Shown& one) {
    if (count == kBlended && !(one.weight > shown[kBlended - 1].weight)) return;
    int place = count < kBlended ? count++ : kBlended - 1;
    for (; place > 0 && one.weight > shown[place - 1].weight; --place) shown[place] = shown[place - 1];
    shown[place] = one;
  }
};

/// Color and evidence of a pixel. `beside`: its ray misses the object.
ORACLEGS_HD inline ShadedPixel ShadePixel(const WarpScene& scene, size_t pixel, float inv_depth, bool beside) {
  ShadedPixel out;
  out.color = {scene.background[0], scene.background[1], scene.background[2]};
  PixelEvidence& e = out.evidence;
  if (beside) {
    e.background = 1;
    out.known = 1;
    return out;
  }
  if (!(inv_depth > 0)) return out;
  Blend blend;
  for (int k = 0; k < scene.count; ++k) {
    const Sighting s = See(scene, scene.sources[k], scene.CenterX(pixel), scene.CenterY(pixel), inv_depth);
    if (!s.in_frame) continue;
    const float angle = AngleAt(scene, scene.sources[k], scene.CenterX(pixel), scene.CenterY(pixel), inv_depth);
    const float off = s.relative / kVisible;
    const float visible = s.confidence > 0 ? std::exp(-off * off) : kUnknownVisible;
    if (s.relative < -kSeenThroughDepth) e.conflicts += s.confidence;
    if (s.relative > kSeenThroughDepth) e.occluded += s.confidence;
    e.support += visible * (0.1f + s.confidence) * std::exp(-angle / kVoteAngle);
    e.views += visible;
    if (visible > 0.5f) e.angle = std::min(e.angle, angle);
    e.confidence = std::max(e.confidence, visible * s.confidence);
    e.resolution = std::max(e.resolution, visible * s.resolution);
    blend.Offer({visible * (0.1f + s.confidence) * std::exp(-angle / kColorAngle) * s.resolution, k, s.u, s.v});
  }
  Vec3f colors[kBlended], sum;
  float total = 0, squares = 0;
  for (int i = 0; i < blend.count; ++i) {
    const Blend::Shown& one = blend.shown[i];
    colors[i] = ColorAt(scene.sources[one.source], one.u, one.v);
    sum.x += one.weight * colors[i].x, sum.y += one.weight * colors[i].y, sum.z += one.weight * colors[i].z;
    total += one.weight;
  }
  if (!(total > 1e-12f)) return out;
  const Vec3f mean{sum.x / total, sum.y / total, sum.z / total};
  for (int i = 0; i < blend.count; ++i) {
    const Vec3f off{colors[i].x - mean.x, colors[i].y - mean.y, colors[i].z - mean.z};
    squares += blend.shown[i].weight * Dot(off, off);
  }
  e.spread = std::sqrt(squares / (3 * total));
  out.color = mean;
  out.provenance = static_cast<uint16_t>(scene.sources[blend.shown[0].source].number + 1);
  // The angle's weight is relative: a color seen from far off is better than none.
  out.known = std::min(1.f, std::min(e.support, e.views) / kWellKnown);
  return out;
}

}  // namespace oraclegs
