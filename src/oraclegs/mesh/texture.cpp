#include "oraclegs/mesh/texture.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr int kGutter = 2;       // texels around a chart, which filters read
constexpr int kMinSide = 64;     // of a texture that is made smaller than asked for
constexpr int kBisections = 12;  // of the density
constexpr float kInside = 1e-4f;
constexpr uint8_t kNeverSeen = 128;  // gray

/// Texels of a chart's side of this length.
int TexelsOf(double length) { return static_cast<int>(std::ceil(length)) + 1 + 2 * kGutter; }

/// Pixels per scene unit of the camera that is nearest in them.
double DensityAt(const Eigen::Vector3d& point, const std::vector<Camera>& cameras) {
  double density = 0;
  for (const Camera& camera : cameras) density = std::max(density, camera.fx / (camera.Center() - point).norm());
  return density;
}

Eigen::Vector3f Weights(const Eigen::Vector2f& a, const Eigen::Vector2f& b, const Eigen::Vector2f& c,
                        const Eigen::Vector2f& at) {
  const auto cross = [](const Eigen::Vector2f& p, const Eigen::Vector2f& q) { return p.x() * q.y() - p.y() * q.x(); };
  const float area = cross(b - a, c - a);
  if (area == 0) return Eigen::Vector3f::Constant(-1);
  const float v = cross(at - a, c - a) / area, w = cross(b - a, at - a) / area;
  return {1 - v - w, v, w};
}

}  // namespace

TextureAtlas::TextureAtlas(const TriangleMesh& mesh, const std::vector<Camera>& cameras, int max_side)
    : charts_(ChartsOf(mesh)), rectangles_(charts_.size()), side_(max_side) {
  for (const Chart& chart : charts_) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const uint32_t vertex : chart.vertices) middle += mesh.positions[vertex].cast<double>();
    densities_.push_back(DensityAt(middle / static_cast<double>(chart.vertices.size()), cameras));
  }
  if (Pack(1, side_)) {
    while (side_ / 2 >= kMinSide && Pack(1, side_ / 2)) side_ /= 2;
  } else {
    if (!Pack(0, side_)) {
      throw UsageError("--texture is {}: too small for the {} pieces of this surface; give more, or fewer --triangles",
                       max_side, charts_.size());
    }
    double fits = 0, fails = 1;
    for (int i = 0; i < kBisections; ++i) {
      const double middle = (fits + fails) / 2;
      (Pack(middle, side_) ? fits : fails) = middle;
    }
    share_ = fits;
  }
  Pack(share_, side_);
  has_point_.resize(static_cast<size_t>(Texel(0, side_)));
  for (size_t chart = 0; chart < charts_.size(); ++chart) Draw(mesh, chart);
}

/// Puts the charts on shelves, the highest first. False when they need more than the square.
bool TextureAtlas::Pack(double share, int side) {
  for (size_t i = 0; i < charts_.size(); ++i) {
    const double scale = share * densities_[i];
    rectangles_[i].width = TexelsOf(scale * static_cast<double>(charts_[i].size.x()));
    rectangles_[i].height = TexelsOf(scale * static_cast<double>(charts_[i].size.y()));
  }
  std::vector<size_t> order(charts_.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return rectangles_[a].height > rectangles_[b].height; });
  int x = 0, y = 0, shelf = 0;
  for (const size_t i : order) {
    Rectangle& rectangle = rectangles_[i];
    if (rectangle.width > side) return false;
    if (x + rectangle.width > side) x = 0, y += shelf, shelf = 0;
    shelf = std::max(shelf, rectangle.height);
    if (y + shelf > side) return false;
    rectangle.x = x, rectangle.y = y;
    x += rectangle.width;
  }
  return true;
}

