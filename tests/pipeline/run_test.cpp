// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "pointsweep/operators.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/operators/surface/normals.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"
#include "tests/support/brute_force.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

Chain graph_within(std::size_t k, std::size_t n, double radius = std::numeric_limits<double>::infinity()) {
  return {{.k = k, .radius = radius}, {std::make_shared<NeighborRows>(k, n, false)}};
}

using Lists = std::vector<std::vector<std::uint32_t>>;

void expect_lists(const std::vector<Vec3>& points, const Lists& expected, std::size_t k, double radius,
                  const EngineOptions& options) {
  const RunResult result = run_in_memory(points, graph_within(k, points.size(), radius), options);
  ASSERT_EQ(result.records.size(), points.size() * result.schema.stride);
  const std::size_t offset = result.schema.fields[*result.schema.find("neighbor_0")].offset;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < k; ++j) {
      std::uint32_t row;
      std::memcpy(&row, result.records.data() + i * result.schema.stride + offset + 4 * j, 4);
      ASSERT_EQ(row, j < expected[i].size() ? expected[i][j] : 0xFFFFFFFFu) << "row " << i << ", neighbour " << j;
    }
  }
  std::size_t finite = 0;
  for (const Vec3& p : points) finite += is_finite(p);
  EXPECT_EQ(result.statistics.certified, finite);
  EXPECT_EQ(result.statistics.nonfinite, points.size() - finite);
}

TEST(Run, WithoutAnOutputIsRefused) {
  const std::vector<double> xyz = {0, 0, 0, 1, 0, 0};
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  InputCloud cloud(std::move(readers));
  EXPECT_THROW(run(cloud, graph_within(1, 2), Outputs{}, EngineOptions{}), UsageError);
}

/// Reads a normal, or writes a number, in a wrong type.
class WrongTypes final : public LocalOperator {
 public:
  explicit WrongTypes(bool makes_wrong) : makes_wrong_(makes_wrong) {}
  std::string name() const override { return "wrong_types"; }
  Contract contract() const override { return {{normal_attribute()}, {}, {scalar("sum", Type::f32, "1", "")}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    if (makes_wrong_)
      out.column<double>(0)[0] = 1;
    else
      out.column<float>(0)[0] = in.value<float>(0, 0);
  }

 private:
  bool makes_wrong_;
};

TEST(Run, AnOperatorThatMistakesATypeIsRefused) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes().front().second, 100, 15);
  for (const bool makes_wrong : {false, true}) {
    const Chain chain{{.k = 4}, {std::make_shared<Normals>(), std::make_shared<WrongTypes>(makes_wrong)}};
    EXPECT_THROW(run_in_memory(points, chain, small_slabs(80, 16)), UsageError);
  }
}

TEST(Run, NeighborsEqualBruteForceWhateverTheSlabsAndCells) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, sized(1600), 5);
    const Lists expected = brute_force_neighbors(points, 64);
    for (const std::size_t k : {1, 8, 64}) {
      for (const auto& [slab, cell] :
           {std::pair<std::uint64_t, std::uint32_t>{64, 16}, {300, 64}, {1000, 1024}, {100000, 256}}) {
        SCOPED_TRACE(name + ", slabs of " + std::to_string(slab) + ", cells of " + std::to_string(cell) +
                     ", k = " + std::to_string(k));
        expect_lists(points, expected, k, std::numeric_limits<double>::infinity(),
                     small_slabs(slab, cell, 2, slab == 300));
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(Run, RadiusAndHybridNeighborsEqualBruteForce) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, sized(1500), 6);
    for (const double radius : {0.01, 0.2, 50.0}) {
      SCOPED_TRACE(name + ", radius " + std::to_string(radius));
      expect_lists(points, brute_force_neighbors(points, 12, radius), 12, radius, small_slabs(100, 32));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Run, FewPointsHaveFewNeighbors) {
  for (const std::size_t n : {1, 2, 7, 8, 9}) {
    SCOPED_TRACE(n);
    const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, n, 1);
    expect_lists(points, brute_force_neighbors(points, 8), 8, std::numeric_limits<double>::infinity(),
                 small_slabs(64, 16));
  }
}

