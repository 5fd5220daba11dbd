#include "oraclegs/depth/monocular.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "oraclegs/core/parallel.h"
#include "oraclegs/depth/local_warp.h"
#include "oraclegs/depth/plane.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxWarpSamples = 20000;  // for one map
constexpr size_t kMinWarpSamples = 200;
constexpr size_t kMaxKnown = 5000;       // that align one map
constexpr float kBeforeNearest = 2;      // times the nearest known inverse depth: nearer is unknown
constexpr float kMinConfidence = 0.01f;  // less is written as unknown

bool IsConfident(const DepthMap& map, size_t i) { return map.confidence[i] >= kConfident && map.inv_depth[i] > 0; }

Eigen::Vector2f CenterOf(const Camera& camera, size_t i) {
  const auto width = static_cast<size_t>(camera.width);
  return {static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f};
}

/// At most `most` confident pixels, evenly by index.
std::vector<size_t> ConfidentPixels(const DepthMap& map, size_t most) {
  std::vector<size_t> all, some;
  for (size_t i = 0; i < map.size(); ++i) {
    if (IsConfident(map, i)) all.push_back(i);
  }
  const size_t stride = (all.size() + most - 1) / most;
  for (size_t i = 0; i < all.size(); i += stride) some.push_back(all[i]);
  return some;
}

bool IsRight(double guess, double truth) { return std::abs(guess / truth - 1) < kRightWithin; }

double ShareRight(const RelativeDepth& relative, const Alignment& alignment, const std::vector<KnownDepth>& known) {
  int right = 0, all = 0;
  for (const KnownDepth& k : known) {
    if (!(k.inv_depth > 0 && k.x >= 0 && k.y >= 0 && k.x < relative.width && k.y < relative.height)) continue;
    ++all;
    right += IsRight(alignment.At(SampleAt(relative, k.x - 0.5, k.y - 0.5)), k.inv_depth) ? 1 : 0;
  }
  return all == 0 ? 0 : static_cast<double>(right) / all;
}

/// Correction of an aligned map by stereo, and the fraction of held-out samples on which it is right.
struct Correction {
  LocalWarp warp;
  double right = 0;
};

Correction CorrectionFor(const DepthMap& stereo, const std::vector<float>& aligned) {
  const int width = stereo.camera.width, height = stereo.camera.height;
  const LocalWarpOptions options;
  const int cell = std::max(1, std::max(width, height) / options.cells);
  std::vector<DepthSample> fitted, held_out, all;
  for (const size_t i : ConfidentPixels(stereo, kMaxWarpSamples)) {
    const Eigen::Vector2f at = CenterOf(stereo.camera, i);
    const DepthSample sample{at.x(), at.y(), aligned[i], stereo.inv_depth[i], stereo.confidence[i]};
    const int column = static_cast<int>(at.x()) / cell, row = static_cast<int>(at.y()) / cell;
    // Every fourth cell, none of which touch.
    const bool is_held_out = column % 2 == 1 && row % 2 == 1;
    (is_held_out ? held_out : fitted).push_back(sample);
    all.push_back(sample);
  }
  const LocalWarp trial(width, height, fitted, options);
  size_t right = 0;
  for (const DepthSample& s : held_out) {
    right += IsRight(static_cast<double>(trial(s.x, s.y, s.inv_depth)), static_cast<double>(s.truth)) ? 1 : 0;
  }
  const double share = held_out.empty() ? 0 : static_cast<double>(right) / static_cast<double>(held_out.size());
  return {LocalWarp(width, height, all, options), share};
}

std::vector<float> Aligned(const RelativeDepth& relative, const Alignment& alignment) {
  std::vector<float> out;
  out.reserve(relative.values.size());
  for (const float value : relative.values) out.push_back(static_cast<float>(alignment.At(static_cast<double>(value))));
  return out;
}

/// Normal from the inverse depths beside a pixel.
Eigen::Vector3f NormalAt(const Camera& camera, const std::vector<float>& inv_depth, size_t i) {
  const auto width = static_cast<size_t>(camera.width);
  const size_t x = i % width, y = i / width, last_row = static_cast<size_t>(camera.height) - 1;
  const size_t left = x > 0 ? i - 1 : i, right = x + 1 < width ? i + 1 : i;
  const size_t above = y > 0 ? i - width : i, below = y < last_row ? i + width : i;
  Plane plane{inv_depth[i], 0, 0};
  if (right > left) plane.dx = (inv_depth[right] - inv_depth[left]) / static_cast<float>(right - left);
  if (below > above) plane.dy = (inv_depth[below] - inv_depth[above]) / static_cast<float>((below - above) / width);
  const Eigen::Vector2f at = CenterOf(camera, i);
  return NormalOf(camera, plane, at.x(), at.y());
}

