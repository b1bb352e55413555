// SPDX-License-Identifier: MIT
/// The law of `transform` over every operator of the registry: a direction or a length that an operator has made, and
/// that a file holds, turns and scales with the points.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include "pointsweep/operators.h"
#include "tests/support/every_operator.h"
#include "tests/support/examples.h"

namespace pointsweep {
namespace {

bool depends_on_lengths(const Attribute& a) {
  const bool is_real = a.type == Type::f32 || a.type == Type::f64;
  return is_real && a.kind != Kind::position &&
         (a.kind == Kind::normal || a.kind == Kind::vector || a.unit.find("length") != a.unit.npos);
}

TEST(TransformLaw, KnowsEveryDirectionAndLengthThatOperatorsMake) {
  const std::filesystem::path other = testing::TempDir() + fmt::format("pointsweep-transform-{}.xyz", getpid());
  {
    std::ofstream file(other);
    for (const Vec3& p : cloud_for_examples(100, 9)) file << fmt::format("{} {} {}\n", p.x, p.y, p.z);
  }
  const EveryOperator every({}, "", other);
  const auto transform = std::get<std::shared_ptr<const LocalOperator>>(
      operators::transform({.matrix = "0,-2,0,0,2,0,0,0,0,0,2,0"}));  // a rotation, and scale 2
  std::size_t seen = 0;
  for (const OperatorDeclaration& declaration : all_operators()) {
    for (const Attribute& made : contract_of(declaration.make(every.values_of(declaration), {})).makes) {
      if (!depends_on_lengths(made)) continue;
      Schema schema;
      for (const char* axis : {"x", "y", "z"}) schema.append(axis, Type::f64);
      for (const std::string& field : made.fields) schema.append(field, made.type);
      const auto bound = transform->bound(schema, {});
      EXPECT_TRUE(std::ranges::any_of(bound->contract().makes, [&](const Attribute& a) { return a.name == made.name; }))
          << declaration.name << " makes " << made.name << ", whose unit is " << made.unit;
      ++seen;
    }
  }
  EXPECT_GT(seen, 10u);
  std::filesystem::remove(other);
}

}  // namespace
}  // namespace pointsweep