TEST(Run, CountsTheBytesThatARecallReadsFromTheTemporaryFolder) {
  std::size_t recalls = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = make_cloud(shape, 1500, 8);
    const Chain chain{{.k = 8}, {std::make_shared<Normals>()}};
    const Statistics in_memory = run_in_memory(points, chain, small_slabs(60, 16)).statistics;
    const Statistics spilled = run_in_memory(points, chain, small_slabs(60, 16, 2, true)).statistics;
    EXPECT_EQ(spilled.bytes_read > in_memory.bytes_read, spilled.recalled > 0);
    if (spilled.recalled == 0) continue;
    ++recalls;
    EXPECT_GE(spilled.bytes_read - in_memory.bytes_read, spilled.recalled * 3 * sizeof(float)) << "their positions";
  }
  EXPECT_GT(recalls, 2u);
}

TEST(Run, TheBytesDependNeitherOnThreadsNorSlabsNorMemory) {
  for (const Order order : {Order::input, Order::sweep}) {
    for (const auto& [name, shape] : hostile_shapes()) {
      SCOPED_TRACE(name + (order == Order::input ? ", input order" : ", sweep order"));
      const std::vector<Vec3> points = make_cloud(shape, sized(2000), 8);
      const Chain chain{{.k = 8}, {std::make_shared<Normals>()}};
      std::vector<std::byte> first;
      for (const unsigned threads : {1u, 2u, 4u}) {
        for (const std::uint64_t slab : {100, 700, 50000}) {
          for (const bool spill : {false, true}) {
            EngineOptions options = small_slabs(slab, slab < 500 ? 32 : 512, threads, slab == 300);
            options.order = order;
            options.spill = spill;
            options.slabs_per_turn = threads;
            const RunResult result = run_in_memory(points, chain, options);
            ASSERT_EQ(result.statistics.bytes_spilled > 0, spill);
            if (first.empty()) first = result.records;
            ASSERT_EQ(result.records.size(), first.size());
            ASSERT_EQ(std::memcmp(result.records.data(), first.data(), first.size()), 0)
                << threads << " threads, slabs of " << slab << (spill ? ", spilled" : ", in memory");
          }
        }
      }
    }
  }
}

TEST(Run, TheBytesAreTheSameForOneToSixteenThreads) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes().front().second, 20000, 9);
  const Chain chain{{.k = 12}, {std::make_shared<Normals>(), std::make_shared<NeighborRows>(12, 20000, true)}};
  std::vector<std::byte> first;
  for (unsigned threads = 1; threads <= 16; ++threads) {
    for (const std::uint64_t slab : {300, 4000}) {
      const RunResult result = run_in_memory(points, chain, small_slabs(slab, 128, threads, slab == 300));
      if (first.empty()) first = result.records;
      ASSERT_TRUE(result.records == first) << threads << " threads, slabs of " << slab;
    }
  }
}

TEST(Run, ShufflingTheInputShufflesTheOutputAndNothingElse) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = make_cloud(shape, sized(2000), 9);
    std::vector<std::uint32_t> from(points.size());
    std::iota(from.begin(), from.end(), 0u);
    std::shuffle(from.begin(), from.end(), std::mt19937_64(3));
    std::vector<Vec3> shuffled;
    for (const std::uint32_t i : from) shuffled.push_back(points[i]);
    const Chain chain{{.k = 8}, {std::make_shared<Normals>()}};
    const RunResult a = run_in_memory(points, chain, small_slabs(200, 64));
    const RunResult b = run_in_memory(shuffled, chain, small_slabs(200, 64));
    for (std::size_t i = 0; i < from.size(); ++i) {
      ASSERT_EQ(std::memcmp(b.records.data() + i * b.schema.stride, a.records.data() + from[i] * a.schema.stride,
                            a.schema.stride),
                0)
          << i;
    }
  }
}

