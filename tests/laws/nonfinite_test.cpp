// SPDX-License-Identifier: MIT
/// The law of points without a finite place, over every operator of the registry: a stage that looks at its own point
/// alone treats them as any other point, every other stage leaves them unchanged but for the documented value, and they
/// are neighbours of no point.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

#include "pointsweep/pipeline/plan/chain_plan.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/support/every_operator.h"

namespace pointsweep {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN(), kFar = 1e9;
constexpr std::size_t kLawPoints = 60;

/// The coordinates of a point that are not finite.
enum class Lost { no, x, y, z, all };

Lost lost_by(std::size_t row) {
  return row == 0 || row == 31 ? Lost::x : row == 7 ? Lost::y : row == 8 ? Lost::z : row == 59 ? Lost::all : Lost::no;
}

/// Returns a bumpy surface with attributes of many types. Normals point up. `placed` may move each point.
Records law_cloud(const std::function<Vec3(std::size_t row, Vec3 place)>& placed) {
  Records out;
  for (const char* axis : {"x", "y", "z"}) out.schema.append(axis, Type::f64);
  for (const char* axis : {"nx", "ny", "nz"}) out.schema.append(axis, Type::f32);
  out.schema.append("classification", Type::u8);
  out.schema.append("intensity", Type::u16);
  out.schema.append("gain", Type::f32);
  out.schema.append("id", Type::u64);
  out.bytes.resize(kLawPoints * out.schema.stride);
  for (std::size_t i = 0; i < kLawPoints; ++i) {
    const double u = double(i % 8) + 0.1 * double(i % 3), v = double(i / 8) + 0.07 * double(i % 5);
    const Vec3 p = placed(i, {u, v, 0.3 * std::sin(u) + 0.2 * std::cos(2 * v)});
    const double n = double(i), of_class = i % 7 == 0 ? 18 : double(i % 4);
    const double values[] = {p.x, p.y, p.z, 0.6, 0, 0.8, of_class, 100 + n, 0.5 + n, n};
    for (std::size_t f = 0; f < out.schema.fields.size(); ++f)
      set_value(out.schema.fields[f], out.bytes.data() + i * out.schema.stride, values[f]);
  }
  return out;
}

Vec3 without_place(std::size_t row, Vec3 p) {
  const Lost lost = lost_by(row);
  if (lost == Lost::x || lost == Lost::all) p.x = kNoNumber;
  if (lost == Lost::y) p.y = -std::numeric_limits<double>::infinity();
  if (lost == Lost::z || lost == Lost::all) p.z = kNoNumber;
  return p;
}

/// Places points whose x alone is not finite far away instead, where they have no neighbours and are in no box.
Vec3 far_away(std::size_t row, Vec3 p) {
  if (lost_by(row) != Lost::x) return without_place(row, p);
  p.x = kFar * double(1 + row);
  return p;
}

class NonfiniteLaw : public testing::Test {
 protected:
  NonfiniteLaw() : other_(testing::TempDir() + fmt::format("pointsweep-law-{}.csv", getpid())) {
    std::ofstream file(other_);
    file << "x,y,z,classification\n";
    for (std::size_t i = 0; i < 20; ++i) file << 0.4 * double(i) << "," << 0.3 * double(i) << ",0.1," << i % 3 << "\n";
  }
  ~NonfiniteLaw() override { std::filesystem::remove(other_); }

  std::vector<OperatorCase> cases() const {
    const std::set<std::string> input = {"normal", "classification", "intensity", "gain"};
    return EveryOperator(input, "knn(radius=4)", other_).cases();
  }

