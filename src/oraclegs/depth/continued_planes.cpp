#include "oraclegs/depth/continued_planes.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

using ImagePlane = ContinuedPlanes::ImagePlane;

constexpr int kCells = 90;                // along the image's larger side
constexpr int kMaxWindow = 16;            // cells to each side
constexpr float kMinWindowShare = 0.01f;  // of a window's pixels, known and of the same color
constexpr float kColorDeviation = 0.08f;  // of pixels of one surface, RMS over the channels
constexpr float kMinSame = 0.01f;         // of SameColor; what is less counts nothing
constexpr float kOnPlane = 0.03f;         // relative distance of a cell's inverse depth from its plane
constexpr float kMinAgreement = 0.5f;     // of the known pixels of the same color, on the plane
constexpr int kNeighborhood = 2;          // cells to each side, for the plane of a known cell
constexpr double kMinSpread = 0.2;        // of the pixels that tell a plane, cells squared
constexpr size_t kMaxCandidates = 32;     // planes that are tried for a cell
constexpr float kBeyondRange = 2;         // times as near or far as any confident depth

/// Sums over pixels, from which the plane of least squares follows: inverse depth is linear over the image on a plane.
/// Pixels count by 1 / w^2, so that relative distances are what is small.
struct PlaneSums {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, w = 0, xw = 0, yw = 0;

  void AddPixel(double u, double v, double inv_depth) {
    const double weight = 1 / (inv_depth * inv_depth);
    Add(weight, {1, u, v, u * u, u * v, v * v, inv_depth, u * inv_depth, v * inv_depth});
  }
  void Add(double weight, const PlaneSums& o) {
    n += weight * o.n, x += weight * o.x, y += weight * o.y, w += weight * o.w;
    xx += weight * o.xx, xy += weight * o.xy, yy += weight * o.yy, xw += weight * o.xw, yw += weight * o.yw;
  }
};

/// Nothing where the pixels are nearer to one line than the root of `least_spread`, pixels squared: too near to tell
/// how the plane goes on beside it.
std::optional<ImagePlane> Fit(const PlaneSums& s, double least_spread) {
  const double x = s.x / s.n, y = s.y / s.n, w = s.w / s.n;
  const double xx = s.xx / s.n - x * x, yy = s.yy / s.n - y * y, xy = s.xy / s.n - x * y;
  const double smaller = (xx + yy) / 2 - std::hypot((xx - yy) / 2, xy);  // eigenvalue
  if (!(smaller > least_spread)) return std::nullopt;
  const double xw = s.xw / s.n - x * w, yw = s.yw / s.n - y * w, determinant = xx * yy - xy * xy;
  ImagePlane plane;
  plane.per_x = (xw * yy - yw * xy) / determinant;
  plane.per_y = (yw * xx - xw * xy) / determinant;
  plane.at_origin = w - plane.per_x * x - plane.per_y * y;
  return plane;
}

/// A square of an image: what is known of its confident pixels, and the color of the others.
struct Cell {
  PlaneSums sums;
  int known = 0, unknown = 0;                                                                      ///< pixels
  Eigen::Vector3f known_color = Eigen::Vector3f::Zero(), unknown_color = Eigen::Vector3f::Zero();  ///< means
  std::optional<ImagePlane> plane;    ///< of the known pixels around of the same color
  float x = 0, y = 0, inv_depth = 0;  ///< means of the known pixels
};

float SameColor(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::exp(-(a - b).squaredNorm() / (6 * kColorDeviation * kColorDeviation));
}

class Grid {
 public:
  Grid(const DepthMap& map, const ImageF& rgb, float min_confidence, FunctionRef<bool(size_t)> may_fill)
      : size_(std::max(2, std::max(rgb.width, rgb.height) / kCells)),
        across_((rgb.width + size_ - 1) / size_),
        down_((rgb.height + size_ - 1) / size_),
        cells_(static_cast<size_t>(across_) * static_cast<size_t>(down_)) {
    for (size_t i = 0; i < map.size(); ++i) {
      const int x = static_cast<int>(i) % rgb.width, y = static_cast<int>(i) / rgb.width;
      Cell& cell = cells_[IndexOf(x, y)];
      const Eigen::Map<const Eigen::Vector3f> color(rgb.row(y) + 3 * x);
      if (map.confidence[i] >= min_confidence && map.inv_depth[i] > 0) {
        cell.sums.AddPixel(x + 0.5, y + 0.5, map.inv_depth[i]);
        cell.known_color += color, ++cell.known;
        nearest_ = std::max(nearest_, kBeyondRange * map.inv_depth[i]);
        const float far = map.inv_depth[i] / kBeyondRange;
        farthest_ = farthest_ == 0 ? far : std::min(farthest_, far);
      } else if (may_fill(i)) {
        cell.unknown_color += color, ++cell.unknown;
      }
    }
    for (Cell& cell : cells_) {
      if (cell.unknown > 0) cell.unknown_color /= static_cast<float>(cell.unknown);
      if (cell.known == 0) continue;
      cell.known_color /= static_cast<float>(cell.known);
      cell.x = static_cast<float>(cell.sums.x / cell.sums.n), cell.y = static_cast<float>(cell.sums.y / cell.sums.n);
      cell.inv_depth = static_cast<float>(cell.sums.w / cell.sums.n);
    }
    ParallelFor(down_, [&](int64_t row) {
      for (int x = 0; x < across_; ++x) FitKnown(x, static_cast<int>(row));
    });
  }