/// Adds the vertices and triangles of a chart, and a point for each texel whose center is on it.
void TextureAtlas::Draw(const TriangleMesh& mesh, size_t chart_index) {
  const Chart& chart = charts_[chart_index];
  const Rectangle& rectangle = rectangles_[chart_index];
  const auto scale = static_cast<float>(share_ * densities_[chart_index]);
  const Eigen::Vector2f corner(static_cast<float>(rectangle.x + kGutter) + 0.5f,
                               static_cast<float>(rectangle.y + kGutter) + 0.5f);
  const auto at = [&](uint32_t k) { return Eigen::Vector2f(corner + scale * chart.places[k]); };
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  const auto add = [&](int x, int y, const Eigen::Vector3f& position, const Eigen::Vector3f& normal) {
    const int64_t texel = Texel(x, y);
    if (std::exchange(has_point_[static_cast<size_t>(texel)], uint8_t{1}) != 0) return;
    texels_.push_back(texel);
    points_.positions.push_back(position);
    points_.normals.push_back(normal);
  };
  for (const auto& t : chart.corners) {
    const Eigen::Vector2f a = at(t[0]), b = at(t[1]), c = at(t[2]);
    const Eigen::Vector2f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const uint32_t va = chart.vertices[t[0]], vb = chart.vertices[t[1]], vc = chart.vertices[t[2]];
    for (int y = static_cast<int>(low.y()); y <= static_cast<int>(high.y()); ++y) {
      for (int x = static_cast<int>(low.x()); x <= static_cast<int>(high.x()); ++x) {
        const Eigen::Vector3f w = Weights(a, b, c, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        if (w.minCoeff() < -kInside) continue;
        add(x, y, w[0] * mesh.positions[va] + w[1] * mesh.positions[vb] + w[2] * mesh.positions[vc],
            w[0] * mesh.normals[va] + w[1] * mesh.normals[vb] + w[2] * mesh.normals[vc]);
      }
    }
    mesh_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  for (uint32_t k = 0; k < chart.vertices.size(); ++k) {
    const uint32_t vertex = chart.vertices[k];
    const Eigen::Vector2f place = at(k);
    add(static_cast<int>(place.x()), static_cast<int>(place.y()), mesh.positions[vertex], mesh.normals[vertex]);
    mesh_.positions.push_back(mesh.positions[vertex]);
    mesh_.normals.push_back(mesh.normals[vertex]);
    mesh_.texcoords.emplace_back(place / static_cast<float>(side_));
  }
}

TriangleMesh TextureAtlas::Textured(const VertexColors& colors) const {
  TriangleMesh mesh = mesh_;
  mesh.texture = {side_, side_, 3, std::vector<uint8_t>(3 * has_point_.size(), kNeverSeen)};
  std::vector<uint8_t> seen(has_point_.size());
  const std::vector<std::array<uint8_t, 3>> found = colors.Colors();
  for (size_t i = 0; i < texels_.size(); ++i) {
    if (colors.Views(i) == 0) continue;
    const auto texel = static_cast<size_t>(texels_[i]);
    seen[texel] = 1;
    std::copy(found[i].begin(), found[i].end(), mesh.texture.data.begin() + static_cast<std::ptrdiff_t>(3 * texel));
  }
  for (const Rectangle& rectangle : rectangles_) Fill(rectangle, &seen, &mesh.texture);
  return mesh;
}

/// Spreads seen colors over a rectangle, nearest first.
void TextureAtlas::Fill(const Rectangle& rectangle, std::vector<uint8_t>* seen, Image8* texture) const {
  struct Place {
    int x, y;
  };
  std::vector<Place> reached;
  for (int y = rectangle.y; y < rectangle.y + rectangle.height; ++y) {
    for (int x = rectangle.x; x < rectangle.x + rectangle.width; ++x) {
      if ((*seen)[static_cast<size_t>(Texel(x, y))] != 0) reached.push_back({x, y});
    }
  }
  for (size_t i = 0; i < reached.size(); ++i) {
    const Place from = reached[i];
    for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
      const int x = from.x + dx, y = from.y + dy;
      if (x < rectangle.x || y < rectangle.y || x >= rectangle.x + rectangle.width ||
          y >= rectangle.y + rectangle.height)
        continue;
      if (std::exchange((*seen)[static_cast<size_t>(Texel(x, y))], uint8_t{1}) != 0) continue;
      std::copy_n(texture->data.begin() + static_cast<std::ptrdiff_t>(3 * Texel(from.x, from.y)), 3,
                  texture->data.begin() + static_cast<std::ptrdiff_t>(3 * Texel(x, y)));
      reached.push_back({x, y});
    }
  }
}

}  // namespace oraclegs