/// Makes the mean |cos| to the normals of the neighbours. Reads an attribute that an earlier stage makes, so a cell
/// waits for its neighbours.
class MeanNormal final : public LocalOperator {
 public:
  std::string name() const override { return "mean_normal"; }
  Contract contract() const override {
    return {{normal_attribute()},
            {normal_attribute()},
            {scalar("agreement", Type::f64, "1", "mean |cos| to the neighbours' normals")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    using Normal = std::array<float, 3>;
    auto agreement = out.column<double>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Normal n = in.value<Normal>(0, i);
      double sum = 0;
      for (std::size_t j = 0; j < in.count(i); ++j) {
        const Normal m = in.neighbor_value<Normal>(0, i, j);
        sum += std::abs(double{n[0]} * m[0] + double{n[1]} * m[1] + double{n[2]} * m[2]);
      }
      agreement[i] = in.count(i) == 0 ? 0 : sum / static_cast<double>(in.count(i));
    }
  }
};

/// Makes the largest agreement of the neighbours. Reads the attribute that MeanNormal makes.
class LargestAgreement final : public LocalOperator {
 public:
  std::string name() const override { return "largest"; }
  Contract contract() const override {
    const Attribute agreement = scalar("agreement", Type::f64, "1", "");
    return {{}, {agreement}, {scalar("largest", Type::f64, "1", "largest agreement among the neighbours")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    auto largest = out.column<double>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      largest[i] = 0;
      for (std::size_t j = 0; j < in.count(i); ++j)
        largest[i] = std::max(largest[i], in.neighbor_value<double>(0, i, j));
    }
  }
};

TEST(Run, ChainsThatLookAtNeighborsAttributesEqualTheEvaluationOfTheWholeCloud) {
  for (const auto& [name, shape] : hostile_shapes()) {
    std::vector<Vec3> points = make_cloud(shape, sized(2000), 10);
    const Chain chain{
        {.k = 8}, {std::make_shared<Normals>(), std::make_shared<MeanNormal>(), std::make_shared<LargestAgreement>()}};
    const auto neighbors = brute_force_neighbors(points, 8);
    for (const auto& [slab, cell] : {std::pair<std::uint64_t, std::uint32_t>{80, 16}, {400, 64}, {100000, 1024}}) {
      SCOPED_TRACE(name + ", slabs of " + std::to_string(slab));
      const RunResult result = run_in_memory(points, chain, small_slabs(slab, cell, 2, slab == 300));
      const auto nx = result.field("nx"), ny = result.field("ny"), nz = result.field("nz");
      const auto agreement = result.field("agreement"), largest = result.field("largest");
      for (std::size_t i = 0; i < points.size(); ++i) {
        double sum = 0, most = 0;
        for (const std::uint32_t j : neighbors[i]) {
          sum += std::abs(nx[i] * nx[j] + ny[i] * ny[j] + nz[i] * nz[j]);
          most = std::max(most, agreement[j]);
        }
        ASSERT_EQ(agreement[i], neighbors[i].empty() ? 0 : sum / static_cast<double>(neighbors[i].size())) << i;
        ASSERT_EQ(largest[i], most) << i;
      }
    }
  }
}

TEST(Run, NeighborhoodsFoundAgainAreThoseKept) {
  const auto adaptive = operators::least_eigenentropy(4);
  const std::vector<Neighborhood> neighborhoods = {
      {.k = 8}, {.k = 70}, {.k = 12, .radius = 0.1}, {.k = 12, .rule = adaptive}};
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, sized(600), 16);
    for (std::size_t n = 0; n < neighborhoods.size(); ++n) {
      SCOPED_TRACE(name + ", neighbourhood " + std::to_string(n));
      const Chain chain{
          neighborhoods[n],
          {std::make_shared<Normals>(), std::make_shared<MeanNormal>(), std::make_shared<LargestAgreement>()}};
      EngineOptions options = small_slabs(80, 16);
      const RunResult kept = run_in_memory(points, chain, options);
      options.search_again = true;
      ASSERT_EQ(run_in_memory(points, chain, options).records, kept.records);
    }
  }
}

/// Reads an attribute of the input at the neighbours.
class SumOfMarks final : public LocalOperator {
 public:
  std::string name() const override { return "sum_of_marks"; }
  Contract contract() const override {
    return {{}, {scalar("mark", Type::f64, "1", "")}, {scalar("sum", Type::f64, "1", "of the neighbours' marks")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < in.count(i); ++j) sum += in.neighbor_value<double>(0, i, j);
      out.column<double>(0)[i] = sum;
    }
  }
};

TEST(Run, AttributesOfTheFileAreThereForNeighborsAsLongAsAnybodyLooks) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = make_cloud(shape, sized(1500), 15);
    std::vector<double> xyz, marks;
    for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z}), marks.push_back(double(marks.size() % 97));
    auto reader = std::make_unique<ArrayReader>(std::span<const double>(xyz));
    reader->add({"mark"}, std::span<const double>(marks));
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::move(reader));
    InputCloud cloud(std::move(readers));
    const auto sum =
        run_in_memory(cloud, {{.k = 6}, {std::make_shared<SumOfMarks>()}}, small_slabs(80, 16)).field("sum");
    const auto neighbors = brute_force_neighbors(points, 6);
    for (std::size_t i = 0; i < points.size(); ++i) {
      double expected = 0;
      for (const std::uint32_t j : neighbors[i]) expected += marks[j];
      ASSERT_EQ(sum[i], expected) << i;
    }
  }
}

