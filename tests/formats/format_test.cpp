// SPDX-License-Identifier: MIT
/// Laws for every format of the registry: the facts that its descriptor states are true.
#include "pointsweep/formats/format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <set>

#include "pointsweep/error.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/formats/registry.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

/// Calls `check(format, path)` for every extension of every format whose outputs are points.
template <class Check>
void for_each_written_name(const TemporaryFolder& folder, Check check) {
  std::size_t names = 0;
  for (const Format* format : formats()) {
    if (format->create == nullptr || format->content != Format::Content::points) continue;
    names += format->extensions.size();
    if (!format->is_built_in()) continue;
    for (const std::string_view extension : format->extensions) {
      SCOPED_TRACE(extension);
      check(*format, folder / ("out" + std::string(extension)));
    }
  }
  EXPECT_EQ(names, writable_extensions().size());
}

OutputPlan plan_of_points(const std::filesystem::path& path, std::span<const double> xyz) {
  OutputPlan plan = plan_for(path, xyz.size() / 3);
  for (const char* axis : {"x", "y", "z"}) plan.schema.append(axis, Type::f64);
  plan.bounds.emplace();
  for (std::size_t i = 0; i < xyz.size(); i += 3)
    if (std::isfinite(xyz[i])) plan.bounds->include(Vec3{xyz[i], xyz[i + 1], xyz[i + 2]});
  return plan;
}

TEST(Format, HoldsWhatItSaysOfCoordinateSystemAndProvenance) {
  const TemporaryFolder folder;
  const double xyz[] = {1, 2, 3, 4, 5, 6};
  for_each_written_name(folder, [&](const Format& format, const std::filesystem::path& path) {
    OutputPlan plan = plan_of_points(path, xyz);
    plan.crs = crs_of_wkt("PROJCS[\"mine\",GEOGCS[\"g\"],AUTHORITY[\"EPSG\",\"26910\"]]");
    plan.provenance = lines_of({.version = "1", .stages = {"normals"}, .settings = {}, .inputs = {}});
    std::vector<std::string> warnings;
    {
      const auto writer = create_writer(plan);
      writer->write(std::as_bytes(std::span(xyz)));
      writer->finish();
      warnings = writer->warnings();
    }
    const auto reader = open_reader(path);
    EXPECT_EQ(reader->info().crs.has_value(), format.holds_crs);
    EXPECT_EQ(!reader->info().provenance.empty(), format.holds_provenance);
    EXPECT_EQ(std::ranges::any_of(warnings, [](const auto& w) { return w.find("EPSG:26910") != w.npos; }),
              !format.holds_crs);
    EXPECT_EQ(reader->info().bounds.has_value(), format.states_bounds);
  });
}

TEST(Format, HoldsRealCoordinatesIfItSaysSo) {
  const TemporaryFolder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double xyz[] = {1.0 / 3, 1e6 + 1.0 / 7, 3, nan, 5, 6};
  for_each_written_name(folder, [&](const Format& format, const std::filesystem::path& path) {
    const OutputPlan plan = plan_of_points(path, xyz);
    if (!format.real_coordinates) {
      EXPECT_THROW(write_all(plan, std::as_bytes(std::span(xyz))), Error);
      return;
    }
    write_all(plan, std::as_bytes(std::span(xyz)));
    const auto reader = open_reader(path);
    EXPECT_EQ(values_of(*reader, "x")[0], xyz[0]);
    EXPECT_EQ(values_of(*reader, "y")[0], xyz[1]);
    EXPECT_TRUE(std::isnan(values_of(*reader, "x")[1]));
  });
}

TEST(Format, KeepsNamesOfTheLengthItSays) {
  const TemporaryFolder folder;
  const double values[] = {1, 2, 3, 4};
  for_each_written_name(folder, [&](const Format& format, const std::filesystem::path& path) {
    for (const std::size_t length : {std::size_t{32}, std::size_t{33}}) {
      OutputPlan plan = plan_of_points(path, std::span(values).first(3));
      plan.overwrite = true;
      const std::string name(length, 'a');
      plan.schema.append(name, Type::f64);
      write_all(plan, std::as_bytes(std::span(values)));
      const std::vector<std::string> names = field_names(open_reader(path)->info().schema);
      const bool kept = std::ranges::find(names, name) != names.end();
      EXPECT_EQ(kept, format.name_bytes == 0 || length <= format.name_bytes) << length;
    }
  });
}

TEST(Format, EveryExtensionBelongsToOneFormat) {
  std::set<std::string_view> known;
  for (const Format* format : formats())
    for (const std::string_view extension : format->extensions) {
      EXPECT_TRUE(known.insert(extension).second) << extension;
      EXPECT_EQ(format_of_output("a" + std::string(extension)), format->create == nullptr ? nullptr : format);
    }
  EXPECT_EQ(format_of_output("A.PLY"), format_of_output("a.ply"));
  EXPECT_EQ(format_of_output("a"), nullptr);
}