  std::string other_;
};

/// Returns the records of an output by the id of their point.
std::map<double, const std::byte*> by_id(const Records& records) {
  std::map<double, const std::byte*> rows;
  for (std::size_t i = 0; i < records.size(); ++i) rows[records.value(i, "id")] = records.at(i);
  return rows;
}

bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Returns the value after "undefined: " in the documented meaning of an attribute; else the fill that the attribute
/// declares.
double documented_value(const OperatorDeclaration& declaration, const Attribute& a) {
  const auto note = std::ranges::find(declaration.attributes, a.name, &AttributeNote::name);
  const std::string meaning = note == declaration.attributes.end() ? a.meaning : note->meaning;
  if (const std::size_t at = meaning.find("undefined: "); at != meaning.npos)
    return std::strtod(meaning.c_str() + at + 11, nullptr);
  const std::vector<std::byte> fill(a.bytes(), a.fill);
  const Field field{.name = "", .type = a.type};
  return value_of(field, fill.data());
}

/// Judges the points without a finite place in `out`, the output of a run over `in`. `twin`: the output for points
/// placed by far_away().
class Judgement {
 public:
  Judgement(const OperatorCase& one, const ChainPlan& plan, const Records& in, const Records& out, const Records& twin)
      : one_(one), plan_(plan), in_(in), out_(out), twin_(twin) {}

  void judge() const {
    const auto rows = by_id(out_), far = by_id(twin_);
    for (std::size_t i = 0; i < kLawPoints; ++i) {
      const Lost lost = lost_by(i);
      if (lost == Lost::no) continue;
      SCOPED_TRACE(fmt::format("point {}", i));
      const auto row = rows.find(double(i));
      if (is_documented_to_stay()) {
        ASSERT_TRUE(row != rows.end());
      } else if (lost == Lost::x) {
        EXPECT_EQ(row != rows.end(), far.contains(double(i)));
      }
      if (row == rows.end()) continue;
      judge_input_fields(i, row->second);
      for (const std::size_t v : plan_.graph.made) judge_made(v, i, row->second, far);
    }
  }

 private:
  bool is_documented_to_stay() const {
    return !plan_.selects() || one_.declaration->undefined.find("stay") != std::string::npos ||
           one_.declaration->undefined.find("all kept") != std::string::npos;
  }
  bool is_documented_to_keep_coordinates() const {
    return one_.declaration->undefined.find("keeps its coordinates") != std::string::npos;
  }
  /// Returns whether a value for undefined data is documented.
  bool is_documented(const Attribute& a) const {
    const auto note = std::ranges::find(one_.declaration->attributes, a.name, &AttributeNote::name);
    return note != one_.declaration->attributes.end() && note->meaning.find("undefined: ") != std::string::npos;
  }
  bool is_made(const std::string& field) const {
    return std::ranges::any_of(plan_.graph.made, [&](std::size_t v) {
      const std::vector<std::string>& fields = plan_.graph.versions[v].attribute.fields;
      return std::ranges::find(fields, field) != fields.end();
    });
  }
  double at(const Schema& schema, const std::byte* record, const std::string& field) const {
    return value_of(schema.fields[*schema.find(field)], record);
  }
  void judge_input_fields(std::size_t i, const std::byte* record) const {
    for (const Field& field : in_.schema.fields) {
      if (!out_.schema.find(field.name) || is_made(field.name)) continue;
      EXPECT_TRUE(is_same(at(out_.schema, record, field.name), in_.value(i, field.name))) << field.name;
    }
  }
  void judge_made(std::size_t v, std::size_t i, const std::byte* record,
                  const std::map<double, const std::byte*>& far) const {
    const AttributeVersion& version = plan_.graph.versions[v];
    const Attribute& a = version.attribute;
    const GraphNode& maker = plan_.graph.nodes[*version.producer];
    const std::vector<Attribute> reads = contract_of(*maker.op()).reads;
    const bool moves = a.name == position_attribute().name, pointwise = is_pointwise(*maker.op());
    const auto is_read = [&](const std::string& field) {
      return std::ranges::any_of(
          reads, [&](const Attribute& read) { return std::ranges::find(read.fields, field) != read.fields.end(); });
    };
    const bool remade = moves || std::ranges::all_of(a.fields, is_read);
    for (const std::string& field : a.fields) {
      if (!out_.schema.find(field)) continue;
      const double found = at(out_.schema, record, field);
      const bool stays = moves && (field == "x" || is_documented_to_keep_coordinates());
      const bool is_twin = pointwise && !stays && !is_documented(a);
      if (is_twin && lost_by(i) != Lost::x) continue;
      if (is_twin) {
        EXPECT_TRUE(is_same(found, at(twin_.schema, far.at(double(i)), field))) << field << " is " << found;
      } else if (remade) {
        EXPECT_TRUE(is_same(found, in_.value(i, field))) << field << " is " << found;
      } else {
        EXPECT_TRUE(is_same(found, documented_value(*one_.declaration, a))) << field << " is " << found;
      }
    }
  }

