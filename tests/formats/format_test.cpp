// SPDX-License-Identifier: MIT
/// What a format says of itself holds: the same laws for every format of the list.
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

/// The table of the formats, which a change of a descriptor changes: put the printed one into docs/formats.md.
TEST(Format, TheDocumentationHasTheTableOfAllFormats) {
  std::ifstream file(std::filesystem::path(POINTSWEEP_SOURCE_DIR) / "docs/formats.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(page, ::testing::HasSubstr(formats_table()));
}

}  // namespace
}  // namespace pointsweep
