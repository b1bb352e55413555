// SPDX-License-Identifier: MIT
/// Slabs made on demand from the boxes of the inputs: results are those of a distribution pass, the order spills
/// nothing, and the plan states its choice with a reason.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <memory>

#include "pointsweep/fail.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/run/preview.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// A function from a row to its place.
using PlaceOf = std::function<Vec3(std::uint64_t row)>;

/// A reader of x, y, z and intensity (the row). Any number of threads can read from any row on.
class TileReader final : public Reader {
 public:
  TileReader(std::string name, std::uint64_t count, std::optional<Box> bounds, PlaceOf place)
      : place_(std::move(place)) {
    for (const char* field : {"x", "y", "z", "intensity"}) info_.schema.append(field, Type::f64);
    info_.path = std::move(name);
    info_.count = count;
    info_.bounds = bounds;
  }
  bool has_decoders() const override { return true; }
  bool decodes_any_range() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields&) const override { return std::make_unique<Decoder>(*this); }

 private:
  class Decoder final : public RowDecoder {
   public:
    explicit Decoder(const TileReader& reader) : reader_(reader) {}
    std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
      const std::size_t rows = reader_.rows_for(row, records);
      for (std::size_t i = 0; i < rows; ++i) {
        const Vec3 p = reader_.place_(row + i);
        const double values[] = {p.x, p.y, p.z, static_cast<double>((row + i) % 100)};
        std::memcpy(records.data() + i * sizeof values, values, sizeof values);
      }
      return rows;
    }

   private:
    const TileReader& reader_;
  };

  PlaceOf place_;
};

double hashed(std::uint64_t n) {
  n = (n ^ (n >> 31)) * 0x9e3779b97f4a7c15;
  n = (n ^ (n >> 29)) * 0xbf58476d1ce4e5b9;
  return static_cast<double>((n ^ (n >> 32)) >> 11) * 0x1p-53;
}

/// Returns a hilly surface over [from, from + width] x [0, 1], with points in random order.
PlaceOf hills(double from, double width, std::uint64_t seed) {
  return [=](std::uint64_t row) {
    const double x = from + width * hashed(3 * row + 1 + (seed << 40)), y = hashed(3 * row + 2 + (seed << 40));
    return Vec3{x, y, 0.1 * std::sin(7 * x) * std::cos(5 * y) + 0.002 * hashed(3 * row + (seed << 40))};
  };
}

Box box_of(double from, double to) { return {{from, 0, -0.2}, {to, 1, 0.2}}; }

/// Returns tiles in a row along x that overlap a little.
InputCloud tiles_in_a_row(std::size_t tiles, std::uint64_t points, bool state_boxes = true) {
  std::vector<std::unique_ptr<Reader>> readers;
  for (std::size_t t = 0; t < tiles; ++t) {
    const auto from = static_cast<double>(t);
    readers.push_back(std::make_unique<TileReader>(
        fmt::format("tile{}", t), points, state_boxes ? std::optional(box_of(from, from + 1.05)) : std::nullopt,
        hills(from, 1.05, t)));
  }
  return InputCloud(std::move(readers));
}

/// Returns tiles with outliers above and beside the tiles, copies of points, and a dense place.
InputCloud hostile_tiles() {
  std::vector<std::unique_ptr<Reader>> readers;
  for (std::uint64_t t = 0; t < 5; ++t) {
    const PlaceOf surface = hills(static_cast<double>(t), 1, t);
    readers.push_back(
        std::make_unique<TileReader>("hostile", 1500, std::nullopt, [surface, t](std::uint64_t row) -> Vec3 {
          if (row % 300 == 7) return {5 * hashed(row + t), 3 * hashed(row), 4 * hashed(row * 7)};
          if (row % 5 == 0) return surface(row % 150);  // copies of 30 points
          if (row % 11 == 0) return 0.01 * surface(row) + Vec3{0.3 + static_cast<double>(t), 0.5, 0};
          return surface(row);
        }));
  }
  return InputCloud(std::move(readers));
}

EngineOptions small(Ordering ordering) {
  EngineOptions options;
  options.ordering = ordering;
  options.slab_points = 400;
  options.cell_points = 64;
  options.block_rows = 90;
  return options;
}

void expect_the_same_both_ways(InputCloud& cloud, const std::string& pipeline, EngineOptions options) {
  SCOPED_TRACE(pipeline);
  options.ordering = Ordering::distribution;
  const RunResult wanted = run_in_memory(cloud, chain_of_any_cloud(pipeline), options);
  EXPECT_EQ(wanted.statistics.ordering.substr(0, 15), "by distribution");
  options.ordering = Ordering::on_demand;
  for (const unsigned threads : {1, 2, 4}) {
    for (const bool spill : {false, true}) {
      options.resources.threads = threads;
      options.spill = spill;
      const RunResult got = run_in_memory(cloud, chain_of_any_cloud(pipeline), options);
      EXPECT_THAT(got.statistics.ordering, StartsWith("by the boxes of the inputs"));
      EXPECT_EQ(got.statistics.bytes_spilled > 0, spill);
      EXPECT_EQ(got.records, wanted.records) << threads << " threads, spilling " << spill;
      EXPECT_EQ(got.statistics.certified, wanted.statistics.certified);
    }
  }
}