/// Moves a point to the mean of its neighbourhood and itself.
class MoveToMean final : public LocalOperator {
 public:
  std::string name() const override { return "move_to_mean"; }
  Contract contract() const override { return {{}, {}, {position_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    auto position = out.column<std::array<double, 3>>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      Vec3 sum;
      for (std::size_t j = 0; j < in.count(i); ++j) sum = sum + in.offset(i, j);
      const Vec3 p = in.position(i) + (1.0 / static_cast<double>(in.count(i) + 1)) * sum;
      position[i] = {p.x, p.y, p.z};
    }
  }
};

TEST(Run, StagesAfterAMoverSeeMovedNeighborsAndNeverAMixture) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, sized(1500), 14);
    const auto neighbors = brute_force_neighbors(points, 6);
    std::vector<Vec3> moved = points;
    for (int times = 0; times < 3; ++times) {
      std::vector<Vec3> next = moved;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_finite(points[i])) continue;
        Vec3 sum;
        for (const std::uint32_t j : neighbors[i]) sum = sum + (moved[j] - moved[i]);
        next[i] = moved[i] + (1.0 / static_cast<double>(neighbors[i].size() + 1)) * sum;
      }
      moved = next;
    }
    const auto mover = std::make_shared<MoveToMean>();
    for (const auto& [slab, cell] : {std::pair<std::uint64_t, std::uint32_t>{70, 16}, {300, 64}, {100000, 1024}}) {
      SCOPED_TRACE(name + ", slabs of " + std::to_string(slab));
      const RunResult result =
          run_in_memory(points, {{.k = 6}, {mover, mover, mover}}, small_slabs(slab, cell, 2, slab == 300));
      ASSERT_EQ(result.schema.fields.size(), 3u) << "positions are replaced where they stand";
      const auto x = result.field("x"), y = result.field("y"), z = result.field("z");
      for (std::size_t i = 0; i < points.size(); ++i) {
        for (const auto& [made, expected] : {std::pair{x[i], moved[i].x}, {y[i], moved[i].y}, {z[i], moved[i].z}}) {
          ASSERT_TRUE(made == expected || (std::isnan(made) && std::isnan(expected))) << i;
        }
      }
    }
  }
}

TEST(Run, SeveralInputsAreOneCloudWithoutSeams) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = make_cloud(shape, sized(1500), 12);
    std::vector<double> xyz;
    for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
    const Chain chain{{.k = 8}, {std::make_shared<Normals>()}};
    const RunResult merged = run_in_memory(points, chain, small_slabs(200, 64));
    std::vector<std::unique_ptr<Reader>> tiles;
    for (const auto& [first, last] : {std::pair<std::size_t, std::size_t>{0, 300}, {300, 301}, {301, points.size()}}) {
      tiles.push_back(
          std::make_unique<ArrayReader>(std::span<const double>(xyz).subspan(3 * first, 3 * (last - first))));
    }
    InputCloud cloud(std::move(tiles));
    const RunResult tiled = run_in_memory(cloud, chain, small_slabs(200, 64));
    ASSERT_EQ(tiled.records, merged.records);
  }
}

