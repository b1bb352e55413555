// SPDX-License-Identifier: MIT
/// The tiles of a cloud, each swept alone, have the bytes of one sweep, whatever the division and the halo.
#include "pointsweep/part/part_stream.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/memory_storage.h"
#include "tests/sweep/swept_cloud.h"

namespace pointsweep {
namespace {

using Tiles = std::vector<std::vector<Vec3>>;

/// Divides a cloud into tiles: point p belongs to tile tile_of(p).
template <class TileOf>
Tiles divided(const std::vector<Vec3>& cloud, std::size_t tiles, TileOf tile_of) {
  Tiles made(tiles);
  for (const Vec3& p : cloud) made[tile_of(p)].push_back(p);
  return made;
}

std::vector<std::pair<std::string, Tiles>> divisions(const std::vector<Vec3>& cloud) {
  std::mt19937_64 rng(5);
  const auto inside = [](Vec3 p) { return std::abs(p.x - 2) < 0.5 && std::abs(p.y - 0.5) < 0.25; };
  const auto clamped = [](double v, double most) { return static_cast<std::size_t>(std::clamp(v, 0.0, most)); };
  bool first = true;
  return {
      {"slices", divided(cloud, 4, [&](Vec3 p) { return clamped(p.x, 3); })},
      {"slices so small that those far away make a group",
       divided(cloud, 48, [&](Vec3 p) { return clamped(p.x * 6, 23) * 2 + (p.y > 0.5); })},
      {"squares, some of them empty", divided(cloud, 9, [&](Vec3 p) { return clamped(p.x, 3) * 2 + (p.y > 0.5); })},
      {"tiles that overlap a little",
       divided(cloud, 3, [&](Vec3 p) { return clamped(p.x * 0.7 + 0.1 * uniform(rng), 2); })},
      {"tiles at the same place", divided(cloud, 3, [&](Vec3) { return clamped(3 * uniform(rng), 2); })},
      {"a tile inside another", divided(cloud, 2, [&](Vec3 p) { return std::size_t{inside(p)}; })},
      {"a tile of one point", divided(cloud, 2, [&](Vec3) { return std::size_t{std::exchange(first, false)}; })},
      {"tiles of a few far points", divided(cloud, 2, [&](Vec3 p) { return std::size_t{p.x > 4 || p.z > 0.3}; })},
  };
}

/// Tiles in a scratch, and a sweep of each as a part of the cloud.
class StoredTiles {
 public:
  StoredTiles(const Tiles& tiles, std::uint64_t slab_points) {
    std::vector<std::string> names;
    for (const std::vector<Vec3>& points : tiles) {
      names.push_back("tile-" + std::to_string(names.size()));
      const PointSource source = source_of(points);
      StreamOptions order;
      order.slab_points = slab_points;
      order.canonical = false;
      const Survey surveyed = survey(source, std::nullopt, true);
      const Stream stream(source, surveyed, order);
      working_ = stream.record_schema();
      with_threads(3, [&] { store_tile(stream, surveyed, points.size(), scratch_, names.back()); });
    }
    catalogue_ = decoded<TileCatalogue>(encoded(std::as_const(catalogue_ = catalogue_of(scratch_, names, names))));
  }

  /// Sweeps a tile. `steps`: number of steps for which the halo is cut.
  void sweep_tile(std::size_t tile, const Chain& chain, std::size_t steps, Collected& sink,
                  SweepStatistics& sum) const {
    PlannedPass planned = plan_chain(chain, schema_in_scratch(working_)).passes.front();
    PartStream part = part_stream(scratch_, catalogue_, tile, working_, planned.plan.neighborhood, steps);
    planned.bind(part.stream.record_schema());
    SweepOptions options;
    options.cell_points = 32;
    SweepStatistics swept;
    with_threads(3, [&] { swept = sweep(part.stream, planned.plan, sink, options); });
    EXPECT_EQ(swept.certified, part.own_points);
    sum.certified += swept.certified;
    sum.degenerate.resize(swept.degenerate.size());
    add_rows(sum.degenerate, swept.degenerate);
  }

 private:
  MemoryStorage scratch_;
  Schema working_;
  TileCatalogue catalogue_;
};

struct PartCase {
  std::uint64_t slab_points;
  std::size_t steps;  ///< number of steps for which the halo is cut; the chain has four
};

/// Prints the parameter of a test for its name in lists.
void PrintTo(const PartCase& part, std::ostream* out) {
  *out << "slabs of " << part.slab_points << " and " << part.steps << " steps";
}

class PartOfACloud : public testing::TestWithParam<PartCase> {};

TEST_P(PartOfACloud, HasTheBytesOfTheWholeCloud) {
  for (const auto& [name, cloud] : clouds()) {
    for (const auto& [division, tiles] : divisions(cloud)) {
      std::vector<Vec3> in_order;  // rows are those of the tiles, one tile after another
      for (const std::vector<Vec3>& tile : tiles) in_order.insert(in_order.end(), tile.begin(), tile.end());
      const StoredTiles stored(tiles, GetParam().slab_points);
      for (const std::size_t k : {std::size_t{6}, std::size_t{70}}) {
        SCOPED_TRACE(name + ", " + division + ", k " + std::to_string(k));
        const Swept whole = swept(in_order, deep_chain(k), in_order.size() + 1, {});
        Collected sink(in_order.size(), static_cast<std::uint32_t>(whole.records.size() / in_order.size()));
        Swept parts;
        for (std::size_t t = 0; t < tiles.size(); ++t)
          stored.sweep_tile(t, deep_chain(k), GetParam().steps, sink, parts.statistics);
        EXPECT_EQ(std::ranges::count(sink.times, 1), std::ptrdiff_t(in_order.size()));
        parts.records = std::move(sink.records);
        expect_same(parts, whole);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Halos, PartOfACloud,
                         testing::Values(PartCase{40, 0}, PartCase{40, 4}, PartCase{10'000, 1}, PartCase{10'000, 100}));

TEST(Part, OfAnotherLayoutIsRefused) {
  MemoryStorage scratch;
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}};
  PointSource source = source_of(points);
  const Survey surveyed = survey(source, std::nullopt, true);
  store_tile(Stream(source, surveyed, {}), surveyed, 2, scratch, "a");
  source.schema.append("height", Type::f32);
  source.read = [](std::uint64_t, std::span<std::byte> records) { return records.size() / 28; };
  StreamOptions with_height;
  with_height.payload = {3};
  store_tile(Stream(source, surveyed, with_height), surveyed, 2, scratch, "b");
  EXPECT_THROW(catalogue_of(scratch, {"a", "b"}, {"a.las", "b.las"}), Error);
}

}  // namespace
}  // namespace pointsweep
