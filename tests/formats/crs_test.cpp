// SPDX-License-Identifier: MIT
/// Coordinate reference systems: read from WKT and GeoTIFF keys, compared, kept from file to file, refused where they
/// differ.
#include "pointsweep/formats/crs.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/engine_run.h"
#include "tests/formats/las_test_file.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep::crs_test {
namespace {

using las_test::vlr;

const std::string kUtm10 =
    R"(PROJCS["NAD83 / UTM zone 10N",GEOGCS["NAD83",DATUM["North_American_Datum_1983",SPHEROID["GRS 1980",6378137,)"
    R"(298.257222101]],AUTHORITY["EPSG","4269"]],UNIT["metre",1],AXIS["Easting",EAST],AUTHORITY["EPSG","26910"]])";
const std::string kWgs84 = R"(GEOGCRS["WGS 84",DATUM["World Geodetic System 1984"],CS[ellipsoidal,2],ID["EPSG",4326]])";

/// Returns the content of GeoKeyDirectoryTag. `entries`: four numbers for each key.
std::vector<std::uint16_t> directory(const std::vector<std::uint16_t>& entries) {
  std::vector<std::uint16_t> all{1, 1, 0, static_cast<std::uint16_t>(entries.size() / 4)};
  all.insert(all.end(), entries.begin(), entries.end());
  return all;
}
GeoTiffKeys projected(std::uint16_t code) { return {directory({1024, 0, 1, 1, 3072, 0, 1, code}), {}, ""}; }
GeoTiffKeys geographic(std::uint16_t code) { return {directory({1024, 0, 1, 2, 2048, 0, 1, code}), {}, ""}; }

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

TEST(Wkt, IsReadAsATreeWithEitherBracketAndQuotesInsideQuotes) {
  const auto root = parse_wkt(R"(  projcs ( "a ""b"" [c", Unit["metre", 1.0e0] , AXIS["E",EAST]) )");
  ASSERT_TRUE(root.has_value());
  EXPECT_EQ(root->keyword, "PROJCS");
  EXPECT_EQ(root->values, std::vector<std::string>{"a \"b\" [c"});
  ASSERT_EQ(root->children.size(), 2u);
  EXPECT_EQ(root->children[0].values, (std::vector<std::string>{"metre", "1.0e0"}));
  EXPECT_EQ(root->children[1].children.at(0).keyword, "EAST");
}

TEST(Wkt, DamagedTextsAreNoTrees) {
  for (const char* text : {"", "EPSG:4326", "A[", "A[]", "A[1", "A[\"b", "A[1]]", "A[1] B", "1", "A[,]"})
    EXPECT_FALSE(parse_wkt(text).has_value()) << text;
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "A[";
  EXPECT_FALSE(parse_wkt(deep).has_value());
}

TEST(Wkt, InOneLineKeepsSpacesInsideQuotes) {
  EXPECT_EQ(wkt_in_one_line("A[\n\t\"b  c\",\r\n  1]\n\0junk"), "A[ \"b  c\", 1]");
  EXPECT_EQ(wkt_in_one_line(std::string("A[1]\0\0junk", 10)), "A[1]");
}

TEST(Crs, OfWktHasNameKindAndTheCodeOfItsOutermostSystem) {
  const Crs utm = crs_of_wkt(kUtm10);
  EXPECT_EQ(utm.name, "NAD83 / UTM zone 10N");
  EXPECT_EQ(utm.epsg, 26910);
  EXPECT_EQ(utm.kind, CrsKind::projected);
  const Crs degrees = crs_of_wkt(kWgs84);
  EXPECT_EQ(degrees.epsg, 4326);
  EXPECT_EQ(degrees.kind, CrsKind::geographic);
  const Crs heights = crs_of_wkt("COMPD_CS[\"both\"," + kUtm10 + R"(,VERT_CS["NAVD88",AUTHORITY["EPSG","5703"]]])");
  EXPECT_EQ(heights.name, "both");
  EXPECT_EQ(heights.epsg, 26910);
  EXPECT_EQ(heights.vertical_epsg, 5703);
  EXPECT_EQ(crs_of_wkt("PROJCS[\"mine\",GEOGCS[\"g\",AUTHORITY[\"EPSG\",\"4269\"]]]").epsg, 0);
  EXPECT_EQ(crs_of_wkt("GEODCRS[\"ecef\",CS[Cartesian,3]]").kind, CrsKind::geocentric);
  EXPECT_EQ(crs_of_wkt("BOUNDCRS[SOURCECRS[" + kWgs84 + "],TARGETCRS[" + kUtm10 + "]]").epsg, 4326);
}

TEST(Crs, OfGeoTiffKeysHasItsCitationAndCodes) {
  GeoTiffKeys keys{directory({1024, 0, 1, 1, 3072, 0, 1, 26910, 3073, 34737, 21, 2, 4096, 0, 1, 5703}),
                   {},
                   "x|NAD83 / UTM zone 10N|"};
  const Crs crs = crs_of_geotiff(keys);
  EXPECT_EQ(crs.epsg, 26910);
  EXPECT_EQ(crs.vertical_epsg, 5703);
  EXPECT_EQ(crs.name, "NAD83 / UTM zone 10N");
  EXPECT_EQ(short_text(crs), "EPSG:26910+5703 (NAD83 / UTM zone 10N)");
  EXPECT_EQ(crs_of_geotiff(projected(32767)).epsg, 0) << "32767 means user-defined";
  EXPECT_EQ(crs_of_geotiff(geographic(4326)).kind, CrsKind::geographic);
}

TEST(Crs, DirectoriesThatPointAnywhereAreReadWithoutHarm) {
  for (const std::uint16_t place : std::vector<std::uint16_t>{34736, 34737, 5}) {
    GeoTiffKeys keys{directory({1024, place, 65535, 65535, 3072, place, 7, 3}), {1, 2}, "abc"};
    EXPECT_EQ(crs_of_geotiff(keys).epsg, 0);
  }
  GeoTiffKeys lies = projected(26910);
  lies.directory[3] = 60000;
  EXPECT_EQ(crs_of_geotiff(lies).epsg, 26910);
}

TEST(Crs, AreComparedByCodesAcrossEncodings) {
  const Crs utm = crs_of_wkt(kUtm10), same = crs_of_geotiff(projected(26910)), other = crs_of_geotiff(projected(26911));
  EXPECT_EQ(compare(utm, same), CrsAgreement::same);
  EXPECT_EQ(compare(utm, other), CrsAgreement::different);
  EXPECT_EQ(compare(same, crs_of_geotiff(geographic(4326))), CrsAgreement::different);
  EXPECT_EQ(compare(utm, crs_of_wkt(kWgs84)), CrsAgreement::different);
}

TEST(Crs, WithoutCodesAreComparedByKindTextAndNumbers) {
  const Crs mine = crs_of_wkt("PROJCS[\"mine\",GEOGCS[\"g\"]]"), yours = crs_of_wkt("PROJCS[\"yours\",GEOGCS[\"g\"]]");
  EXPECT_EQ(compare(mine, mine), CrsAgreement::same);
  EXPECT_EQ(compare(mine, yours), CrsAgreement::undecided);
  EXPECT_EQ(compare(mine, crs_of_wkt("GEOGCS[\"g\"]")), CrsAgreement::different);
  GeoTiffKeys a{directory({1024, 0, 1, 1, 3072, 0, 1, 32767, 3080, 34736, 1, 0, 1026, 34737, 3, 0}), {-123.0}, "one|"};
  GeoTiffKeys b = a;
  b.ascii = "two|";
  EXPECT_EQ(compare(crs_of_geotiff(a), crs_of_geotiff(b)), CrsAgreement::same) << "a citation is only a word";
  b.doubles = {-117.0};
  EXPECT_EQ(compare(crs_of_geotiff(a), crs_of_geotiff(b)), CrsAgreement::different);
  b.directory = directory({1024, 0, 1, 1, 3072, 0, 1, 32767});
  EXPECT_EQ(compare(crs_of_geotiff(a), crs_of_geotiff(b)), CrsAgreement::undecided);
}

TEST(Crs, HeightsThatOnlyOneDefinesAreUndecidedAndDifferentUnitsDifferent) {
  const auto with = [](std::vector<std::uint16_t> more) {
    std::vector<std::uint16_t> entries{1024, 0, 1, 1, 3072, 0, 1, 2994};
    entries.insert(entries.end(), more.begin(), more.end());
    return crs_of_geotiff({directory(entries), {}, ""});
  };
  EXPECT_EQ(compare(with({}), with({4096, 0, 1, 5703})), CrsAgreement::undecided);
  EXPECT_EQ(compare(with({4096, 0, 1, 5702}), with({4096, 0, 1, 5703})), CrsAgreement::different);
  EXPECT_EQ(compare(with({3076, 0, 1, 9001}), with({3076, 0, 1, 9002})), CrsAgreement::different);
}

/// Writes a small LAS file with these VLRs.
std::filesystem::path las_with(const TemporaryFolder& folder, const std::string& name, std::vector<std::string> vlrs,
                               int format = 1) {
  las_test::File file;
  file.count = 3;
  file.format = format;
  file.minor = format >= 6 ? 4 : 2;
  file.vlrs = std::move(vlrs);
  std::string bytes = file.bytes();
  bytes[6] = format >= 6 ? 16 : 0;
  bytes[7] = 0;
  return folder.write(name, bytes);
}
std::string geotiff_vlr(const GeoTiffKeys& keys) { return vlr("LASF_Projection", 34735, bytes_of(keys.directory)); }
std::string wkt_vlr(const std::string& wkt) { return vlr("LASF_Projection", 2112, wkt + '\0'); }

void run_copy(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& out,
              std::vector<std::string>* warnings = nullptr, CloudOptions options = {}) {
  InputCloud cloud(inputs, options);
  EngineOptions plain;
  plain.provenance = false;
  const Statistics statistics = sort(cloud, out, plain);
  if (warnings != nullptr) *warnings = statistics.warnings;
}

bool contains(const std::vector<std::string>& sentences, const std::string& part) {
  for (const std::string& sentence : sentences)
    if (sentence.find(part) != std::string::npos) return true;
  return false;
}

TEST(CrsOfLas, IsReadFromVlrsAndExtendedVlrs) {
  const TemporaryFolder folder;
  EXPECT_EQ(open_reader(las_with(folder, "a.las", {geotiff_vlr(projected(26910))}))->info().crs->epsg, 26910);
  EXPECT_EQ(open_reader(las_with(folder, "b.las", {wkt_vlr(kUtm10)}, 6))->info().crs->epsg, 26910);
  EXPECT_FALSE(open_reader(las_with(folder, "c.las", {vlr("me", 2112, kUtm10)}))->info().crs.has_value());
  EXPECT_FALSE(open_reader(las_with(folder, "e.las", {geotiff_vlr({{1, 1, 0, 0}, {}, ""})}))->info().crs.has_value());
  las_test::File file;
  file.minor = 4;
  file.evlrs = {vlr("LASF_Projection", 2112, kUtm10, true)};
  EXPECT_EQ(open_reader(folder.write("d.las", file.bytes()))->info().crs->epsg, 26910);
}

TEST(CrsOfLas, IsTheWktOnlyWhereTheHeaderSaysSo) {
  const TemporaryFolder folder;
  const std::vector<std::string> both{geotiff_vlr(projected(26911)), wkt_vlr(kUtm10)};
  EXPECT_EQ(open_reader(las_with(folder, "old.las", both))->info().crs->epsg, 26911);
  EXPECT_EQ(open_reader(las_with(folder, "new.las", both, 6))->info().crs->epsg, 26910);
}

TEST(CrsOfSeveralInputs, ThatDiffersIsRefusedInOneSentence) {
  const TemporaryFolder folder;
  const auto utm = las_with(folder, "utm.las", {geotiff_vlr(projected(26910))});
  const auto degrees = las_with(folder, "degrees.las", {wkt_vlr(kWgs84)}, 6);
  const std::string error = sentence_of<UsageError>([&] { InputCloud cloud({utm, degrees}); });
  for (const char* part : {"utm.las is in EPSG:26910", "degrees.las in EPSG:4326 (WGS 84)", "--ignore-crs"})
    EXPECT_NE(error.find(part), std::string::npos) << error;
}

TEST(CrsOfSeveralInputs, ThatDiffersIsMergedWithAWarningWhereAsked) {
  const TemporaryFolder folder;
  const auto utm = las_with(folder, "utm.las", {geotiff_vlr(projected(26910))});
  const auto degrees = las_with(folder, "degrees.las", {geotiff_vlr(geographic(4326))});
  std::vector<std::string> warnings;
  run_copy({utm, degrees}, folder / "out.las", &warnings, {.ignore_crs = true});
  EXPECT_TRUE(contains(warnings, "degrees.las (EPSG:4326) are merged without a transformation"));
  EXPECT_EQ(open_reader(folder / "out.las")->info().crs->epsg, 26910);
}

TEST(CrsOfSeveralInputs, ThatIsTheSameInTwoEncodingsIsAccepted) {
  const TemporaryFolder folder;
  const InputCloud cloud(
      {las_with(folder, "a.las", {geotiff_vlr(projected(26910))}), las_with(folder, "b.las", {wkt_vlr(kUtm10)}, 6)});
  EXPECT_TRUE(cloud.warnings().empty());
  EXPECT_EQ(cloud.crs()->epsg, 26910);
}

TEST(CrsOfSeveralInputs, OneWithoutIsNamedInAWarningAndTheOutputHasTheOthers) {
  const TemporaryFolder folder;
  const auto bare = las_with(folder, "bare.las", {});
  const auto utm = las_with(folder, "utm.las", {geotiff_vlr(projected(26910))});
  const auto text = folder.write("more.xyz", "1 2 3\n");
  std::vector<std::string> warnings;
  run_copy({bare, utm, text}, folder / "out.las", &warnings);
  EXPECT_TRUE(contains(warnings, "bare.las and 1 other input: no coordinate reference system is stated; EPSG:26910"));
  EXPECT_EQ(open_reader(folder / "out.las")->info().crs->epsg, 26910);
}

TEST(CrsOfSeveralInputs, ThatCannotBeComparedIsOneWarning) {
  const TemporaryFolder folder;
  const auto a = las_with(folder, "a.las", {wkt_vlr("PROJCS[\"mine\"]")}, 6);
  const auto b = las_with(folder, "b.las", {wkt_vlr("PROJCS[\"yours\"]")}, 6);
  const auto c = las_with(folder, "c.las", {wkt_vlr("PROJCS[\"theirs\"]")}, 6);
  const InputCloud cloud({a, b, c});
  ASSERT_EQ(cloud.warnings().size(), 1u);
  EXPECT_NE(cloud.warnings()[0].find("b.las and 1 other input ('yours') could not be compared"), std::string::npos)
      << cloud.warnings()[0];
}

TEST(CrsThroughPly, ComesBackToLasAsItWas) {
  const TemporaryFolder folder;
  std::string long_wkt = kUtm10;
  long_wkt.insert(long_wkt.size() - 1, ",REMARK[\"" + std::string(2500, ' ') + "x\"]");
  GeoTiffKeys keys{directory({1024, 0, 1, 1, 3072, 0, 1, 32767, 3080, 34736, 2, 0, 3073, 34737, 9, 0}),
                   {-123.00000000000001, 1.0 / 3},
                   std::string("50% off |\0\n", 11)};
  const std::vector<std::string> geotiff{vlr("LASF_Projection", 34735, bytes_of(keys.directory)),
                                         vlr("LASF_Projection", 34736, bytes_of(keys.doubles)),
                                         vlr("LASF_Projection", 34737, keys.ascii)};
  for (const auto& [vlrs, format] :
       {std::pair{std::vector{wkt_vlr(kUtm10)}, 6}, {std::vector{wkt_vlr(long_wkt)}, 6}, {geotiff, 1}}) {
    for (const char* name : {"in.las", "a.ply", "b.ply", "out.las"}) std::filesystem::remove(folder / name);
    const auto in = las_with(folder, "in.las", vlrs, format);
    std::vector<std::string> warnings;
    run_copy({in}, folder / "a.ply", &warnings);
    EXPECT_TRUE(warnings.empty());
    run_copy({folder / "a.ply"}, folder / "b.ply");
    EXPECT_EQ(contents(folder / "a.ply"), contents(folder / "b.ply"));
    run_copy({folder / "b.ply"}, folder / "out.las");
    const auto before = open_reader(in), after = open_reader(folder / "out.las");
    ASSERT_TRUE(after->info().crs.has_value());
    EXPECT_EQ(before->info().crs->wkt, after->info().crs->wkt);
    EXPECT_EQ(before->info().crs->geotiff, after->info().crs->geotiff);
  }
}

TEST(CrsThroughPly, LinesAreShortEnoughForOtherReaders) {
  const TemporaryFolder folder;
  std::string wkt = kUtm10;
  wkt.insert(wkt.size() - 1, ",REMARK[\"" + std::string(5000, 'x') + "\"]");
  run_copy({las_with(folder, "in.las", {wkt_vlr(wkt)}, 6)}, folder / "out.ply");
  std::size_t longest = 0, length = 0;
  const std::string ply = contents(folder / "out.ply");
  for (const char c : ply.substr(0, ply.find("end_header")))
    longest = std::max(longest, c == '\n' ? length : ++length), length = c == '\n' ? 0 : length;
  EXPECT_LE(longest, 1000u);
}

TEST(CrsThroughPly, CommentsThatAreNoWktStayComments) {
  const TemporaryFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\ncomment crs EPSG:2154\ncomment crs_geotiff_keys 1 x\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n1 2 3\n";
  const auto in = folder.write("in.ply", header);
  EXPECT_FALSE(open_reader(in)->info().crs.has_value());
  run_copy({in}, folder / "out.ply");
  EXPECT_NE(contents(folder / "out.ply").find("comment crs EPSG:2154\ncomment crs_geotiff_keys 1 x\n"),
            std::string::npos);
}

TEST(CrsOfText, IsLostWithAWarning) {
  const TemporaryFolder folder;
  const auto in = las_with(folder, "in.las", {geotiff_vlr(projected(26910))});
  for (const char* name : {"out.csv", "out.xyz", "out.pts"}) {
    std::vector<std::string> warnings;
    run_copy({in}, folder / name, &warnings);
    EXPECT_TRUE(contains(warnings, "text cannot hold the coordinate reference system, EPSG:26910")) << name;
  }
}

}  // namespace
}  // namespace pointsweep::crs_test