TEST(Sort, PutsEveryPointInCanonicalOrderAndThoseWithoutAPlaceLast) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, sized(3000), 13);
    for (const int axis : {0, 1, 2}) {
      SCOPED_TRACE(name + ", axis " + std::to_string(axis));
      std::vector<std::uint32_t> expected(points.size());
      std::iota(expected.begin(), expected.end(), 0u);
      std::sort(expected.begin(), expected.end(), [&](std::uint32_t a, std::uint32_t b) {
        const Vec3 p = points[a], q = points[b];
        if (!is_finite(p) || !is_finite(q)) return is_finite(p) != is_finite(q) ? is_finite(p) : a < b;
        return std::tuple(p[axis], p.x, p.y, p.z, a) < std::tuple(q[axis], q.x, q.y, q.z, b);
      });
      // The row is an attribute, so that the order of the output can be read from it.
      std::vector<double> xyz, row;
      for (const Vec3& p : points)
        xyz.insert(xyz.end(), {p.x, p.y, p.z}), row.push_back(static_cast<double>(row.size()));
      auto reader = std::make_unique<ArrayReader>(std::span<const double>(xyz));
      reader->add({"row_of_input"}, std::span<const double>(row));
      std::vector<std::unique_ptr<Reader>> readers;
      readers.push_back(std::move(reader));
      InputCloud cloud(std::move(readers));
      for (const bool spill : {false, true}) {
        EngineOptions options = small_slabs(170, 64);
        options.axis = axis, options.order = Order::sweep, options.spill = spill;
        const RunResult swept = run_in_memory(cloud, {{.k = 3}, {std::make_shared<Normals>()}}, options);
        const std::filesystem::path file =
            std::filesystem::temp_directory_path() / fmt::format("sorted-{}.ply", getpid());
        options.overwrite = true;
        sort(cloud, file, options);
        const auto sorted = open_reader(file);
        std::vector<std::byte> records(points.size() * sorted->info().schema.stride);
        ASSERT_EQ(sorted->read(0, records), points.size());
        std::filesystem::remove(file);
        const Field& field = sorted->info().schema.fields[*sorted->info().schema.find("row_of_input")];
        const std::vector<double> swept_rows = swept.field("row_of_input");
        for (std::size_t i = 0; i < points.size(); ++i) {
          ASSERT_EQ(value_of(field, records.data() + i * sorted->info().schema.stride), expected[i]) << "place " << i;
          ASSERT_EQ(swept_rows[i], expected[i]) << "place " << i;
        }
      }
    }
  }
}

TEST(Run, AChainThatDoesNotFitIsRefusedBeforeAnyWork) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 10, 1);
  try {
    run_in_memory(points, {{.k = 8}, {std::make_shared<MeanNormal>()}}, {});
    FAIL() << "accepted";
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find("needs 'normal'"), std::string::npos) << e.what();
  }
  EXPECT_THROW(run_in_memory(points, graph_within(0, 10), {}), UsageError);
  EXPECT_THROW(run_in_memory({}, graph_within(8, 10), {}), Error);
}

TEST(Run, ACloudWhoseDistancesHaveNoSquaresIsRefused) {
  for (const double scale : {1e-310, 1e-200, 1e200}) {
    std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 500, 1);
    for (Vec3& p : points) p = scale * p;
    try {
      run_in_memory(points, graph_within(8, points.size()), {});
      FAIL() << "accepted a cloud of " << scale;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("scale its coordinates"), std::string::npos) << e.what();
    }
  }
  for (const double scale : {1e-130, 1e140}) {
    std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 500, 1);
    for (Vec3& p : points) p = scale * p;
    expect_lists(points, brute_force_neighbors(points, 8), 8, std::numeric_limits<double>::infinity(),
                 small_slabs(64, 16));
  }
}

/// Throws at one point of the cloud.
class Failing final : public LocalOperator {
 public:
  explicit Failing(std::uint64_t row) : row_(row) {}
  std::string name() const override { return "failing"; }
  Contract contract() const override { return {{}, {}, {scalar("x2", Type::f32, "", "")}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    std::ranges::fill(out.column<float>(0), 0.f);
    for (std::size_t i = 0; i < in.size(); ++i)
      if (in.row(i) == row_) throw Error("this operator fails at row 4321");
  }

 private:
  std::uint64_t row_;
};

TEST(Run, AnExceptionInAnyWorkerEndsTheRunWithItsCause) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 5000, 1);
  const auto run_to_row = [&](std::uint64_t row, unsigned threads, std::uint64_t slab) {
    run_in_memory(points, {{.k = 8}, {std::make_shared<Failing>(row)}}, small_slabs(slab, 64, threads, slab == 300));
  };
  EXPECT_NO_THROW(run_to_row(5000, 2, 300));
  for (const unsigned threads : {1u, 2u, 16u}) {
    for (const std::uint64_t slab : {300, 5000}) {
      try {
        run_to_row(4321, threads, slab);
        FAIL() << "it went well with " << threads << " threads";
      } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "this operator fails at row 4321");
      }
    }
  }
}

}  // namespace
}  // namespace pointsweep
