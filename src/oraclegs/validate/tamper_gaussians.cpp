#include "oraclegs/validate/tamper_gaussians.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

constexpr double kSmallestBall = 0.04, kLargestBall = 0.2;  // radius, as a share of the smaller image side
constexpr double kLeastMove = 0.03, kFarthestMove = 0.1;    // as a share of depth
constexpr double kLeastLift = 0.15, kFarthestLift = 0.4;    // share of the distance to the camera
constexpr double kLeastGain = 0.7, kLargestGain = 1.3;      // for each channel
constexpr double kLeastShift = 0.08, kLargestShift = 0.25;  // in either direction
constexpr float kSmoothFactor = 3;
constexpr float kDcOfColor = 1 / static_cast<float>(kConstantSh);
constexpr int kPixelTries = 64;

/// Random numbers of one tampering; part 0 places it, later parts are for its views.
Rng RngOf(uint64_t seed, uint64_t number, uint64_t part) {
  return Rng(seed, RandomStream::kGaussianTampering, (number << 32) + (part << 8));
}

struct SurfacePoint {
  Eigen::Vector3f position;
  Eigen::Vector3f to_camera;  ///< vector to the camera
  float depth;
  float side;  ///< length of the smaller image side at that depth, world units
};

/// Surface point under a random pixel; nullopt where none of a few tries has depth.
std::optional<SurfacePoint> DrawSurfacePoint(const std::vector<Proposal>& honest, Rng* rng) {
  for (int attempt = 0; attempt < kPixelTries && !honest.empty(); ++attempt) {
    const Proposal& p = honest[static_cast<size_t>(rng->Index(static_cast<int64_t>(honest.size())))];
    const Camera& camera = p.camera;
    const int64_t x = rng->Index(camera.width), y = rng->Index(camera.height);
    if (p.inv_depth.empty()) continue;
    const float inv_depth = p.inv_depth[static_cast<size_t>(y * camera.width + x)];
    if (!(inv_depth > 0)) continue;
    const double z = 1 / static_cast<double>(inv_depth);
    const Eigen::Vector3d at = {z * (static_cast<double>(x) + 0.5 - camera.cx) / camera.fx,
                                z * (static_cast<double>(y) + 0.5 - camera.cy) / camera.fy, z};
    const Eigen::Vector3d world = camera.cam_from_world.inverse() * at;
    const double side = z * std::min(camera.width / camera.fx, camera.height / camera.fy);
    return SurfacePoint{world.cast<float>(), (camera.Center() - world).cast<float>(), static_cast<float>(z),
                        static_cast<float>(side)};
  }
  return std::nullopt;
}

Eigen::Vector3f DrawMove(float depth, Rng* rng) {
  const double up = rng->Uniform(-1, 1), angle = rng->Uniform(0, 2 * M_PI), around = std::sqrt(1 - up * up);
  const Eigen::Vector3d direction = {around * std::cos(angle), around * std::sin(angle), up};
  return (direction * rng->Uniform(kLeastMove, kFarthestMove) * static_cast<double>(depth)).cast<float>();
}

/// Gain on each channel's distance from middle gray, and a shift.
struct Tone {
  float gain[3], shift[3];

  static Tone Draw(Rng* rng) {
    Tone tone;
    for (int c = 0; c < 3; ++c) {
      tone.gain[c] = static_cast<float>(rng->Uniform(kLeastGain, kLargestGain));
      tone.shift[c] = static_cast<float>(rng->Uniform(kLeastShift, kLargestShift) * (rng->Uniform() < 0.5 ? -1 : 1));
    }
    return tone;
  }
  void Apply(float* sh) const {
    for (int c = 0; c < 3; ++c) {
      // The harmonics are added to middle gray.
      for (int k = 0; k < kShCoefficients; ++k) sh[3 * k + c] *= gain[c];
      sh[c] += shift[c] * kDcOfColor;
    }
  }
};

bool IsIn(const GaussianRows& rows, int64_t i, const Eigen::Vector3f& center, float radius) {
  const Eigen::Vector3f mean(rows.means[3 * i], rows.means[3 * i + 1], rows.means[3 * i + 2]);
  return (mean - center).squaredNorm() <= radius * radius;
}

void CopyRow(const GaussianRows& from, const GaussianRows& to) {
  std::copy_n(from.means, 3, to.means);
  std::copy_n(from.log_scales, 3, to.log_scales);
  std::copy_n(from.quats, 4, to.quats);
  *to.opacity_logits = *from.opacity_logits;
  std::copy_n(from.sh, kShFloats, to.sh);
}

void Move(const Eigen::Vector3f& by, const GaussianRows& row) {
  for (int d = 0; d < 3; ++d) row.means[d] += by[d];
}

bool Copies(GaussianTamperKind kind) {
  return kind == GaussianTamperKind::kSwap || kind == GaussianTamperKind::kInvent;
}

