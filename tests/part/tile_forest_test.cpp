// SPDX-License-Identifier: MIT
/// Signs by the minimum spanning forest of a graph in tiles equal those of the whole graph.
#include "pointsweep/part/tile_forest.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>

#include "pointsweep/connect/components.h"
#include "pointsweep/error.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/part/stored_graph.h"
#include "tests/support/memory_storage.h"
#include "tests/support/scratch_in_memory.h"

namespace pointsweep {
namespace {

/// Sums of numbers that look random, with the signs of the points. The ballot of a point is a byte of its row.
class SignedSums final : public VoteRule {
 public:
  std::size_t ballot_bytes() const override { return 1; }
  std::size_t bytes() const override { return sizeof(std::int64_t); }
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override {
    EXPECT_EQ(*ballot, std::byte(point.row));
    const auto vote = static_cast<std::int64_t>(mix(point.row) >> 20);
    std::memcpy(votes, &vote, sizeof vote);
  }
  void merge(std::byte* into, const std::byte* from, bool flips) const override {
    const std::int64_t sum = of(into) + (flips ? -of(from) : of(from));
    std::memcpy(into, &sum, sizeof sum);
  }
  std::size_t result_bytes() const override { return 1; }
  void conclude(const std::byte* votes, std::byte* result) const override { *result = std::byte{of(votes) < 0}; }
  bool turns(const std::byte* result) const override { return *result != std::byte{0}; }

 private:
  static std::int64_t of(const std::byte* votes) {
    std::int64_t sum;
    std::memcpy(&sum, votes, sizeof sum);
    return sum;
  }
};

/// Points in the order of their tiles, and for each point the rows of the neighbours that it names.
struct CloudOfTiles {
  std::vector<PointKey> points;
  std::vector<std::vector<std::uint64_t>> named;
  TileCatalogue tiles;

  /// Weight and sign are functions of the two points. Many weights are equal.
  void emit(std::uint64_t from, EdgeBatch& batch) const {
    for (const std::uint64_t to : named[from]) {
      const std::uint64_t both = mix(std::min(from, to) * points.size() + std::max(from, to));
      batch.add(batch.number_of(points[from]), batch.number_of(points[to]), static_cast<double>(both % 50),
                both >> 20 & 1);
    }
  }
  /// Brings the rows of a tile, or all rows, to a sink in batches.
  void bring(RowsOfTile rows, EdgeSink& sink) const {
    for (std::uint64_t first = rows.first; first < rows.first + rows.count; first += 17) {
      EdgeBatch batch;
      std::vector<std::byte> ballots;
      const std::uint64_t end = std::min(first + 17, rows.first + rows.count);
      for (std::uint64_t row = first; row < end; ++row) {
        batch.number_of(points[row]);
        ballots.push_back(std::byte(row));
      }
      for (std::uint64_t row = first; row < end; ++row) emit(row, batch);
      batch.reduce(true);
      sink.put(batch, end - first, ballots);
    }
  }
  RowsOfTile rows(std::size_t tile) const { return {tiles.tiles[tile].first_row, tiles.tiles[tile].rows}; }
};

/// Returns points on a line in tiles that overlap a little. Each point names points near it; with `some_anywhere`, some
/// points also name points anywhere.
CloudOfTiles cloud_of(const std::vector<std::uint64_t>& rows_of_tiles, bool some_anywhere, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  CloudOfTiles cloud;
  for (const std::uint64_t rows : rows_of_tiles) {
    cloud.tiles.tiles.push_back({"tile", cloud.points.size(), rows, {}});
    const std::uint64_t first = cloud.points.size();
    for (std::uint64_t i = 0; i < rows; ++i)
      cloud.points.push_back({{static_cast<double>(first + random() % (rows + 9)), 0, 0}, first + i});
  }
  const std::uint64_t n = cloud.points.size();
  for (std::uint64_t i = 0; i < n; ++i) {
    cloud.named.emplace_back();
    for (std::uint64_t j = 0; j < n; ++j) {
      const double distance = std::abs(cloud.points[i].position.x - cloud.points[j].position.x);
      if (i != j && distance < 4 && random() % 4 == 0) cloud.named.back().push_back(j);
    }
    if (some_anywhere && random() % 40 == 0) cloud.named.back().push_back((i + 1 + random() % (n - 1)) % n);
  }
  return cloud;
}

/// Returns a cloud in which some tiles are empty and one tile has a single point.
CloudOfTiles cloud_of(std::uint64_t seed) { return cloud_of({100, 0, 1, 60, 0, 130, 40, 0}, true, seed); }

const MakeScratch kInMemory = []() -> std::unique_ptr<Scratch> { return std::make_unique<ScratchInMemory>(); };
const SignedSums kVotes;
const TileGraphSetup kSetup{&kVotes, kInMemory, nullptr, 1 << 20, {}};

EdgeBuckets buckets_of(const CloudOfTiles& cloud, RowsOfTile rows) {
  std::vector<PointKey> begins;
  for (std::uint64_t row = rows.first; row < rows.first + rows.count; row += 23) begins.push_back(cloud.points[row]);
  return {begins, 0, true, kVotes.ballot_bytes(), kInMemory};
}

std::vector<int> signs_of_whole(const CloudOfTiles& cloud) {
  const RowsOfTile all{0, cloud.points.size()};
  EdgeBuckets buckets = buckets_of(cloud, all);
  cloud.bring(all, buckets);
  const ComponentsSetup setup{&kVotes, kInMemory, 1 << 20, {}};
  std::vector<int> signs(cloud.points.size(), -1);
  Components(buckets, setup).for_each_point([&](std::uint64_t row, const ComponentLabel& label) {
    signs[row] = label.flips;
  });
  return signs;
}

std::vector<std::string> names_of(const CloudOfTiles& cloud, const std::string& round) {
  std::vector<std::string> names;
  for (std::size_t t = 0; t < cloud.tiles.tiles.size(); ++t) names.push_back(round + std::to_string(t));
  return names;
}

void leave_edges(const CloudOfTiles& cloud, Storage& scratch) {
  const std::vector<std::string> names = names_of(cloud, "edges");
  for (std::size_t t = 0; t < names.size(); ++t) {
    EdgeBuckets own = buckets_of(cloud, cloud.rows(t));
    RecordListWriter crossings(scratch, names[t] + ".crossings", sizeof(ForestEdge));
    TileEdges edges(own, cloud.rows(t),
                    [&](std::span<const ForestEdge> some) { crossings.append(std::as_bytes(some)); });
    cloud.bring(cloud.rows(t), edges);
    crossings.seal();
    store_graph(own, kVotes.ballot_bytes(), scratch, names[t]);
  }
}

void find_borders(const CloudOfTiles& cloud, Storage& scratch) {
  find_borders(scratch, cloud.tiles, names_of(cloud, "edges"), kSetup, "borders");
}

void leave_forests(const CloudOfTiles& cloud, Storage& scratch) {
  for (std::size_t t = 0; t < cloud.tiles.tiles.size(); ++t) {
    const std::string number = std::to_string(t);
    leave_forest(scratch, "edges" + number, "borders-" + number, cloud.rows(t), kSetup, "forest" + number);
  }
}

void join_forests(const CloudOfTiles& cloud, Storage& scratch) {
  join_forests(scratch, names_of(cloud, "forest"), "borders", kSetup, "signs");
}

std::vector<int> signs_of_tiles(const CloudOfTiles& cloud, const Storage& scratch) {
  std::vector<int> signs(cloud.points.size(), -1);
  for (std::size_t t = 0; t < cloud.tiles.tiles.size(); ++t)
    for_each_sign(scratch, "forest" + std::to_string(t), "signs", t,
                  [&](std::uint64_t row, const ComponentLabel& label) {
                    int& sign = signs[cloud.tiles.tiles[t].first_row + row];
                    EXPECT_EQ(sign, -1);
                    sign = label.flips;
                  });
  return signs;
}

TEST(TileForest, HasTheSignsOfTheWholeGraph) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const CloudOfTiles cloud = cloud_of(seed);
    MemoryStorage scratch;
    leave_edges(cloud, scratch);
    find_borders(cloud, scratch);
    leave_forests(cloud, scratch);
    join_forests(cloud, scratch);
    ASSERT_EQ(signs_of_tiles(cloud, scratch), signs_of_whole(cloud)) << seed;
  }
}