TEST(OnDemandOrder, GivesTheBytesOfADistributionForEveryKindOfChain) {
  InputCloud cloud = tiles_in_a_row(4, 1500);
  for (const char* pipeline :
       {"knn(k=6) | normals", "knn(k=8) | normals | curvature | splats | fair", "knn(radius=0.05) | normals",
        "knn(k=20, radius=0.04) | normals | curvature", "knn(k=80) | normals",
        "knn(k=6) | normals | splats | fair | reneighbor | normals", "knn(k=8) | sor | normals", "unique",
        "knn(k=6) | normals | where(intensity < 30) | splats"})
    for (const Order order : {Order::input, Order::sweep}) {
      EngineOptions options = small(Ordering::planned);
      options.order = order;
      expect_the_same_both_ways(cloud, pipeline, options);
    }
}

TEST(OnDemandOrder, GivesTheBytesOfADistributionForHostilePointsWhichAreRecalled) {
  InputCloud cloud = hostile_tiles();
  for (const char* pipeline : {"knn(k=6) | normals", "knn(k=12) | normals | curvature | splats | fair", "unique"})
    for (const Order order : {Order::input, Order::sweep})
      for (const int axis : {0, 1}) {  // along z, slabs would have to be split
        EngineOptions options = small(Ordering::planned);
        options.slab_points = 2000;
        options.order = order;
        options.axis = axis;
        expect_the_same_both_ways(cloud, pipeline, options);
      }
  EngineOptions options = small(Ordering::on_demand);
  options.slab_points = 2000;
  EXPECT_GT(run_in_memory(cloud, chain_of_any_cloud("knn(k=6) | normals"), options).statistics.recalled, 0u);
}

TEST(OnDemandOrder, FallsBackToADistributionWherePointsNeedIt) {
  // A wall across the axis makes slabs too large. The other cloud has points without a finite place.
  for (const bool wall : {true, false}) {
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::make_unique<TileReader>("wall", 4000, box_of(0, 1), [wall](std::uint64_t row) {
      Vec3 p = hills(0, 3, 1)(row);
      if (wall && row % 2 == 0) p.x = 0.5;
      if (!wall && row == 1234) p.y = std::nan("");
      return p;
    }));
    InputCloud cloud(std::move(readers));
    for (const Order order : {Order::input, Order::sweep}) {
      EngineOptions options = small(Ordering::distribution);
      options.order = order;
      const RunResult wanted = run_in_memory(cloud, chain_of_any_cloud("normals"), options);
      options.ordering = Ordering::on_demand;
      const RunResult got = run_in_memory(cloud, chain_of_any_cloud("normals"), options);
      EXPECT_EQ(got.records, wanted.records);
      EXPECT_THAT(got.statistics.ordering, HasSubstr(wall ? "their slab has to be split" : "no finite coordinates"));
      EXPECT_THAT(got.statistics.ordering, StartsWith("by distribution: "));
    }
  }
}

/// 1.2 million points, far more than the budget holds.
constexpr std::uint64_t kTilePoints = 120'000, kTiles = 10, kBudget = 72 << 20;

TEST(OnDemandOrder, IsChosenForTilesThatDoNotFitTheBudgetAndSpillsNothingForIt) {
  EngineOptions options;
  options.resources.memory_bytes = kBudget;
  InputCloud cloud = tiles_in_a_row(kTiles, kTilePoints);
  const Chain chain = chain_of_any_cloud("knn(k=6) | normals");
  const std::string plan = to_text(preview(cloud, chain, options));
  EXPECT_THAT(plan, HasSubstr("ordering      by the boxes of the inputs: at most about "));
  EXPECT_THAT(plan, HasSubstr("made on demand\n"));
  const RunResult on_demand = run_in_memory(cloud, chain, options);
  EXPECT_THAT(plan, HasSubstr(on_demand.statistics.ordering)) << "the plan of the dry run is that of the run";
  EXPECT_EQ(on_demand.statistics.bytes_spilled_ordering, 0u);
  options.ordering = Ordering::distribution;
  const RunResult distributed = run_in_memory(cloud, chain, options);
  EXPECT_GE(distributed.statistics.bytes_spilled_ordering, kTiles * kTilePoints * 28);
  EXPECT_THAT(distributed.statistics.ordering, "by distribution: it was asked for");
  EXPECT_EQ(on_demand.records, distributed.records);
}

