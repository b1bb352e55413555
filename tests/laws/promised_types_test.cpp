// SPDX-License-Identifier: MIT
/// Operators get attributes in the types that their contracts promise: a float64 attribute of the input gives the
/// results of its values rounded to the promised type.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "pointsweep/points/input_row.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/support/every_operator.h"
#include "tests/support/examples.h"

namespace pointsweep {
namespace {

constexpr std::size_t kPromisePoints = 400;

class PromisedTypes : public testing::Test {
 protected:
  PromisedTypes() : other_(testing::TempDir() + fmt::format("pointsweep-promise-{}.csv", getpid())) {
    std::ofstream file(other_);
    file << "x,y,z,classification\n";
    for (const Vec3& p : cloud_for_examples(kPromisePoints, 9))
      file << fmt::format("{},{},{},{}\n", p.x, p.y, p.z, p.x > 3 ? 2 : 5);
    attributes_ = {scalar("intensity", Type::u16, "1", ""), scalar("classification", Type::u8, "1", "")};
    std::set<std::string> known = names();
    const EveryOperator every({}, "", other_);
    for (const OperatorDeclaration& declaration : all_operators()) {
      const auto stage = declaration.make(every.values_of(declaration), {});
      const Contract contract = contract_of(stage);
      for (const auto* reads : {&contract.reads, &contract.reads_neighbors})
        for (const Attribute& a : *reads)
          if (a.name != position_attribute().name && a.name != kInputRow && known.insert(a.name).second)
            attributes_.push_back(a);
    }
  }
  ~PromisedTypes() override { std::filesystem::remove(other_); }

  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const Attribute& a : attributes_) all.insert(a.name);
    return all;
  }

  /// Returns a cloud with every attribute that an operator reads. Attributes promised as float32 are stored as `real`;
  /// with `rounded`, their values are those of float32.
  Records cloud(Type real, bool rounded) const {
    const std::vector<Vec3> points = cloud_for_examples(kPromisePoints, 3);
    Records out;
    for (const char* axis : {"x", "y", "z"}) out.schema.append(axis, Type::f64);
    for (const Attribute& a : attributes_)
      for (const std::string& field : a.fields) out.schema.append(field, a.type == Type::f32 ? real : a.type);
    out.bytes.resize(points.size() * out.schema.stride);
    std::mt19937_64 random(7);
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::byte* const record = out.bytes.data() + i * out.schema.stride;
      for (std::size_t f = 0; f < out.schema.fields.size(); ++f) {
        double value = f < 3 ? points[i][static_cast<int>(f)] : 0.5 + static_cast<double>(random() >> 11) * 0x1p-52;
        if (f >= 3 && rounded) value = static_cast<double>(static_cast<float>(value));
        set_value(out.schema.fields[f], record, value);
      }
    }
    return out;
  }

  std::string other_;
  std::vector<Attribute> attributes_;
};

TEST_F(PromisedTypes, DoublesOfTheInputAreRoundedForEveryOperator) {
  const Records doubles = cloud(Type::f64, false), rounded = cloud(Type::f64, true), floats = cloud(Type::f32, true);
  const std::vector<OperatorCase> cases = EveryOperator(names(), "knn(radius=4)", other_).cases();
  std::size_t compared = 0;
  for (const OperatorCase& one : cases) {
    InputCloud whole = doubles.cloud();
    std::vector<std::string> made;
    for (const auto& entry : build_chain(parse_pipeline(one.pipeline), whole).stages)
      for (const Attribute& a : contract_of(entry).makes)
        if (a.name != selection_attribute().name) made.insert(made.end(), a.fields.begin(), a.fields.end());
    EngineOptions options = tiny(90);
    for (const std::string& field : made)
      if (doubles.schema.find(field).value_or(0) >= 3) options.replace.push_back(field);
    const RunResult got = run_text(doubles, one.pipeline, options);
    for (const Records* same : {&rounded, &floats}) {
      const RunResult expected = run_text(*same, one.pipeline, options);
      ASSERT_EQ(got.statistics.points_written, expected.statistics.points_written) << one.pipeline;
      for (const std::string& field : made)
        if (got.schema.find(field)) {
          EXPECT_TRUE(std::ranges::equal(got.field(field), expected.field(field),
                                         [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }))
              << one.pipeline << ": " << field;
          ++compared;
        }
    }
  }
  EXPECT_GT(compared, 2 * all_operators().size());
}

}  // namespace
}  // namespace pointsweep