  /// The plane that each cell continues, row by row.
  std::vector<std::optional<ImagePlane>> Continued() const {
    std::vector<std::optional<ImagePlane>> planes(cells_.size());
    ParallelFor(down_, [&](int64_t row) {
      for (int x = 0; x < across_; ++x) planes[At(x, static_cast<int>(row))] = Continue(x, static_cast<int>(row));
    });
    return planes;
  }

  int size() const { return size_; }
  int across() const { return across_; }
  float nearest() const { return nearest_; }
  float farthest() const { return farthest_; }

 private:
  /// A known cell, and how much it counts for an unknown one.
  struct Witness {
    const Cell* cell;
    float weight;
  };

  size_t At(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(across_) + static_cast<size_t>(x);
  }
  size_t IndexOf(int x, int y) const { return At(x / size_, y / size_); }
  double LeastSpread() const { return kMinSpread * size_ * size_; }

  template <class F>
  void ForWindow(int x, int y, int radius, const F& f) const {
    for (int v = std::max(0, y - radius); v < std::min(down_, y + radius + 1); ++v) {
      for (int u = std::max(0, x - radius); u < std::min(across_, x + radius + 1); ++u) f(cells_[At(u, v)]);
    }
  }

  void FitKnown(int x, int y) {
    Cell& cell = cells_[At(x, y)];
    if (cell.known == 0) return;
    PlaneSums sums;
    ForWindow(x, y, kNeighborhood, [&](const Cell& near) {
      if (near.known > 0) sums.Add(SameColor(cell.known_color, near.known_color), near.sums);
    });
    cell.plane = Fit(sums, LeastSpread());
  }

  /// The plane that most of the known cells of the same color lie on, in the smallest window where there are enough.
  std::optional<ImagePlane> Continue(int x, int y) const {
    const Cell& cell = cells_[At(x, y)];
    if (cell.unknown == 0) return std::nullopt;
    std::vector<Witness> witnesses;
    for (int radius = 1; radius <= kMaxWindow; radius *= 2) {
      witnesses.clear();
      float total = 0;
      int pixels = 0;
      ForWindow(x, y, radius, [&](const Cell& near) {
        pixels += size_ * size_;
        if (near.known == 0) return;
        const float same = SameColor(cell.unknown_color, near.known_color);
        if (same < kMinSame) return;
        const float weight = same * static_cast<float>(near.known);
        witnesses.push_back({&near, weight});
        total += weight;
      });
      if (total < kMinWindowShare * static_cast<float>(pixels)) continue;
      if (auto plane = Agreed(witnesses, total)) return plane;
    }
    return std::nullopt;
  }

  static float Agreement(const ImagePlane& plane, const Cell& cell) {
    const float off = (plane.At(cell.x, cell.y) / cell.inv_depth - 1) / kOnPlane;
    return std::max(0.f, 1 - off * off);
  }

  /// The best of the planes of the witnesses, fitted anew to those that lie on it.
  std::optional<ImagePlane> Agreed(const std::vector<Witness>& witnesses, float total) const {
    const Cell* best = nullptr;
    float most = kMinAgreement * total;
    const size_t stride = (witnesses.size() + kMaxCandidates - 1) / kMaxCandidates;
    for (size_t candidate = 0; candidate < witnesses.size(); candidate += stride) {
      const std::optional<ImagePlane>& plane = witnesses[candidate].cell->plane;
      if (!plane) continue;
      float agreed = 0;
      for (const Witness& w : witnesses) agreed += w.weight * Agreement(*plane, *w.cell);
      if (agreed > most) most = agreed, best = witnesses[candidate].cell;
    }
    if (best == nullptr) return std::nullopt;
    PlaneSums sums;
    for (const Witness& w : witnesses) {
      const auto known = static_cast<float>(w.cell->known);
      sums.Add(w.weight / known * Agreement(*best->plane, *w.cell), w.cell->sums);
    }
    return Fit(sums, LeastSpread());
  }

  int size_, across_, down_;
  std::vector<Cell> cells_;
  float nearest_ = 0, farthest_ = 0;  ///< inverse depths between which planes are continued
};

}  // namespace

ContinuedPlanes::ContinuedPlanes(const DepthMap& map, const ImageF& rgb, float min_confidence,
                                 FunctionRef<bool(size_t)> may_fill) {
  const Grid grid(map, rgb, min_confidence, may_fill);
  cell_ = grid.size(), across_ = grid.across();
  nearest_ = grid.nearest(), farthest_ = grid.farthest();
  planes_ = grid.Continued();
}

std::optional<Plane> ContinuedPlanes::At(int x, int y) const {
  const std::optional<ImagePlane>& plane = planes_[static_cast<size_t>(y / cell_) * across_ + x / cell_];
  if (!plane) return std::nullopt;
  const float inv_depth = plane->At(x + 0.5, y + 0.5);
  if (!(inv_depth > farthest_ && inv_depth < nearest_)) return std::nullopt;
  return Plane{inv_depth, static_cast<float>(plane->per_x), static_cast<float>(plane->per_y)};
}

}  // namespace oraclegs