TEST(OnDemandOrder, OfTilesWhoseHeadersLieTurnsIntoADistribution) {
  EngineOptions options;
  options.resources.memory_bytes = kBudget;
  const Chain chain = chain_of_any_cloud("knn(k=6) | normals");
  std::vector<std::unique_ptr<Reader>> readers;
  for (std::uint64_t t = 0; t < kTiles; ++t) {  // each tile holds points of the whole cloud
    const auto from = static_cast<double>(t);
    readers.push_back(std::make_unique<TileReader>("liar", kTilePoints, box_of(from, from + 1), hills(0, kTiles, t)));
  }
  InputCloud cloud(std::move(readers));
  EXPECT_THAT(to_text(preview(cloud, chain, options)), HasSubstr("ordering      by the boxes of the inputs: "));
  const RunResult got = run_in_memory(cloud, chain, options);
  EXPECT_THAT(got.statistics.ordering, StartsWith("by distribution: "));
  EXPECT_THAT(got.statistics.ordering, HasSubstr("points would wait in memory for the sweep"));
  options.ordering = Ordering::distribution;
  EXPECT_EQ(got.records, run_in_memory(cloud, chain, options).records);
}

TEST(OnDemandOrder, OfOneTileWhoseHeaderLiesIsStillRight) {
  EngineOptions options;
  options.resources.memory_bytes = kBudget;
  const Chain chain = chain_of_any_cloud("knn(k=6) | normals");
  std::vector<std::unique_ptr<Reader>> readers;
  for (std::uint64_t t = 0; t < kTiles; ++t) {
    const auto from = static_cast<double>(t);
    const Box stated = t == 3 ? box_of(-1000, -999) : box_of(from, from + 1);
    readers.push_back(std::make_unique<TileReader>("tile", kTilePoints, stated, hills(from, 1, t)));
  }
  InputCloud cloud(std::move(readers));
  const RunResult got = run_in_memory(cloud, chain, options);
  EXPECT_THAT(got.statistics.ordering, StartsWith("by the boxes of the inputs"));
  EXPECT_EQ(got.statistics.bytes_spilled_ordering, 0u);
  options.ordering = Ordering::distribution;
  EXPECT_EQ(got.records, run_in_memory(cloud, chain, options).records);
}

std::string planned_order(InputCloud& cloud, const std::string& pipeline, EngineOptions options,
                          std::uint64_t budget = kBudget) {
  options.resources.memory_bytes = budget;
  return preview(cloud, chain_of_any_cloud(pipeline), options).memory.order_text;
}

TEST(OnDemandOrder, ThePlanSaysWhyItIsNotChosen) {
  InputCloud tiles = tiles_in_a_row(kTiles, kTilePoints), silent = tiles_in_a_row(kTiles, kTilePoints, false);
  const std::string pipeline = "knn(k=6) | normals";
  EXPECT_EQ(planned_order(tiles, pipeline, {}, std::uint64_t{4} << 30), "by distribution, in memory");
  EXPECT_EQ(planned_order(silent, pipeline, {}), "by distribution: tile0 does not state where its points lie");
  EngineOptions resumed;
  resumed.resume_folder = "resumed";
  EXPECT_EQ(planned_order(tiles, pipeline, resumed),
            "by distribution: --resume keeps the points in order in its folder");
  EngineOptions along_y;
  along_y.axis = 1;  // all tiles overlap
  EXPECT_THAT(planned_order(tiles, pipeline, along_y),
              testing::AllOf(StartsWith("by distribution: by the boxes of the inputs about 1200000 points ("),
                             HasSubstr("would have to wait in memory")));
}

TEST(OnDemandOrder, OfFilesWithAFileForEachHasNoSeamsAndSpillsNothingForIt) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> inputs;
  for (std::size_t t = 0; t < 3; ++t) {
    std::vector<std::unique_ptr<Reader>> one;
    one.push_back(std::make_unique<TileReader>("tile", 2000, std::nullopt, hills(static_cast<double>(t), 1, t)));
    InputCloud cloud(std::move(one));
    inputs.push_back(folder / fmt::format("tile{}{}", t, t == 1 ? ".ply" : ".las"));
    run(cloud, chain_of_any_cloud("knn(k=6) | normals"), {.points = inputs.back()}, {});
  }
  for (const char* pipeline : {"knn(k=8) | normals | curvature", "knn(k=8) | sor | normals"}) {
    std::vector<std::string> bytes;
    for (const Ordering ordering : {Ordering::distribution, Ordering::on_demand}) {
      InputCloud cloud(inputs);
      EngineOptions options = small(ordering);
      options.overwrite = true;
      Outputs outputs;
      for (std::size_t t = 0; t < 3; ++t) outputs.tiles.push_back(folder / "out" / inputs[t].filename());
      const Statistics statistics = run(cloud, chain_of_any_cloud(pipeline), outputs, options);
      EXPECT_THAT(statistics.ordering,
                  StartsWith(ordering == Ordering::on_demand ? "by the boxes of the inputs" : "by distribution"));
      std::string all;
      for (const auto& tile : outputs.tiles) all += contents(tile);
      bytes.push_back(all);
    }
    EXPECT_EQ(bytes[0], bytes[1]) << pipeline;
  }
}

}  // namespace
}  // namespace pointsweep
