// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/plan/kept_fields.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <random>

#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/in_memory.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/reference_engine.h"

namespace pointsweep {
namespace {

/// A wavy surface whose records have a field of each kind: scaled, bits that share a byte, several values, and bytes
/// without a name.
class OddReader final : public Reader {
 public:
  explicit OddReader(std::size_t count) : random_(5), bytes_(kStride * count) {
    for (std::byte& b : bytes_) b = static_cast<std::byte>(random_());
    std::uniform_real_distribution<double> uniform(0, 20);
    for (std::size_t i = 0; i < count; ++i) {
      const double x = uniform(random_), y = uniform(random_), z = std::sin(x) + std::cos(y);
      for (const auto& [at, value] : std::map<std::size_t, double>{{4, x}, {12, y}, {24, z}})
        std::memcpy(bytes_.data() + i * kStride + at, &value, sizeof value);
    }
    info_.schema.fields = {{.name = "low", .type = Type::u8, .offset = 0, .bit_width = 3},
                           {.name = "X", .type = Type::f64, .offset = 4},
                           {.name = "y", .type = Type::f64, .offset = 12},
                           {.name = "high", .type = Type::u8, .offset = 0, .bit_shift = 3, .bit_width = 5},
                           {.name = "z", .type = Type::f64, .offset = 24},
                           {.name = "three", .type = Type::u16, .offset = 34, .count = 3},
                           {.name = "Scalar_Intensity", .type = Type::i32, .offset = 40, .scale = 0.01, .bias = 7}};
    info_.schema.stride = kStride;
    info_.count = count;
  }
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t n = std::min<std::size_t>(records.size() / kStride, info_.count - row);
    std::memcpy(records.data(), bytes_.data() + row * kStride, n * kStride);
    return n;
  }

 private:
  static constexpr std::size_t kStride = 45;
  std::mt19937_64 random_;
  std::vector<std::byte> bytes_;
};

RunResult run_of(const std::string& pipeline, const std::vector<std::string>& keep, const EngineOptions& options) {
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<OddReader>(700));
  InputCloud cloud(std::move(readers));
  return run_in_memory(cloud, build_chain(parse_pipeline(pipeline), cloud, keep), options);
}

/// Returns the values of all components of all fields, by name.
std::map<std::string, std::vector<double>> table(const RunResult& result) {
  std::map<std::string, std::vector<double>> values;
  for (const Field& f : result.schema.fields)
    for (std::size_t at = 0; at < result.records.size(); at += result.schema.stride)
      for (std::uint32_t c = 0; c < f.count; ++c) values[f.name].push_back(value_of(f, result.records.data() + at, c));
  return values;
}

std::string names_of(const Schema& schema) {
  std::string names;
  for (const Field& f : schema.fields) names += (names.empty() ? "" : " ") + f.name;
  return names;
}

TEST(KeptFields, AreTheSameValuesInEveryOrderSweepAndEngine) {
  const std::map<std::string, std::string> keeps = {{"high,nx", "X y high z nx"},
                                                    {"intensity,normal", "X y z Scalar_Intensity nx ny nz"},
                                                    {"three_1,nz", "X y z three nz"},
                                                    {"low", "low X y z nx ny nz"}};
  for (const std::string pipeline : {"normals", "normals | splats | fair(f=3, g=3) | reneighbor | normals | resort"}) {
    for (const Order order : {Order::input, Order::sweep}) {
      for (const int way : {0, 1, 2}) {
        EngineOptions options;
        options.order = order, options.spill = way == 1, options.slab_points = 120, options.cell_points = 32;
        if (way == 2) options.engine = Engine::reference;
        const auto all = table(run_of(pipeline, {}, options));
        for (const auto& [keep, names] : keeps) {
          SCOPED_TRACE(pipeline + ", " + keep);
          std::vector<std::string> list(1);
          for (const char c : keep) c == ',' ? void(list.emplace_back()) : list.back().push_back(c);
          if (pipeline != "normals") list.emplace_back("position");
          if (pipeline != "normals" && keep == "low") list.emplace_back("normal");
          const RunResult kept = run_of(pipeline, list, options);
          EXPECT_EQ(names_of(kept.schema), names);
          for (const auto& [name, values] : table(kept)) EXPECT_EQ(values, all.at(name)) << name;
        }
      }
    }
  }
}

TEST(KeptFields, AreMadeFieldsBeforeFieldsOfTheInputAndNamesBeforeOtherSpellings) {
  Schema input;
  for (const char* name : {"x", "y", "z", "curvature", "NX", "ny", "nz", "class"}) input.append(name, Type::f32);
  const std::vector<Attribute> made = {normal_attribute(), scalar("surface_variation", Type::f32, "1", "")};
  using Indices = std::vector<std::size_t>;
  using Names = std::vector<std::string>;
  const KeptFields old = kept_fields({"curvature"}, made, input);
  EXPECT_EQ(old.input, (Indices{0, 1, 2, 3})) << "the input has a column of exactly this name";
  EXPECT_EQ(old.attributes, (Names{"normal", "surface_variation"}));
  const KeptFields part = without_replaced(kept_fields({"nx"}, made, input), input);
  EXPECT_EQ(part.attributes, Names{"normal"});
  EXPECT_EQ(part.left_out, (std::set<std::string>{"ny", "nz"}));
  EXPECT_EQ(part.input, (Indices{0, 1, 2, 3, 4, 7})) << "old ny and nz do not stand beside a new nx";
  EXPECT_FALSE(kept_fields({"nx"}, made, input).input) << "with a prefix nothing is replaced";
  EXPECT_EQ(kept_fields({"Classification"}, made, input).input, (Indices{0, 1, 2, 7}));
  EXPECT_FALSE(kept_fields({"normal"}, made, input).input);
  EXPECT_EQ(kept_fields({"normal"}, made, input).attributes, Names{"normal"});
  EXPECT_FALSE(kept_fields({}, made, input).input);
}

TEST(KeptFields, UnknownNamesAreRefusedWithTheNearest) {
  Schema input;
  for (const char* name : {"x", "y", "z", "intensity"}) input.append(name, Type::f32);
  const std::string sentence = refusal([&] { kept_fields({"intesity"}, {normal_attribute()}, input); });
  EXPECT_EQ(sentence,
            "'intesity' cannot be kept (did you mean 'intensity'?); the input has x, y, z, intensity, and what is made "
            "is normal.");
}

}  // namespace
}  // namespace pointsweep