TEST(Format, ItsOutputsAreRecognisedByTheirFirstBytes) {
  const TemporaryFolder folder;
  const double xyz[] = {1, 2, 3};
  for_each_written_name(folder, [&](const Format& format, const std::filesystem::path& path) {
    write_all(plan_of_points(path, xyz), std::as_bytes(std::span(xyz)));
    std::ifstream file(path, std::ios::binary);
    std::string head(4096, '\0');
    file.read(head.data(), 4096);
    head.resize(static_cast<std::size_t>(file.gcount()));
    for (const Format* other : formats()) {
      if (other->is == nullptr) continue;
      EXPECT_EQ(other->is(head), other == &format) << other->name;
    }
  });
}

/// A change of a descriptor changes the table of the formats. If this test fails, put the printed table into
/// docs/formats.md.
TEST(Format, TheDocumentationHasTheTableOfAllFormats) {
  const std::filesystem::path page = std::filesystem::path(POINTSWEEP_SOURCE_DIR) / "docs/formats.md";
  EXPECT_THAT(contents(page), ::testing::HasSubstr(formats_table()));
}

/// Returns the least and the greatest value of a type, and values between them that are hard to store.
std::vector<double> extremes_of(Type type) {
  constexpr double kMostFloat = std::numeric_limits<float>::max(), kMostDouble = std::numeric_limits<double>::max();
  constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
  switch (type) {
    case Type::i8:
      return {-128, 127};
    case Type::u8:
      return {0, 31, 255};
    case Type::i16:
      return {-32768, 32767};
    case Type::u16:
      return {0, 65535};
    case Type::i32:
      return {-2147483648.0, 2147483647};
    case Type::u32:
      return {0, 4294967295};
    case Type::i64:
      return {-9223372036854775808.0, 9007199254740991, 9223372036854774784.0};
    case Type::u64:
      return {0, 9007199254740991, 18446744073709549568.0};
    case Type::f32:
      return {-kMostFloat, 0x1p-149, double{0.1f}, kInfinity, kNan};
    case Type::f64:
      break;
  }
  return {-kMostDouble, 0x1p-1074, 0.1, 255.5, 16777217, kInfinity, kNan};
}

/// Returns whether the file has `value` for the point at x = 4, in the field `name` or in the exact copy NAME_TYPE.
bool is_held(Reader& reader, const std::string& name, Type type, double value) {
  const std::vector<double> x = values_of(reader, "x");
  const auto row =
      static_cast<std::size_t>(std::ranges::find_if(x, [](double c) { return std::abs(c - 4) < 0.1; }) - x.begin());
  for (const std::string& field : {name, name + "_" + std::string(name_of(type))})
    for (const Field& own : reader.info().schema.fields) {
      if (library_name_of(own.name) != field && own.name != field) continue;
      double found = values_of(reader, own.name).at(row);
      if (type == Type::f32) found = static_cast<float>(found);  // text has the shortest decimals
      const double rounded =
          own.scale == 1 ? 0 : std::abs(own.scale) / 2 * (1 + 1e-9);  // for example LAS: degrees in steps of 0.006
      if (std::abs(found - value) <= rounded || found == value || (std::isnan(found) && std::isnan(value))) return true;
    }
  return false;
}

/// For every format, a written value is read again, or the error names the row, the attribute and the file.
TEST(Format, HoldsEveryValueOrNamesItsRow) {
  const TemporaryFolder folder;
  std::size_t refused = 0;
  for_each_written_name(folder, [&](const Format&, const std::filesystem::path& path) {
    for (int t = 0; t < 10; ++t)
      for (const char* name :
           {"level", "intensity", "classification", "return_number", "gps_time", "scan_angle", "nir"})
        for (const double value : extremes_of(static_cast<Type>(t))) {
          const double xyz[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
          OutputPlan plan = plan_of_points(path, xyz);
          plan.overwrite = true;
          plan.schema.append(name, static_cast<Type>(t));
          std::vector<std::byte> records(3 * plan.schema.stride);
          for (std::size_t i = 0; i < 3; ++i) std::memcpy(records.data() + i * plan.schema.stride, xyz + 3 * i, 24);
          set_value(plan.schema.fields.back(), records.data() + plan.schema.stride, value);
          try {
            write_all(plan, records);
            EXPECT_TRUE(is_held(*open_reader(path), name, static_cast<Type>(t), value))
                << path << " " << name << " " << name_of(static_cast<Type>(t)) << " " << value;
          } catch (const Error& error) {
            ++refused;
            EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("row 1:"), testing::HasSubstr(name),
                                                     testing::HasSubstr(path.string())));
          }
        }
  });
  EXPECT_GT(refused, 0u);  // PLY and E57 cannot store all integers of 64 bits
}

}  // namespace
}  // namespace pointsweep
