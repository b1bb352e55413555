// SPDX-License-Identifier: MIT
/// Parts that tests of the update operators share: an operator that moves points anywhere, and chains with it.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"

namespace pointsweep {

using Stages = std::vector<ChainStage>;

/// Moves every point by up to `reach` along each axis, and makes one in fifty not finite.
class Throw final : public LocalOperator {
 public:
  explicit Throw(double reach, std::uint64_t seed = 1) : reach_(reach), seed_(seed) {}
  std::string name() const override { return "throw"; }
  Contract contract() const override { return {{}, {}, {position_attribute()}}; }
  Vec3 moved(Vec3 p, std::uint64_t row) const {
    std::mt19937_64 rng(seed_ * 1'000'003 + row);
    const auto step = [&] { return reach_ * (2 * (static_cast<double>(rng() >> 11) / 9007199254740992.0) - 1); };
    p = {p.x + step(), p.y + step(), p.z + step()};
    if (rng() % 50 == 0) p.y = std::numeric_limits<double>::quiet_NaN();
    return p;
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const auto position = out.column<std::array<double, 3>>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Vec3 p = moved(in.position(i), in.row(i));
      position[i] = {p.x, p.y, p.z};
    }
  }

 private:
  double reach_;
  std::uint64_t seed_;
};

inline std::shared_ptr<const LocalOperator> thrown(double reach, std::uint64_t seed = 1) {
  return std::make_shared<Throw>(reach, seed);
}
inline ChainStage reneighbor() { return Reneighbor(); }
inline ChainStage reneighbor(std::size_t k) { return Reneighbor(Neighborhood{.k = k}); }
inline ChainStage resort() { return Resort(); }
inline std::shared_ptr<const LocalOperator> normals() { return std::make_shared<Normals>(); }
inline std::shared_ptr<const LocalOperator> graph(std::size_t k, std::size_t n) {
  return std::make_shared<NeighborRows>(k, n, false);
}

/// Returns options for slabs and cells so small that every boundary case happens, in memory or spilled.
inline EngineOptions tiny(std::uint64_t slab_points, bool spill = false, unsigned threads = 2) {
  return small_slabs(slab_points, slab_points < 200 ? 16 : slab_points < 1000 ? 64 : 1024, threads, spill);
}

/// Returns options with different threads, slabs and axes, spilled and in memory.
inline std::vector<EngineOptions> ways_to_run() {
  std::vector<EngineOptions> all = {tiny(100, false, 1), tiny(100, true, 2), tiny(50'000, false, 3), tiny(700)};
  all[1].axis = 1;
  all[2].axis = 0;
  all[3].axis = 2;
  return all;
}

/// Returns half of ways_to_run() for even turns, and the other half for odd turns.
inline std::vector<EngineOptions> half_of_ways_to_run(std::size_t turn) {
  const std::vector<EngineOptions> all = ways_to_run();
  return {all[turn % 2], all[2 + turn % 2]};
}

/// Returns options with different threads, slabs and axes, spilled and in memory, for one order of the output.
inline std::vector<EngineOptions> ways_to_run(Order order) {
  std::vector<EngineOptions> all = {tiny(100, false, 1), tiny(100, true, 2), tiny(50'000, false, 3)};
  for (EngineOptions& options : all) options.order = order;
  all[1].axis = 1;
  return all;
}

template <class T>
std::vector<T> values_of(const RunResult& result, const std::vector<std::string>& fields) {
  std::vector<T> values;
  for (std::size_t at = 0; at < result.records.size(); at += result.schema.stride) {
    for (const std::string& name : fields) {
      const Field& field = result.schema.fields[*result.schema.find(name)];
      EXPECT_EQ(size_of(field.type), sizeof(T)) << name;
      std::memcpy(&values.emplace_back(), result.records.data() + at + field.offset, sizeof(T));
    }
  }
  return values;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

inline std::unique_ptr<InputCloud> cloud_of(std::unique_ptr<Reader> reader) {
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::move(reader));
  return std::make_unique<InputCloud>(std::move(readers));
}

inline Chain chain_of(const std::string& text) { return build_chain(parse_pipeline(text), Facts{.points = 1000}); }

}  // namespace pointsweep