TEST(TileForest, LeavesNoMoreThanItsBorder) {
  for (const std::uint64_t rows : {500u, 2000u}) {
    const CloudOfTiles cloud = cloud_of({rows, rows, rows}, false, 1);
    MemoryStorage scratch;
    leave_edges(cloud, scratch);
    find_borders(cloud, scratch);
    leave_forests(cloud, scratch);
    for (const char* const object : {"borders-1", "forest1.forest"}) {
      EXPECT_GT(scratch.open(object)->size(), 500u);
      EXPECT_LT(scratch.open(object)->size(), 10'000u);
    }
    join_forests(cloud, scratch);
    EXPECT_EQ(signs_of_tiles(cloud, scratch), signs_of_whole(cloud));
  }
}

/// A task that reads a damaged object names the object, so that it is made again.
TEST(TileForest, NamesTheObjectThatIsDamaged) {
  const CloudOfTiles cloud = cloud_of(1);
  MemoryStorage scratch;
  leave_edges(cloud, scratch);
  find_borders(cloud, scratch);
  leave_forests(cloud, scratch);
  join_forests(cloud, scratch);
  std::size_t damaged = 0;
  for (const std::string& key : scratch.list()) {
    MemoryStorage other = scratch;
    const std::unique_ptr<Source> object = other.open(key);
    std::vector<std::byte> bytes(object->size());
    if (bytes.empty() || key == "borders" || key == "signs") continue;
    object->read_at(0, bytes);
    bytes[bytes.size() / 2] ^= std::byte{4};
    const std::unique_ptr<Unsealed> written = other.create(key);
    written->append(bytes);
    written->seal();
    ++damaged;
    try {
      if (key.ends_with(".crossings")) find_borders(cloud, other);
      if (key.starts_with("borders")) join_forests(cloud, other);
      if (key.starts_with("edges")) leave_forests(cloud, other);
      if (key.ends_with(".forest")) join_forests(cloud, other);
      if (key.starts_with("signs") || key.ends_with(".labels")) signs_of_tiles(cloud, other);
      ADD_FAILURE() << key << " is taken for whole";
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), key + ": is damaged.");
    }
  }
  EXPECT_GT(damaged, 50u);
}

}  // namespace
}  // namespace pointsweep
