// SPDX-License-Identifier: MIT
/// An airborne scan: hills with houses seen from above, 2.5-D except for the few points on walls.
#include <array>
#include <vector>

#include "pointsweep/shapes/registry.h"
#include "pointsweep/shapes/rng.h"

namespace pointsweep {
namespace {

constexpr double kSide = 1000;  // side of the terrain in metres
constexpr double kPlot = 40;    // side of a plot in metres, a square that may hold one house
constexpr int kPlots = 25;      // number of plots in a row
constexpr double kHouseChance = 0.4;
constexpr double kFlatRoofChance = 0.2;
constexpr double kWallShare = 0.02;                                         // share of points on walls
constexpr double kSlope = 0.07;                                             // slope at the steepest place of one wave
constexpr std::array<double, 6> kWavelength{950, 700, 520, 380, 290, 220};  // in metres
constexpr std::uint64_t kTerrainSeed = 1;

/// A rectangle with walls and a gable roof, whose ridge runs along the local u axis, or a flat roof (roof_slope 0).
struct House {
  Vec2 center, axis;         ///< center on the map, and unit vector along u
  double half_u, half_v;     ///< half the lengths along u and across, in metres
  double eaves, roof_slope;  ///< height of the eaves above sea level in metres, and rise of the roof per metre

  Vec2 local(double x, double y) const {
    const double dx = x - center.x, dy = y - center.y;
    return {dx * axis.x + dy * axis.y, dy * axis.x - dx * axis.y};
  }
  Vec2 world(Vec2 p) const { return {center.x + p.x * axis.x - p.y * axis.y, center.y + p.x * axis.y + p.y * axis.x}; }
  bool covers(Vec2 p) const { return std::abs(p.x) <= half_u && std::abs(p.y) <= half_v; }
  double roof(double v) const { return eaves + roof_slope * (half_v - std::abs(v)); }
};

class Terrain final : public Shape {
 public:
  Terrain() {
    Rng rng(kTerrainSeed, 0);
    for (std::size_t w = 0; w < kWavelength.size(); ++w) {
      const Vec2 direction = on_circle(rng);
      waves_[w] = {
          {direction.x / kWavelength[w], direction.y / kWavelength[w]}, rng.uniform(), kWavelength[w] * kSlope / 6.2};
    }
    house_on_plot_.fill(-1);
    for (int plot = 0; plot < kPlots * kPlots; ++plot) {
      if (rng.uniform() < kHouseChance) build(plot, rng);
    }
  }

  std::string name() const override { return "terrain"; }
  std::string meaning() const override { return "airborne scan of 1 km x 1 km, hills and houses, uniform in the plan"; }
  Box bounds() const override { return {{0, 0, -40}, {kSide, kSide, 60}}; }

  SurfacePoint sample(Rng& rng) const override {
    if (rng.uniform() < kWallShare) return on_wall(rng);
    const double x = rng.uniform(0, kSide), y = rng.uniform(0, kSide);
    const int plot = static_cast<int>(y / kPlot) * kPlots + static_cast<int>(x / kPlot);
    const int house = house_on_plot_[plot];
    if (house >= 0) {
      const House& h = houses_[house];
      const Vec2 p = h.local(x, y);
      if (h.covers(p)) return on_roof(h, p, x, y);
    }
    const Vec3 g = ground(x, y);
    const double scale = 1 / std::sqrt(g.x * g.x + g.y * g.y + 1);
    return {{x, y, g.z}, {-scale * g.x, -scale * g.y, scale}};
  }

 private:
  struct Wave {
    Vec2 frequency;  ///< periods per metre along x and y
    double phase, amplitude;
  };

  /// Returns the slopes along x and y, and the height of the ground.
  Vec3 ground(double x, double y) const {
    Vec3 g;
    for (const Wave& w : waves_) {
      const WaveValue value = wave(w.frequency.x * x + w.frequency.y * y + w.phase);
      const double steepness = w.amplitude * value.slope;
      g = g + Vec3{steepness * w.frequency.x, steepness * w.frequency.y, w.amplitude * value.value};
    }
    return g;
  }

  void build(int plot, Rng& rng) {
    House h;
    h.center = {(plot % kPlots + 0.5) * kPlot + rng.uniform(-3, 3), (plot / kPlots + 0.5) * kPlot + rng.uniform(-3, 3)};
    h.axis = on_circle(rng);
    h.half_u = rng.uniform(6, 12);
    h.half_v = rng.uniform(4, 8);
    h.eaves = ground(h.center.x, h.center.y).z + rng.uniform(5, 12);
    h.roof_slope = rng.uniform() < kFlatRoofChance ? 0 : rng.uniform(0.3, 1);
    house_on_plot_[plot] = static_cast<int>(houses_.size());
    houses_.push_back(h);
  }

  static SurfacePoint on_roof(const House& h, Vec2 p, double x, double y) {
    const double scale = 1 / std::sqrt(h.roof_slope * h.roof_slope + 1);
    const double across = p.y < 0 ? -scale * h.roof_slope : scale * h.roof_slope;
    return {{x, y, h.roof(p.y)}, {-across * h.axis.y, across * h.axis.x, scale}};
  }

  /// Returns a random point on a wall of a random house, at a height between the ground and the roof at that place.
  SurfacePoint on_wall(Rng& rng) const {
    const House& h = houses_[rng.next() % houses_.size()];
    const double along = rng.uniform(-h.half_u - h.half_v, h.half_u + h.half_v);
    const double side = rng.uniform() < 0.5 ? -1 : 1;
    const bool gable = std::abs(along) > h.half_u;
    const Vec2 p =
        gable ? Vec2{side * h.half_u, along < 0 ? along + h.half_u : along - h.half_u} : Vec2{along, side * h.half_v};
    const Vec2 n = gable ? Vec2{side, 0} : Vec2{0, side};
    const Vec2 at = h.world(p);
    const double z = rng.uniform(ground(at.x, at.y).z, h.roof(p.y));
    return {{at.x, at.y, z}, {n.x * h.axis.x - n.y * h.axis.y, n.x * h.axis.y + n.y * h.axis.x, 0}};
  }

  std::array<Wave, kWavelength.size()> waves_;
  std::vector<House> houses_;
  std::array<int, kPlots * kPlots> house_on_plot_;
};

}  // namespace

std::unique_ptr<Shape> make_terrain() { return std::make_unique<Terrain>(); }

}  // namespace pointsweep
