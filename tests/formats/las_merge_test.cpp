// SPDX-License-Identifier: MIT
/// LAS files of different point formats, scales and extra bytes as one LAS file, and LAS -> PLY -> LAS.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/pipeline/output/output_set.h"
#include "tests/formats/las_decode.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/data_folder.h"

namespace pointsweep::las_merge_test {
namespace {

namespace fs = std::filesystem;
using las_test::Decoded;
using las_test::decoded;
using las_test::Values;

/// Properties of a small file of random records.
struct Kind {
  int format = 0;
  double scale = 0.01;
  std::array<double, 3> offset{0, 0, 0};
  std::vector<std::string> extra{};  ///< descriptors of extra bytes, of one byte each
  std::vector<std::string> vlrs{};
  int encoding = -1;  ///< global encoding; -1: the WKT bit that the format requires
  int minor = 0;      ///< 0: the first version that has the format
  int unnamed = 0;    ///< bytes of a record without a descriptor
};

/// Returns a LAS file with coordinates within a kilometre of (1000, 2000, 300), and waveform offsets that a double
/// holds exactly.
std::string las_bytes(const Kind& kind, unsigned seed) {
  las_test::File file;
  file.format = kind.format;
  file.minor = kind.minor != 0 ? kind.minor : kind.format >= 6 ? 4 : kind.format >= 4 ? 3 : 2;
  file.extra_bytes = static_cast<int>(kind.extra.size()) + kind.unnamed;
  file.count = 50;
  file.seed = seed;
  file.scale = {kind.scale, kind.scale, kind.scale};
  file.offset = kind.offset;
  file.vlrs = kind.vlrs;
  std::string descriptors;
  for (const std::string& d : kind.extra) descriptors += d;
  if (!descriptors.empty()) file.vlrs.push_back(las_test::vlr("LASF_Spec", 4, descriptors));
  std::string bytes = file.bytes();
  bytes[6] = static_cast<char>(kind.encoding >= 0 ? kind.encoding : kind.format >= 6 ? 16 : 0);
  bytes[7] = 0;
  std::mt19937 random(seed + 7);
  const std::array<double, 3> center{1000, 2000, 300};
  std::array<double, 3> lo{1e9, 1e9, 1e9}, hi{-1e9, -1e9, -1e9};
  for (std::size_t i = 0; i < file.count; ++i) {
    const std::size_t at = file.points_at() + i * file.record_length();
    for (std::size_t a = 0; a < 3; ++a) {
      const double wanted = center[a] + std::uniform_real_distribution<double>(-1000, 1000)(random);
      const auto raw = static_cast<std::int32_t>(std::nearbyint((wanted - kind.offset[a]) / kind.scale));
      las_test::put(bytes, at + 4 * a, raw);
      lo[a] = std::min(lo[a], raw * kind.scale + kind.offset[a]);
      hi[a] = std::max(hi[a], raw * kind.scale + kind.offset[a]);
    }
    if (las_test::has_waveform(kind.format)) {
      const std::size_t behind = static_cast<std::size_t>(las_test::kRecordLength[kind.format]) - 28;
      las_test::put(bytes, at + behind, std::uint64_t{1000} * i);
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    las_test::put(bytes, 179 + 16 * a, hi[a]);
    las_test::put(bytes, 187 + 16 * a, lo[a]);
  }
  return bytes;
}

/// Copies the inputs in their order into an output as a run writes it, and returns the warnings.
std::vector<std::string> copy_points(const std::vector<fs::path>& inputs, const fs::path& out) {
  InputCloud cloud(inputs, {.ignore_crs = true});
  const std::vector<std::byte> records = all_records(cloud, cloud.schema(), cloud.count());
  const PositionFields p = position_fields(cloud.schema(), "the inputs");
  Box bounds;
  for (const std::byte* at = records.data(); at != records.data() + records.size(); at += cloud.schema().stride)
    bounds.include(Vec3{value_of(p.x, at), value_of(p.y, at), value_of(p.z, at)});
  EngineOptions options;
  options.overwrite = true;
  OutputSet files(cloud, {}, {.points = out, .arrays = {}, .writer = {}}, options,
                  {bounds, std::make_shared<KnownValues>(las_values(cloud, {}, {}))});
  files.write_records(records);
  std::vector<std::string> warnings = cloud.warnings();
  for (const std::string& warning : files.warnings()) warnings.push_back(warning);
  files.finish(cloud);
  return warnings;
}

/// Returns the shortest point format that has all fields of both formats, by the tables of the specification.
int expected_format(int a, int b) {
  const bool modern = a >= 6 || b >= 6;
  const bool color = las_test::has_color(a) || las_test::has_color(b);
  const bool nir = las_test::has_nir(a) || las_test::has_nir(b);
  const bool time = las_test::has_time(a) || las_test::has_time(b);
  if (las_test::has_waveform(a) || las_test::has_waveform(b)) return modern ? color ? 10 : 9 : color ? 5 : 4;
  if (modern) return nir ? 8 : color ? 7 : 6;
  return time ? color ? 3 : 1 : color ? 2 : 0;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Expects that `out` has every value of `in`, with coordinates that differ by at most `tolerance`. Fields that `in`
/// lacks are 0, but the overlap flag of points of class 12 is 1.
void expect_values(const Values& in, const Values& out, double tolerance, const std::string& where) {
  for (const auto& [name, value] : out) {
    const auto found = in.find(name);
    const double missing = name == "overlap" && in.at("classification") == 12 ? 1 : 0;
    const double wanted = found != in.end() ? found->second : missing;
    const bool coordinate = name == "x" || name == "y" || name == "z";
    const double most = coordinate ? tolerance : name == "scan_angle" ? 0.003 + 1e-9 : 0;
    if (most == 0 ? !same(value, wanted) : !(std::abs(value - wanted) <= most))
      ADD_FAILURE() << where << ": " << name << " is " << value << " instead of " << wanted;
  }
  for (const auto& [name, value] : in)
    if (!out.count(name) && value != 0) ADD_FAILURE() << where << ": " << name << " is lost";
}

void expect_points(const std::vector<fs::path>& inputs, const Decoded& out, double tolerance) {
  std::size_t row = 0;
  for (const fs::path& path : inputs) {
    const Decoded in = decoded(path);
    for (std::size_t i = 0; i < in.count(); ++i, ++row) {
      expect_values(in.point(i), out.point(row), tolerance, path.filename().string() + " point " + std::to_string(i));
      if (testing::Test::HasFailure()) return;
    }
  }
  EXPECT_EQ(row, out.count());
}

bool contains(const std::vector<std::string>& sentences, const std::string& part) {
  return std::any_of(sentences.begin(), sentences.end(),
                     [&](const std::string& s) { return s.find(part) != std::string::npos; });
}

TEST(LasMerge, AnyTwoPointFormatsMeetInTheShortestThatHasTheirFields) {
  const TemporaryFolder folder;
  for (int a = 0; a <= 10; ++a) {
    for (int b = 0; b <= 10; ++b) {
      const auto first = folder.write("a.las", las_bytes({.format = a}, 1));
      const auto second = folder.write("b.las", las_bytes({.format = b, .scale = 0.001, .offset = {500, 0, 0}}, 2));
      copy_points({first, second}, folder / "out.las");
      const Decoded out = decoded(folder / "out.las");
      SCOPED_TRACE(std::to_string(a) + " and " + std::to_string(b));
      ASSERT_EQ(out.format(), expected_format(a, b));
      ASSERT_EQ(out.record_length(), static_cast<std::size_t>(las_test::kRecordLength[out.format()]));
      ASSERT_EQ(out.vlr("LASF_Spec", 4), "") << "there are no fields but those of the format";
      for (std::size_t axis = 0; axis < 3; ++axis) ASSERT_EQ(out.scale(axis), 0.001);
      ASSERT_EQ(out.wkt_bit(), out.format() >= 6);
      expect_points({first, second}, out, 1e-9);
      if (HasFailure()) return;
    }
  }
}

TEST(LasMerge, OldFilesStayAsOldAsTheirFormatAllows) {
  const TemporaryFolder folder;
  const auto minor_of = [&](Kind a, Kind b) {
    copy_points({folder.write("a.las", las_bytes(a, 1)), folder.write("b.las", las_bytes(b, 2))}, folder / "out.las");
    return decoded(folder / "out.las").minor();
  };
  EXPECT_EQ(minor_of({.format = 0, .minor = 1}, {.format = 1, .minor = 1}), 1);
  EXPECT_EQ(minor_of({.format = 0, .minor = 1}, {.format = 3, .minor = 2}), 2);
  EXPECT_EQ(minor_of({.format = 0, .minor = 2}, {.format = 4, .minor = 3}), 3);
  EXPECT_EQ(minor_of({.format = 0, .minor = 1}, {.format = 6, .minor = 4}), 4);
}

TEST(LasMerge, OffsetsOfWholeStepsGiveTheSameIntegersAgain) {
  const TemporaryFolder folder;
  const auto first = folder.write("a.las", las_bytes({.format = 1, .scale = 0.01, .offset = {0.005, 0, 0}}, 1));
  const auto second = folder.write("b.las", las_bytes({.format = 1, .scale = 0.0025, .offset = {100, 0, 7}}, 2));
  copy_points({first, second}, folder / "out.las");
  const Decoded out = decoded(folder / "out.las");
  EXPECT_EQ(out.scale(0), 0.0025);
  expect_points({first, second}, out, 1e-9);
}

TEST(LasMerge, GridsWithoutCommonStepsAreRoundedToTheFinestScaleWithAWarning) {
  const TemporaryFolder folder;
  const auto first = folder.write("a.las", las_bytes({.format = 1, .scale = 0.01}, 1));
  const auto second = folder.write("b.las", las_bytes({.format = 3, .scale = 0.003, .offset = {0.0011, 0, 0}}, 2));
  const auto warnings = copy_points({first, second}, folder / "out.las");
  const Decoded out = decoded(folder / "out.las");
  EXPECT_EQ(out.format(), 3);
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(out.scale(axis), 0.003);
  EXPECT_TRUE(contains(warnings, "rounded to steps of 0.003"));
  expect_points({first, second}, out, 0.0015 + 1e-9);
}

TEST(LasMerge, AFineScaleMovesItsOffsetWhereAFarFileNeedsIt) {
  const TemporaryFolder folder;
  const auto first = folder.write("a.las", las_bytes({.format = 1, .scale = 0.01}, 1));
  const auto second = folder.write("b.las", las_bytes({.format = 1, .scale = 1e-6, .offset = {1000, 2000, 300}}, 2));
  copy_points({first, second}, folder / "out.las");
  const Decoded out = decoded(folder / "out.las");
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(out.scale(axis), 1e-6);
  expect_points({first, second}, out, 1e-9);
}

TEST(LasMerge, ExtraBytesKeepTheirDescriptions) {
  const TemporaryFolder folder;
  std::string flag = las_test::descriptor("flag", 1, 1), range = las_test::descriptor("range", 2, 0b111);
  las_test::put(flag, 40, std::uint64_t{255});  // the no-data value
  flag.replace(160, 6, "a flag");
  const auto first = folder.write("a.las", las_bytes({.format = 1, .extra = {flag}}, 1));
  const auto second = folder.write("b.las", las_bytes({.format = 6, .extra = {range, flag}}, 2));
  const auto third = folder.write("c.las", las_bytes({.format = 3}, 3));
  copy_points({first, second, third}, folder / "out.las");
  const Decoded out = decoded(folder / "out.las");
  EXPECT_EQ(out.format(), 7);
  EXPECT_EQ(out.extra_names(), (std::vector<std::string>{"flag", "range"}));
  const std::string vlr = out.vlr("LASF_Spec", 4);
  EXPECT_EQ(vlr.substr(0, 192), flag);
  EXPECT_EQ(vlr[192 + 3], 1) << "smallest and largest value are no longer known";
  const Decoded a = decoded(first), b = decoded(second);
  const auto extra = [](const Decoded& file, std::size_t i, std::size_t at) {
    return file.bytes[las_test::get<std::uint32_t>(file.bytes, 96) + i * file.record_length() +
                      static_cast<std::size_t>(las_test::kRecordLength[file.format()]) + at];
  };
  for (std::size_t i = 0; i < 50; ++i) {
    ASSERT_EQ(extra(out, i, 0), extra(a, i, 0));
    ASSERT_EQ(extra(out, i, 1), 0);
    ASSERT_EQ(extra(out, 50 + i, 0), extra(b, i, 1));
    ASSERT_EQ(extra(out, 50 + i, 1), extra(b, i, 0));
    ASSERT_EQ(extra(out, 100 + i, 0), 0);
  }
}

TEST(LasMerge, TimesOfTwoKindsAreAWarning) {
  const TemporaryFolder folder;
  const auto week = folder.write("week.las", las_bytes({.format = 1, .encoding = 0}, 1));
  const auto standard = folder.write("standard.las", las_bytes({.format = 3, .encoding = 1}, 2));
  const auto timeless = folder.write("timeless.las", las_bytes({.format = 0, .encoding = 0}, 3));
  EXPECT_TRUE(contains(copy_points({week, standard}, folder / "out.las"), "standard.las adjusted standard GPS time"));
  EXPECT_FALSE(decoded(folder / "out.las").standard_time_bit());
  const std::vector<std::string> warnings = copy_points({timeless, standard}, folder / "out.las");
  EXPECT_FALSE(contains(warnings, "GPS time")) << "there is one kind of time";
  EXPECT_TRUE(contains(warnings, "timeless.las: has no 'gps_time'"));
  EXPECT_TRUE(decoded(folder / "out.las").standard_time_bit());
}

const std::string kWkt = R"(PROJCS["UTM",GEOGCS["g"],AUTHORITY["EPSG","26910"]])";
std::string wkt_vlr() { return las_test::vlr("LASF_Projection", 2112, kWkt + '\0'); }
std::string geotiff_vlr() {
  const std::uint16_t keys[] = {1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 26910};
  return las_test::vlr("LASF_Projection", 34735, {reinterpret_cast<const char*>(keys), sizeof keys});
}

TEST(LasMerge, PointFormats6To10GetTheWktOfAnyInputAndElseSayThatThereIsNone) {
  const TemporaryFolder folder;
  const auto old = folder.write("old.las", las_bytes({.format = 1, .vlrs = {geotiff_vlr()}}, 1));
  const auto bare = folder.write("bare.las", las_bytes({.format = 6}, 2));
  const auto modern = folder.write("modern.las", las_bytes({.format = 6, .vlrs = {wkt_vlr()}}, 3));
  EXPECT_TRUE(contains(copy_points({old, bare}, folder / "out.las"), "only GeoTIFF keys"));
  EXPECT_FALSE(decoded(folder / "out.las").wkt_bit());
  EXPECT_NE(decoded(folder / "out.las").vlr("LASF_Projection", 34735), "");
  EXPECT_TRUE(copy_points({old, modern}, folder / "out.las").empty());
  EXPECT_TRUE(decoded(folder / "out.las").wkt_bit());
  EXPECT_EQ(decoded(folder / "out.las").vlr("LASF_Projection", 2112), kWkt + '\0');
  copy_points({modern, old}, folder / "out.las");
  EXPECT_TRUE(decoded(folder / "out.las").wkt_bit());
}

TEST(LasMerge, AWktBesideRecordsOfAnOldVersionMakesItLas14) {
  const TemporaryFolder folder;
  const auto bare = folder.write("bare.las", las_bytes({.format = 1}, 1));
  const auto ply = folder / "crs.ply";
  copy_points(
      {folder.write("modern.las", las_bytes({.format = 1, .vlrs = {wkt_vlr()}, .encoding = 16, .minor = 4}, 2))}, ply);
  copy_points({bare, ply}, folder / "out.las");
  EXPECT_EQ(decoded(folder / "out.las").minor(), 4);
  EXPECT_TRUE(decoded(folder / "out.las").wkt_bit());
}

TEST(LasMerge, WaveformsOfOtherInputsAreAWarning) {
  const TemporaryFolder folder;
  const auto a = folder.write("a.las", las_bytes({.format = 1}, 1)),
             b = folder.write("b.las", las_bytes({.format = 4}, 2));
  EXPECT_TRUE(contains(copy_points({a, b}, folder / "out.las"), "waveforms of " + b.string() + " are not copied"));
  EXPECT_FALSE(contains(copy_points({b, a}, folder / "out.las"), "waveforms of"));
}

TEST(LasMerge, BytesThatNothingDescribesAreLeftOutWithAWarning) {
  const TemporaryFolder folder;
  const auto a = folder.write("a.las", las_bytes({.format = 1}, 1));
  const auto b = folder.write("b.las", las_bytes({.format = 3, .unnamed = 3}, 2));
  EXPECT_TRUE(contains(copy_points({a, b}, folder / "out.las"), "3 bytes of each point of " + b.string()));
  EXPECT_TRUE(copy_points({b}, folder / "out.las").empty());
}

TEST(LasThroughPly, IsTheSamePointFormatScaleAndValues) {
  const TemporaryFolder folder;
  for (int format = 0; format <= 10; ++format) {
    SCOPED_TRACE(format);
    const Kind kind{.format = format, .scale = 0.001, .offset = {600, 0.25, -1}, .encoding = format >= 6 ? 17 : 1};
    const auto in = folder.write("in.las", las_bytes(kind, 1));
    copy_points({in}, folder / "a.ply");
    copy_points({folder / "a.ply"}, folder / "b.ply");
    ASSERT_EQ(contents(folder / "a.ply"), contents(folder / "b.ply"));
    copy_points({folder / "b.ply"}, folder / "out.las");
    const Decoded out = decoded(folder / "out.las");
    ASSERT_EQ(out.format(), format);
    ASSERT_EQ(out.vlr("LASF_Spec", 4), "");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(out.scale(axis), 0.001);
      ASSERT_EQ(out.offset(axis), kind.offset[axis]);
    }
    ASSERT_EQ(out.standard_time_bit(), las_test::has_time(format));
    const Decoded before = decoded(in);
    const std::size_t length = before.record_length();
    for (std::size_t i = 0; i < before.count(); ++i)
      ASSERT_EQ(before.bytes.substr(las_test::get<std::uint32_t>(before.bytes, 96) + i * length, length),
                out.bytes.substr(las_test::get<std::uint32_t>(out.bytes, 96) + i * length, length));
  }
}

TEST(LasThroughPly, MeetsLasAgainAtTheFinestScale) {
  const TemporaryFolder folder;
  const auto first = folder.write("a.las", las_bytes({.format = 1, .scale = 0.01}, 1));
  const auto second = folder.write("b.las", las_bytes({.format = 3, .scale = 0.001, .offset = {3, 4, 5}}, 2));
  copy_points({first}, folder / "a.ply");
  copy_points({second}, folder / "b.ply");
  for (const auto& inputs :
       {std::vector{folder / "a.ply", second}, {first, folder / "b.ply"}, {folder / "a.ply", folder / "b.ply"}}) {
    copy_points(inputs, folder / "out.las");
    const Decoded out = decoded(folder / "out.las");
    EXPECT_EQ(out.format(), 3);
    EXPECT_EQ(out.scale(0), 0.001);
    EXPECT_EQ(out.vlr("LASF_Spec", 4), "");
    expect_points({first, second}, out, 1e-9);
  }
}

/// Copies a LAS file to PLY, moves the x of the first point by 0.0037, and returns the path.
fs::path moved_ply(const TemporaryFolder& folder, const fs::path& las) {
  copy_points({las}, folder / "still.ply");
  std::string ply = contents(folder / "still.ply");
  const std::size_t at = ply.find("end_header\n") + 11;
  las_test::put(ply, at, las_test::get<double>(ply, at) + 0.0037);
  return folder.write("moved.ply", ply);
}

TEST(LasThroughPly, PointsThatLeftTheGridGetAFinerOne) {
  const TemporaryFolder folder;
  const auto in = folder.write("in.las", las_bytes({.format = 1, .scale = 0.01}, 1));
  copy_points({moved_ply(folder, in)}, folder / "out.las");
  const Decoded out = decoded(folder / "out.las");
  EXPECT_LT(out.scale(0), 1e-5);
  EXPECT_NEAR(out.point(0)["x"], decoded(in).point(0)["x"] + 0.0037, 1e-5);
}

/// Writes a PLY file with the fields of a LAS file and one more property.
fs::path ply_with(const TemporaryFolder& folder, const std::string& property, const std::vector<std::string>& values) {
  std::string ply =
      "ply\nformat ascii 1.0\ncomment las scale 0.01 0.01 0.01 offset 0 0 0 gps_time week\nelement vertex " +
      std::to_string(values.size()) + "\nproperty double x\nproperty double y\nproperty double z\nproperty " +
      property + "\nend_header\n";
  for (const std::string& value : values) ply += "1 2 3.25 " + value + "\n";
  return folder.write("in.ply", ply);
}

TEST(LasThroughPly, ValuesDecideThePointFormatAndWhatNoFieldHoldsIsStoredExactlyBeside) {
  const TemporaryFolder folder;
  const auto copied = [&](const std::string& property, const std::vector<std::string>& values) {
    copy_points({ply_with(folder, property, values)}, folder / "out.las");
    return decoded(folder / "out.las");
  };
  EXPECT_EQ(copied("uchar classification", {"2", "31"}).format(), 0);
  EXPECT_EQ(copied("uchar classification", {"2", "32"}).format(), 6);
  EXPECT_EQ(copied("uchar return_number", {"7"}).format(), 0);
  EXPECT_EQ(copied("uchar return_number", {"8"}).format(), 6);
  EXPECT_EQ(copied("float scan_angle", {"-12"}).format(), 0);
  EXPECT_EQ(copied("float scan_angle", {"-12.5"}).format(), 6);
  EXPECT_EQ(copied("float intensity", {"5", "65535"}).vlr("LASF_Spec", 4), "") << "whole numbers fit as they are";
  const Decoded classes = copied("ushort classification", {"2", "300"});
  EXPECT_EQ(classes.point(1)["classification"], classes.format() >= 6 ? 255 : 31);
  EXPECT_EQ(classes.extra_names(), std::vector<std::string>{"classification_uint16"});
  EXPECT_EQ(copied("float intensity", {"0.5"}).extra_names(), std::vector<std::string>{"intensity_float32"});
  EXPECT_EQ(copied("float scan_angle", {"400"}).extra_names(), std::vector<std::string>{"scan_angle_float32"});
}

TEST(LasThroughPly, Class12OfOldFormatsStillMeansOverlap) {
  const TemporaryFolder folder;
  const auto old = folder.write("old.las", las_bytes({.format = 1}, 1));
  const auto modern = folder.write("modern.las", las_bytes({.format = 6}, 2));
  copy_points({old}, folder / "old.ply");
  copy_points({folder / "old.ply", modern}, folder / "out.las");
  const Decoded out = decoded(folder / "out.las");
  ASSERT_EQ(out.format(), 6);
  expect_points({old, modern}, out, 1e-9);
  std::size_t overlaps = 0;
  for (std::size_t row = 0; row < decoded(old).count(); ++row) overlaps += out.point(row)["overlap"] == 1;
  EXPECT_GT(overlaps, 0u);
}

TEST(LasThroughPly, CommentsThatMakeNoSenseStayComments) {
  const TemporaryFolder folder;
  for (const char* line :
       {"comment las scale 0 1 1 offset 0 0 0", "comment las scale 1 1 1 offset 0 0 nan",
        "comment las scale 1 1 1 offset 0 0 0 gps_time never",
        "comment las scale 1 1 1 offset 0 0 0 class_12_is_overlap x", "comment las files are fine"}) {
    const auto in = folder.write("in.ply", std::string("ply\nformat ascii 1.0\n") + line +
                                               "\nelement vertex 1\nproperty float x\nproperty float y\n"
                                               "property float z\nend_header\n1 2 3\n");
    EXPECT_FALSE(open_reader(in)->info().las != nullptr) << line;
    copy_points({in}, folder / "out.ply");
    EXPECT_NE(contents(folder / "out.ply").find(line), std::string::npos);
  }
}

/// Returns real files, small files first, of each point format with and without extra bytes.
std::vector<fs::path> real_files() {
  std::map<std::pair<int, bool>, std::vector<fs::path>> by_kind;
  std::vector<std::pair<std::uintmax_t, fs::path>> all;
  for (const auto& entry : fs::recursive_directory_iterator(data_folder() / "lidar"))
    if (entry.path().extension() == ".las" && entry.file_size() < (1 << 18)) all.push_back({entry.file_size(), entry});
  std::sort(all.begin(), all.end());
  for (const auto& [size, path] : all) {
    const Decoded file = decoded(path);
    if (file.bytes.size() < 227 || file.format() > 10 || file.count() < 2) continue;
    auto& kind = by_kind[{file.format(),
                          file.record_length() > static_cast<std::size_t>(las_test::kRecordLength[file.format()])}];
    if (kind.size() < 2) kind.push_back(path);
  }
  std::vector<fs::path> chosen;
  for (const auto& [kind, paths] : by_kind) chosen.insert(chosen.end(), paths.begin(), paths.end());
  return chosen;
}

/// Returns whether `name` is the name of an extra-bytes field of one of the files, or of undocumented bytes.
bool is_known_name(const std::string& name, const Decoded& a, const Decoded& b) {
  for (const Decoded* file : {&a, &b}) {
    for (const std::string& extra : file->extra_names()) {
      if (name == extra || name.starts_with(extra + "[") || name.starts_with(extra + "_")) return true;
    }
  }
  return name.starts_with("undocumented");
}

/// Returns the expected scale of a merge of both files along `axis`: the finer scale; absent if 32 bits do not suffice
/// for it.
std::optional<double> scale_of_merge(const Decoded& a, const Decoded& b, std::size_t axis) {
  const double finest = std::min(a.scale(axis), b.scale(axis));
  double lo = 1e300, hi = -1e300;
  for (const Decoded* file : {&a, &b}) {
    for (std::size_t i = 0; i < file->count(); ++i) {
      const double value = file->point(i)[std::string(1, "xyz"[axis])];
      lo = std::min(lo, value);
      hi = std::max(hi, value);
    }
  }
  return (hi - lo) / finest < 4.29e9 ? std::optional(finest) : std::nullopt;
}

TEST(LasMerge, RealFilesOfDifferentPointFormatsHaveOnlyStandardNamesAndTheFinestScale) {
  if (data_folder().empty()) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
  const TemporaryFolder folder;
  const std::vector<fs::path> files = real_files();
  std::size_t pairs = 0;
  for (const fs::path& first : files) {
    for (const fs::path& second : files) {
      const Decoded a = decoded(first), b = decoded(second);
      if (a.format() == b.format()) continue;
      SCOPED_TRACE(first.string() + " and " + second.string());
      copy_points({first, second}, folder / "out.las");
      const Decoded out = decoded(folder / "out.las");
      ASSERT_EQ(out.format(), expected_format(a.format(), b.format()));
      for (const std::string& name : out.extra_names()) ASSERT_TRUE(is_known_name(name, a, b)) << name;
      double tolerance = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto wanted = scale_of_merge(a, b, axis);
        ASSERT_EQ(out.scale(axis), wanted.value_or(out.scale(axis)));
        tolerance = std::max(tolerance, 0.5001 * out.scale(axis) + 1e-9);
      }
      expect_points({first, second}, out, tolerance);
      if (HasFailure()) return;
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 50u);
}

TEST(LasThroughPly, RealFilesComeBackWithTheSamePoints) {
  if (data_folder().empty()) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
  const TemporaryFolder folder;
  for (const fs::path& path : real_files()) {
    SCOPED_TRACE(path.string());
    const Decoded in = decoded(path);
    copy_points({path}, folder / "a.ply");
    copy_points({folder / "a.ply"}, folder / "out.las");
    const Decoded out = decoded(folder / "out.las");
    EXPECT_EQ(out.format(), in.format());
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(out.scale(axis), in.scale(axis));
    expect_points({path}, out, 1e-9);
    if (HasFailure()) return;
  }
}

TEST(LasMerge, TellsAWriterOnceOfFurtherInputsThatAreAlike) {
  const TemporaryFolder folder;
  const std::string one = las_test::descriptor("one", 1), two = las_test::descriptor("two", 1);
  const std::vector<Kind> kinds = {{.format = 3}, {.format = 3, .extra = {one}}, {.format = 3, .extra = {two}},
                                   {.format = 1}, {.format = 3, .minor = 4},     {.format = 3, .unnamed = 2}};
  std::vector<fs::path> inputs;
  for (unsigned i = 0; i < 4 * kinds.size(); ++i)
    inputs.push_back(folder.write(fmt::format("{}.las", i), las_bytes(kinds[i % kinds.size()], i)));
  EXPECT_EQ(InputCloud(inputs).other_extras().size(), kinds.size());
  copy_points(inputs, folder / "out.las");
  expect_points(inputs, decoded(folder / "out.las"), 1e-9);
}

}  // namespace
}  // namespace pointsweep::las_merge_test