  const OperatorCase& one_;
  const ChainPlan& plan_;
  const Records &in_, &out_, &twin_;
};

TEST_F(NonfiniteLaw, HoldsForEveryOperatorInBothOrders) {
  const Records in = law_cloud(without_place), far = law_cloud(far_away);
  const Records clean = in.those([](std::size_t row) { return lost_by(row) == Lost::no; });
  std::set<std::string> seen;
  for (const OperatorCase& one : cases()) {
    SCOPED_TRACE(one.pipeline);
    seen.insert(one.declaration->name);
    InputCloud cloud = in.cloud();
    const ChainPlan plan = plan_chain(build_chain(parse_pipeline(one.pipeline), cloud), cloud.schema());
    for (const Order order : {Order::input, Order::sweep}) {
      EngineOptions options;
      options.order = order;
      const Records out = records_of(run_text(in, one.pipeline, options));
      Judgement(one, plan, in, out, records_of(run_text(far, one.pipeline, options))).judge();
      const Records placed =
          out.those([&](std::size_t row) { return lost_by(std::size_t(out.value(row, "id"))) == Lost::no; });
      const RunResult alone = run_text(clean, one.pipeline, options);
      EXPECT_EQ(placed.bytes, alone.records) << "others take them for neighbours";
      options.nonfinite = Nonfinite::drop;
      EXPECT_EQ(run_text(in, one.pipeline, options).records, alone.records) << "dropped";
      options.nonfinite = Nonfinite::refuse;
      EXPECT_THROW(run_text(in, one.pipeline, options), Error);
    }
  }
  EXPECT_EQ(seen.size(), all_operators().size());
}

TEST_F(NonfiniteLaw, ACoordinateThatIsAssignedGivesAPointAPlaceForTheNeighborsOfALaterStage) {
  const Records in = law_cloud(without_place);
  for (const Order order : {Order::input, Order::sweep}) {
    EngineOptions options;
    options.order = order;
    for (const char* before : {"", "normals | "}) {
      const std::string text =
          fmt::format("knn(radius=4) | {}set(x = 3, gain = 2) | reneighbor | neighborhood_size", before);
      const Records out = records_of(run_text(in, text, options));
      const auto rows = by_id(out);
      for (std::size_t i = 0; i < kLawPoints; ++i) {
        const double count = value_of(out.schema.fields[*out.schema.find("neighbor_count")], rows.at(double(i)));
        const bool is_placed = lost_by(i) == Lost::no || lost_by(i) == Lost::x;
        EXPECT_EQ(count > 0, is_placed) << i;
        EXPECT_EQ(value_of(out.schema.fields[*out.schema.find("gain")], rows.at(double(i))), 2) << i;
      }
    }
  }
}

TEST_F(NonfiniteLaw, SetMovesThemAndRefusesOnlyToTakeAPlaceAway) {
  const Records in = law_cloud(without_place);
  for (const char* before : {"", "knn(k=4) | normals | "}) {
    const Records out = records_of(run_text(in, std::string(before) + "set(x = x + 1, y = y * 2)", {}));
    for (std::size_t i = 0; i < kLawPoints; ++i) {
      EXPECT_TRUE(is_same(out.value(i, "x"), in.value(i, "x") + 1)) << i;
      EXPECT_TRUE(is_same(out.value(i, "y"), in.value(i, "y") * 2)) << i;
    }
    EXPECT_THROW(run_text(in, std::string(before) + "set(x = x / 0)", {}), Error);
  }
}

}  // namespace
}  // namespace pointsweep