/// Writes `guess` where `out` is not confident and the guess is allowed.
void Fill(const std::vector<float>& guess, float nearest, float confidence, const AllowedPixels& allowed,
          DepthMap* out) {
  out->monocular = true;
  ParallelBlocks(static_cast<int64_t>(out->size()), 1 << 14, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      if (IsConfident(*out, i)) continue;
      const bool possible = guess[i] > 0 && guess[i] < nearest && confidence >= kMinConfidence;
      const bool fills = possible && (allowed.empty() || allowed[i] != 0);
      out->inv_depth[i] = fills ? guess[i] : 0;
      out->confidence[i] = fills ? confidence : 0;
      out->normals[i] = fills ? NormalAt(out->camera, guess, i) : Eigen::Vector3f::Zero();
    }
  });
}

/// A map of the guess alone, with name and camera of `frame`.
DepthMap FilledAlone(const DepthMap& frame, const std::vector<float>& guess, float nearest, double confidence,
                     const AllowedPixels& allowed) {
  DepthMap map;
  map.name = frame.name, map.camera = frame.camera;
  map.inv_depth.assign(guess.size(), 0);
  map.confidence.assign(guess.size(), 0);
  map.normals.assign(guess.size(), Eigen::Vector3f::Zero());
  Fill(guess, nearest, static_cast<float>(confidence), allowed, &map);
  return map;
}

float Nearest(const std::vector<KnownDepth>& known) {
  double nearest = 0;
  for (const KnownDepth& k : known) nearest = std::max(nearest, k.inv_depth);
  return static_cast<float>(nearest);
}

}  // namespace

AllowedPixels PixelsWithDepth(const LoadedView& view, const Silhouettes& silhouettes, size_t v) {
  AllowedPixels allowed = view.mask;
  if (silhouettes.empty()) return allowed;
  const std::vector<uint8_t>& object = silhouettes.Object(v);
  if (allowed.empty()) return object;
  for (size_t i = 0; i < allowed.size(); ++i) allowed[i] = allowed[i] != 0 && object[i] != 0 ? 1 : 0;
  return allowed;
}

std::vector<KnownDepth> ConfidentDepths(const DepthMap& stereo) {
  std::vector<KnownDepth> known;
  for (const size_t i : ConfidentPixels(stereo, kMaxKnown)) {
    const Eigen::Vector2d at = CenterOf(stereo.camera, i).cast<double>();
    known.push_back({at.x(), at.y(), static_cast<double>(stereo.inv_depth[i])});
  }
  return known;
}

MonocularDepth AlignedDepth(const DepthMap& frame, const RelativeDepth& relative, const Alignment& alignment,
                            const std::vector<KnownDepth>& known, const AllowedPixels& allowed) {
  const double right = ShareRight(relative, alignment, known);
  return {FilledAlone(frame, Aligned(relative, alignment), kBeforeNearest * Nearest(known), right, allowed), right};
}

MonocularDepth WholeDepth(const DepthMap& frame, const RelativeDepth& relative, const Alignment& alignment,
                          const std::vector<KnownDepth>& known, const AllowedPixels& allowed) {
  const double right = ShareRight(relative, alignment, known);
  return {FilledAlone(frame, Aligned(relative, alignment), std::numeric_limits<float>::infinity(),
                      std::max(right, kLeastOfWhole), allowed),
          right};
}

MonocularDepth FusedDepth(const DepthMap& stereo, const RelativeDepth& relative, const Alignment& alignment,
                          const std::vector<KnownDepth>& known, const AllowedPixels& allowed) {
  MonocularDepth out;
  out.map = stereo;
  std::vector<float> guess = Aligned(relative, alignment);
  const std::vector<KnownDepth> confident = ConfidentDepths(stereo);
  if (confident.size() < kMinWarpSamples) {
    out.right = ShareRight(relative, alignment, known);
  } else {
    const Correction correction = CorrectionFor(stereo, guess);
    out.right = correction.right;
    for (size_t i = 0; i < guess.size(); ++i) {
      const Eigen::Vector2f at = CenterOf(stereo.camera, i);
      guess[i] = correction.warp(at.x(), at.y(), guess[i]);
    }
  }
  const float nearest = kBeforeNearest * std::max(Nearest(known), Nearest(confident));
  Fill(guess, nearest, std::min(kMaxBesideStereo, static_cast<float>(out.right)), allowed, &out.map);
  return out;
}

}  // namespace oraclegs
