// SPDX-License-Identifier: MIT
/// Inputs with different attributes make one cloud, for all pairs of formats in both orders.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/registry.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kPoints = 3;

/// Writes three points with x, y, z and the attributes `names`, whose values are `value`, `value` + 1, ...
std::filesystem::path file_with(const std::filesystem::path& path, const std::vector<std::string>& names,
                                double value) {
  OutputPlan plan = plan_for(path, kPoints);
  for (const char* axis : {"x", "y", "z"}) plan.schema.append(axis, Type::f64);
  for (const std::string& name : names) plan.schema.append(name, Type::f64);
  plan.bounds.emplace();
  plan.bounds->include(Vec3{0, 0, 0});
  plan.bounds->include(Vec3{100, 100, 100});
  std::vector<std::byte> records(kPoints * plan.schema.stride);
  for (std::uint64_t row = 0; row < kPoints; ++row)
    for (const Field& field : plan.schema.fields)
      set_value(field, records.data() + row * plan.schema.stride, value + static_cast<double>(row));
  write_all(plan, records);
  return path;
}

std::vector<std::string> extensions() {
  std::vector<std::string> all;
  for (const Format* format : formats())
    if (format->create != nullptr && format->content == Format::Content::points && format->is_built_in())
      all.emplace_back(format->extensions.front());
  return all;
}

TEST(Union, HasTheAttributesOfAllInputsAndZeroWhereOneLacksThem) {
  const TemporaryFolder folder;
  for (const std::string& first : extensions())
    for (const std::string& second : extensions()) {
      SCOPED_TRACE(first + " and " + second);
      const auto a = file_with(folder / ("a" + first), {"only_a", "shared"}, 10);
      const auto b = file_with(folder / ("b" + second), {"shared", "only_b"}, 20);
      for (const bool turned : {false, true}) {
        InputCloud cloud(turned ? std::vector{b, a} : std::vector{a, b});
        const auto values = [&](const std::string& name) {
          return values_of(cloud, cloud.schema(), cloud.count(), name);
        };
        using Values = std::vector<double>;
        EXPECT_EQ(values("x"), turned ? (Values{20, 21, 22, 10, 11, 12}) : (Values{10, 11, 12, 20, 21, 22}));
        EXPECT_EQ(values("shared"), values("x"));
        EXPECT_EQ(values("only_a"), turned ? (Values{0, 0, 0, 10, 11, 12}) : (Values{10, 11, 12, 0, 0, 0}));
        EXPECT_EQ(values("only_b"), turned ? (Values{20, 21, 22, 0, 0, 0}) : (Values{0, 0, 0, 20, 21, 22}));
        const std::string warnings = fmt::format("{}", fmt::join(cloud.warnings(), "\n"));
        EXPECT_THAT(warnings, HasSubstr(a.string() + ": has no "));
        EXPECT_THAT(warnings, HasSubstr(b.string() + ": has no "));
        EXPECT_THAT(warnings, HasSubstr("'only_a', which " + a.string()));
        EXPECT_THAT(warnings, HasSubstr("'only_b', which " + b.string()));
      }
      std::filesystem::remove(a);
      std::filesystem::remove(b);
    }
}

}  // namespace
}  // namespace pointsweep
