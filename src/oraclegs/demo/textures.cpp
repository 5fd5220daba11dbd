#include "oraclegs/demo/textures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/demo/noise.h"

namespace oraclegs {
namespace {

/// Distance to the cell's nearer border, 0 .. 0.5 of a cell.
double FromBorder(const LatticeCell& cell) { return std::min(cell.at, 1 - cell.at); }

template <size_t N>
Vec3 Pick(const std::array<Vec3, N>& palette, double u) {
  return palette[std::min<size_t>(N - 1, static_cast<size_t>(u * N))];
}

constexpr std::array<Vec3, 6> kBright{
    {{.78, .16, .10}, {.93, .62, .10}, {.10, .42, .60}, {.16, .50, .24}, {.90, .86, .74}, {.40, .16, .44}}};
constexpr std::array<Vec3, 5> kChips{
    {{.80, .74, .62}, {.30, .16, .12}, {.62, .34, .20}, {.16, .20, .22}, {.70, .66, .60}}};
constexpr std::array<Vec3, 5> kSprinkles{
    {{.95, .85, .20}, {.15, .60, .85}, {.95, .95, .95}, {.25, .70, .25}, {.90, .35, .10}}};

/// Round flecks, at most one a cell; `found` is its color's random number, below 0 where there is none.
double Fleck(double u, double v, double density, uint32_t seed) {
  const LatticeCell cu = CellOf(u), cv = CellOf(v);
  const auto random = [&](int k) { return LatticeNoise(cu.index, cv.index, k, seed); };
  if (random(0) > density) return -1;
  const double radius = .16 + .2 * random(1);
  const double du = cu.at - (radius + random(2) * (1 - 2 * radius));
  const double dv = cv.at - (radius + random(3) * (1 - 2 * radius));
  const double skew = 1.6 * (random(4) - .5);
  return du * du + dv * dv + skew * du * dv < radius * radius ? random(5) : -1;
}

Vec3 Floor(double u, double v) {
  const LatticeCell cu = CellOf(u / .5), cv = CellOf(v / .5);
  const bool dark = ((cu.index + cv.index) & 1) != 0;
  Vec3 color = dark ? Vec3{.27, .11, .07} : Vec3{.66, .56, .42};
  color = color * (.8 + .4 * LatticeNoise(cu.index, cv.index, 1, 11));
  color = color * (.62 + .76 * FractalNoise({u * 5, v * 5, 0}, 4, 12));
  for (const double scale : {.11, .047}) {
    const double chip = Fleck(u / scale, v / scale, .6, dark ? 13 : 14);
    if (chip >= 0) color = Mix(color, Pick(kChips, chip), .75);
  }
  if (std::min(FromBorder(cu), FromBorder(cv)) < .018) color = {.10, .09, .08};
  return color;
}

Vec3 Brick(double u, double v) {
  const LatticeCell row = CellOf(v / .16);
  const LatticeCell col = CellOf(u / .42 + ((row.index & 1) != 0 ? .5 : 0.));
  const double tint = LatticeNoise(col.index, row.index, 2, 21);
  Vec3 brick = Mix(Vec3{.46, .15, .09}, Vec3{.66, .34, .20}, tint);
  if (LatticeNoise(col.index, row.index, 3, 21) < .12) brick = {.22, .12, .11};
  brick = brick * (.45 + 1.1 * FractalNoise({u * 9, v * 9, 3}, 4, 22));
  const double ragged = .02 * FractalNoise({u * 22, v * 22, 7}, 2, 23);
  const bool mortar = FromBorder(row) * .16 < .006 + ragged || FromBorder(col) * .42 < .006 + ragged;
  return mortar ? Vec3{.60, .57, .52} * (.6 + .6 * FractalNoise({u * 30, v * 30, 1}, 2, 24)) : brick;
}

/// Diamonds in two blues with a motif in each.
Vec3 Wallpaper(double u, double v, const Vec3& a, const Vec3& b) {
  const LatticeCell p = CellOf((u + v) / .44), q = CellOf((u - v) / .44);
  const double du = p.at - .5, dv = q.at - .5;
  const double r2 = du * du + dv * dv;
  Vec3 color = ((p.index + q.index) & 1) != 0 ? a : b;
  if (std::min(FromBorder(p), FromBorder(q)) < .035) color = {.80, .70, .42};
  if (r2 < .055) color = Pick(kBright, LatticeNoise(p.index, q.index, 4, 31));
  if (r2 < .018) color = {.88, .84, .72};
  return color * (.6 + .8 * FractalNoise({u * 6, v * 6, 5}, 5, 32));
}

/// Hash-colored patches, some of them cut into smaller ones, worn by noise.
Vec3 Quilt(double u, double v, double patch, uint32_t seed) {
  const LatticeCell cu = CellOf(u / patch), cv = CellOf(v / patch);
  const double kind = LatticeNoise(cu.index, cv.index, 0, seed);
  Vec3 color = Pick(kBright, LatticeNoise(cu.index, cv.index, 1, seed));
  if (kind < .45) {
    const LatticeCell fu = CellOf(3 * u / patch), fv = CellOf(3 * v / patch);
    color = Mix(color, Pick(kBright, LatticeNoise(fu.index, fv.index, 2, seed)), .9);
  } else if (kind < .75) {
    const double du = cu.at - .5, dv = cv.at - .5, r2 = du * du + dv * dv;
    if (r2 < .13 && r2 > .04) color = Pick(kBright, LatticeNoise(cu.index, cv.index, 3, seed));
  }
  if (std::min(FromBorder(cu), FromBorder(cv)) < .04) color = {.12, .10, .09};
  return color * (.65 + .7 * FractalNoise({u * 14, v * 14, 2}, 3, seed + 1));
}

/// A framed picture where (u, v) falls into it; returns false elsewhere.
bool Picture(double u, double v, const Vec3& spot, uint32_t seed, Vec3* color) {
  const double half = spot.z;
  const double du = (u - spot.x) / half, dv = (v - spot.y) / (.78 * half);
  const double edge = std::max(std::abs(du), std::abs(dv));
  if (edge > 1) return false;
  if (edge > .88) {
    *color = Vec3{.24, .15, .06} * (.7 + .8 * FractalNoise({u * 20, v * 20, 4}, 3, seed));
  } else if (edge > .76) {
    *color = {.82, .79, .72};
  } else {
    const double hill = .35 * FractalNoise({u * 3, 0, 1}, 4, seed) - .2;
    const Vec3 sky =
        Mix(Vec3{.80, .62, .34}, Vec3{.16, .30, .55}, Clamp01(dv + .4 * FractalNoise({u * 5, v * 9, 2}, 4, seed)));
    *color = dv > 2 * hill ? sky : Quilt(u, v, .09, seed + 5);
  }
  return true;
}

Vec3 RoomWall(const Vec3& p, const Vec3& n, const Vec3& size) {
  if (n.z < -.5) return Floor(p.x, p.y);
  if (n.z > .5) return Vec3{.74, .72, .68} * (.85 + .3 * FractalNoise(p * 4, 3, 41));
  const double height = p.z + size.z;
  if (height < .14) return Vec3{.30, .20, .12} * (.5 + FractalNoise({p.x * 3 + p.y * 3, height * 40, 0}, 4, 42));
  Vec3 color;
  if (n.y > .5) {
    if (Picture(p.x, height, {-1.35, 1.75, .62}, 51, &color)) return color;
    if (Picture(p.x, height, {1.2, 1.9, .75}, 57, &color)) return color;
    return Brick(p.x, height);
  }
  if (n.x < -.5) {
    if (Picture(p.y, height, {.7, 1.7, .7}, 63, &color)) return color;
    return Wallpaper(p.y, height, {.10, .24, .34}, {.16, .36, .44});
  }
  if (Picture(p.y, height, {.9, 1.75, .66}, 69, &color)) return color;
  return Wallpaper(p.y, height, {.36, .30, .12}, {.52, .46, .24});
}

/// The two coordinates across a box's face; `along` grain runs with u.
struct FacePoint {
  double u, v, half_u, half_v;
  int64_t face;
};

FacePoint OnFace(const Vec3& p, const Vec3& n, const Vec3& size) {
  if (std::abs(n.x) > .5) return {p.y, p.z, size.y, size.z, n.x > 0 ? 1 : 2};
  if (std::abs(n.y) > .5) return {p.x, p.z, size.x, size.z, n.y > 0 ? 3 : 4};
  return {p.x, p.y, size.x, size.y, n.z > 0 ? 5 : 6};
}

Vec3 Wood(double along, double across, int64_t plank, int64_t face) {
  const double shift = 7 * LatticeNoise(plank, face, 1, 71);
  const double grain = FractalNoise({along * 3 + shift, across * 38, shift}, 4, 72);
  const double rings = FractalNoise({along * 1.5 + shift, across * 9, shift}, 3, 73);
  const double tint = .75 + .5 * LatticeNoise(plank, face, 2, 71);
  return Mix(Vec3{.24, .11, .04}, Vec3{.68, .42, .19}, Clamp01(1.5 * (.55 * grain + .45 * rings) - .25)) * tint;
}

Vec3 Crate(const Vec3& p, const Vec3& n, const Vec3& size) {
  const FacePoint f = OnFace(p, n, size);
  constexpr double kFrame = .085, kGap = .006;
  const double du = f.half_u - std::abs(f.u), dv = f.half_v - std::abs(f.v);
  if (std::min(du, dv) < kFrame) {
    const bool upright = du < dv;
    const double nail_u = du - kFrame / 2, nail_v = dv - kFrame / 2;
    if (nail_u * nail_u + nail_v * nail_v < .0004) return {.05, .05, .06};
    return upright ? Wood(f.v, f.u, f.u > 0 ? 11 : 12, f.face) * .8 : Wood(f.u, f.v, f.v > 0 ? 13 : 14, f.face) * .8;
  }
  if (std::min(du, dv) < kFrame + kGap) return {.04, .03, .02};
  const LatticeCell plank = CellOf(f.v / .13);
  if (FromBorder(plank) * .13 < kGap) return {.04, .03, .02};
  const LatticeCell su = CellOf(f.u / .035 + .5), sv = CellOf(f.v / .035 + .5);
  const bool stencil = std::abs(f.u) < .15 && std::abs(f.v) < .12 && LatticeNoise(su.index, sv.index, f.face, 74) < .45;
  const Vec3 wood = Wood(f.u, f.v, plank.index, f.face);
  return stencil ? Mix(wood, Vec3{.06, .07, .10}, .8) : wood;
}

Vec3 Marble(const Vec3& p) {
  const double warp = FractalNoise(p * 5, 5, 81);
  const LatticeCell vein = CellOf(2.2 * (p.x + .6 * p.y + .8 * p.z) + 3.2 * warp);
  const double line = Smoothstep(.0, .16, FromBorder(vein));
  const Vec3 stone = Mix(Vec3{.30, .46, .42}, Vec3{.86, .86, .80}, FractalNoise(p * 8, 5, 82) * 1.3 - .1);
  return Mix(Vec3{.07, .16, .15}, stone, .15 + .85 * line);
}

/// Nearest of the jittered lattice points, and by how much it beats the second nearest.
struct Voronoi {
  double owner, margin;
};

Voronoi VoronoiAt(const Vec3& p, uint32_t seed) {
  const int64_t bx = CellOf(p.x).index, by = CellOf(p.y).index, bz = CellOf(p.z).index;
  double first = 1e9, second = 1e9, owner = 0;
  for (int k = 0; k < 27; ++k) {
    const int64_t x = bx + k % 3 - 1, y = by + k / 3 % 3 - 1, z = bz + k / 9 - 1;
    const Vec3 site{static_cast<double>(x) + LatticeNoise(x, y, z, seed),
                    static_cast<double>(y) + LatticeNoise(x, y, z, seed + 1),
                    static_cast<double>(z) + LatticeNoise(x, y, z, seed + 2)};
    const double d = Dot(site - p, site - p);
    if (d < first) {
      second = first;
      first = d;
      owner = LatticeNoise(x, y, z, seed + 3);
    } else if (d < second) {
      second = d;
    }
  }
  return {owner, std::sqrt(second) - std::sqrt(first)};
}

Vec3 Candy(const Vec3& p) {
  const Voronoi v = VoronoiAt(p * 8, 91);
  Vec3 color = v.margin < .1 ? Vec3{.92, .90, .84} : Pick(kBright, v.owner);
  const double speckle = ValueNoise(p * 42, 95);
  if (speckle > .74) color = Mix(color, Vec3{.95, .93, .88}, .8);
  if (speckle < .22) color = color * .35;
  return color * (.75 + .5 * FractalNoise(p * 9, 3, 96));
}

/// Runs once around the axis, 0 .. 4, without an arctangent; equal steps are not quite equal angles.
double Around(double x, double y) {
  const double r = std::abs(x) + std::abs(y);
  if (r == 0) return 0;
  const double t = y / r;
  if (x >= 0) return t >= 0 ? t : 4 + t;
  return 2 - t;
}

Vec3 Tiles(const Vec3& p, const Vec3& n) {
  if (std::abs(n.z) > .5) return Quilt(p.x, p.y, .09, 101);
  const LatticeCell row = CellOf(p.z / .17);
  const LatticeCell col = CellOf(Around(p.x, p.y) * 3);
  if (FromBorder(row) < .05 || FromBorder(col) < .05) return {.80, .77, .70};
  Vec3 base = (row.index & 1) != 0 ? Vec3{.12, .26, .50} : Vec3{.86, .80, .66};
  const Vec3 ink = (row.index & 1) != 0 ? Vec3{.90, .78, .40} : Vec3{.62, .18, .12};
  const double du = col.at - .5, dv = row.at - .5;
  const double ring = du * du + dv * dv;
  switch (static_cast<int>(4 * LatticeNoise(col.index, row.index, 0, 102))) {
    case 0:
      base = ring < .1 && ring > .03 ? ink : base;
      break;
    case 1:
      base = std::abs(du + dv) < .16 ? ink : base;
      break;
    case 2:
      base = std::abs(du) + std::abs(dv) < .28 ? ink : base;
      break;
    default:
      base = du * dv > 0 ? ink : base;
      break;
  }
  return base * (.65 + .7 * FractalNoise(p * 16, 4, 103));
}

Vec3 Donut(const Vec3& p, const Vec3& size) {
  const double drip = .05 * FractalNoise({p.x * 9, p.y * 9, 0}, 2, 111) - .03;
  const double speck = FractalNoise(p * 22, 3, 113);
  if (p.z < drip) return Mix(Vec3{.36, .18, .06}, Vec3{.82, .54, .25}, Clamp01(1.6 * speck - .3));
  const LatticeCell cu = CellOf(p.x / .052), cv = CellOf(p.y / .052);
  const auto random = [&](int k) { return LatticeNoise(cu.index, cv.index, k, 112); };
  if (random(0) < .75 && p.z > drip + .02 * size.y) {
    const SinCos turn = SinCosOfTurns(random(1));
    const double du = cu.at - .5, dv = cv.at - .5;
    const double along = du * turn.cos + dv * turn.sin, across = dv * turn.cos - du * turn.sin;
    if (std::abs(along) < .4 && std::abs(across) < .13) return Pick(kSprinkles, random(2));
  }
  return Mix(Vec3{.62, .16, .30}, Vec3{.92, .50, .58}, Clamp01(1.7 * FractalNoise(p * 7, 4, 114) - .35));
}

Vec3 Glaze(const Vec3& p) {
  const double cloud = FractalNoise(p * 6, 5, 121);
  const Vec3 color = Mix(Vec3{.01, .05, .12}, Vec3{.05, .26, .34}, Clamp01(1.8 * cloud - .4));
  return ValueNoise(p * 30, 122) > .80 ? Vec3{.80, .58, .22} : color;
}

Vec3 Paint(const Vec3& n) {
  if (n.z < -.5) return {.52, .42, .33};
  if (n.z > .5) return {.74, .72, .68};
  if (n.y > .5) return {.80, .74, .60};
  return n.x < 0 ? Vec3{.42, .60, .66} : Vec3{.74, .56, .42};
}

/// Patches from a hand's width to a house's.
Vec3 Ground(double u, double v) {
  const double patch = FractalNoise({u / 7, v / 7, 0}, 6, 141);
  Vec3 color = Mix(Vec3{.40, .29, .17}, Vec3{.17, .29, .08}, Smoothstep(.44, .56, patch));
  color = color * (.35 + 1.3 * FractalNoise({u * 4, v * 4, 0}, 5, 142));
  for (const double scale : {.5, .13}) {
    const double stone = Fleck(u / scale, v / scale, .35, 143);
    if (stone >= 0) color = Mix(color, Pick(kChips, stone), .7);
  }
  return color;
}

Vec3 House(const Vec3& p, const Vec3& n, const Vec3& size) {
  const FacePoint f = OnFace(p, n, size);
  const auto random = [&](int64_t i, int64_t j, uint32_t k) { return LatticeNoise(i, j, f.face, 151 + k); };
  if (std::abs(n.z) > .5) return Brick(f.u / 3, f.v / 3);
  const double of_house = LatticeNoise(static_cast<int64_t>(100 * size.x), static_cast<int64_t>(100 * size.z), 0, 150);
  const LatticeCell cu = CellOf(f.u / 1.1), cv = CellOf((f.v + f.half_v) / 1.5);
  const double du = std::abs(cu.at - .5), dv = std::abs(cv.at - .5);
  if (du < .24 && dv < .28) {
    const Vec3 pane = Mix(Vec3{.04, .06, .09}, Vec3{.62, .66, .66}, random(cu.index, cv.index, 1));
    const Vec3 blind = Pick(kBright, random(cu.index, cv.index, 2));
    return cv.at - .22 > .56 * random(cu.index, cv.index, 3) ? blind : pane;
  }
  if (du < .30 && dv < .35) return {.86, .84, .78};
  if (FromBorder(cv) < .05) return Vec3{.30, .26, .22};
  const Vec3 plaster = Mix(Pick(kBright, of_house), Vec3{.72, .66, .56}, .55);
  return plaster * (.3 + 1.3 * FractalNoise({f.u * 1.3, f.v * 1.3, 9 * of_house}, 5, 154));
}

}  // namespace

Vec3 Albedo(Texture texture, const Vec3& point, const Vec3& normal, const Vec3& size) {
  Vec3 color;
  switch (texture) {
    case Texture::kRoom:
      color = RoomWall(point, normal, size);
      break;
    case Texture::kCrate:
      color = Crate(point, normal, size);
      break;
    case Texture::kQuilt: {
      const FacePoint f = OnFace(point, normal, size);
      color = Quilt(f.u + 3.0 * static_cast<double>(f.face), f.v, .11, 131);
      break;
    }
    case Texture::kMarble:
      color = Marble(point);
      break;
    case Texture::kCandy:
      color = Candy(point);
      break;
    case Texture::kTiles:
      color = Tiles(point, normal);
      break;
    case Texture::kDonut:
      color = Donut(point, size);
      break;
    case Texture::kGlaze:
      color = Glaze(point);
      break;
    case Texture::kPaint:
      color = Paint(normal);
      break;
    case Texture::kGround:
      color = Ground(point.x, point.y);
      break;
    case Texture::kHouse:
      color = House(point, normal, size);
      break;
  }
  return {Clamp01(color.x), Clamp01(color.y), Clamp01(color.z)};
}

}  // namespace oraclegs