/// A tampering with its random numbers for one view.
class Lie {
 public:
  Lie(const GaussianTampering& tampering, uint64_t view) : kind_(tampering.kind) {
    Rng rng = RngOf(tampering.seed, tampering.number, kind_ == GaussianTamperKind::kFlicker ? 2 + view : 1);
    move_ = DrawMove(tampering.depth, &rng);
    tone_ = Tone::Draw(&rng);
  }

  /// True when a Gaussian in the ball stays; kSmooth removes every other one.
  bool Keeps(int64_t i) const {
    if (kind_ == GaussianTamperKind::kSmooth) return i % 2 == 0;
    return kind_ != GaussianTamperKind::kSwap && kind_ != GaussianTamperKind::kDelete;
  }
  void Apply(const GaussianRows& row) const {
    if (kind_ == GaussianTamperKind::kDisplace || kind_ == GaussianTamperKind::kFlicker) Move(move_, row);
    if (kind_ == GaussianTamperKind::kTone || kind_ == GaussianTamperKind::kFlicker) tone_.Apply(row.sh);
    if (kind_ != GaussianTamperKind::kSmooth) return;
    for (int d = 0; d < 3; ++d) row.log_scales[d] += std::log(kSmoothFactor);
  }

 private:
  GaussianTamperKind kind_;
  Eigen::Vector3f move_;
  Tone tone_;
};

}  // namespace

std::vector<GaussianTampering> DrawGaussianTamperings(const std::vector<Proposal>& honest, size_t count,
                                                      uint64_t seed) {
  std::vector<GaussianTampering> tamperings;
  for (size_t k = 0; k < count; ++k) {
    Rng rng = RngOf(seed, k, 0);
    GaussianTampering t;
    t.kind = static_cast<GaussianTamperKind>(rng.Index(kGaussianTamperKinds));
    const double size = kSmallestBall * std::pow(kLargestBall / kSmallestBall, rng.Uniform());
    const double lift = rng.Uniform(kLeastLift, kFarthestLift);
    const auto surface = DrawSurfacePoint(honest, &rng), other = DrawSurfacePoint(honest, &rng);
    if (!surface || !other) continue;
    t.center = surface->position, t.depth = surface->depth;
    t.radius = static_cast<float>(size) * surface->side;
    t.source = other->position;
    if (t.kind == GaussianTamperKind::kInvent) t.center += static_cast<float>(lift) * surface->to_camera;
    t.seed = seed, t.number = k;
    tamperings.push_back(t);
  }
  GaussianTampering everything;
  everything.radius = std::numeric_limits<float>::infinity();
  everything.seed = seed, everything.number = std::numeric_limits<uint32_t>::max();
  tamperings.push_back(everything);
  return tamperings;
}

TamperedGaussians::TamperedGaussians(Gaussians honest, std::vector<GaussianTampering> tamperings)
    : honest_(std::move(honest)), tamperings_(std::move(tamperings)), sources_(tamperings_.size()) {
  honest_.Check("TamperedGaussians");
  if (honest_.device() != kCpu) throw ShapeError("TamperedGaussians: the Gaussians must be on the CPU");
  const GaussianRows rows = honest_.Rows();
  ball_.assign(static_cast<size_t>(honest_.size()), tamperings_.size());
  for (size_t t = 0; t < tamperings_.size(); ++t) {
    const GaussianTampering& tampering = tamperings_[t];
    for (int64_t i = 0; i < honest_.size(); ++i) {
      // Invented Gaussians stand in free space and change no others.
      if (tampering.kind != GaussianTamperKind::kInvent && ball_[static_cast<size_t>(i)] == tamperings_.size() &&
          IsIn(rows, i, tampering.center, tampering.radius)) {
        ball_[static_cast<size_t>(i)] = t;
      }
      if (Copies(tampering.kind) && IsIn(rows, i, tampering.source, tampering.radius)) sources_[t].push_back(i);
    }
  }
}

Gaussians TamperedGaussians::Make(size_t count, uint64_t view) const {
  count = std::min(count, tamperings_.size());
  std::vector<Lie> lies;
  int64_t most = honest_.size();
  for (size_t t = 0; t < count; ++t) {
    lies.emplace_back(tamperings_[t], view);
    most += static_cast<int64_t>(sources_[t].size());
  }
  Gaussians tampered = Gaussians::Empty(most);
  const GaussianRows from = honest_.Rows(), to = tampered.Rows();
  int64_t n = 0;
  for (int64_t i = 0; i < honest_.size(); ++i) {
    const size_t t = ball_[static_cast<size_t>(i)];
    if (t < count && !lies[t].Keeps(i)) continue;
    CopyRow(from.From(i), to.From(n));
    if (t < count) lies[t].Apply(to.From(n));
    ++n;
  }
  for (size_t t = 0; t < count; ++t) {
    for (const int64_t i : sources_[t]) {
      CopyRow(from.From(i), to.From(n));
      Move(tamperings_[t].center - tamperings_[t].source, to.From(n++));
    }
  }
  tampered.ForEach([&](const char*, Buffer<float>& buffer) { buffer = buffer.Rows(0, n); });
  return tampered;
}

}  // namespace oraclegs
