// SPDX-License-Identifier: MIT
#include "pointsweep/formats/provenance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "pointsweep/writer.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using testing::ElementsAre;
using Lines = std::vector<std::string>;

ProvenanceRecord example() {
  return {.version = "1.2.3",
          .stages = {"knn(k=8)", "normals"},
          .settings = {{"order", "sweep"}, {"keep", "k1,k2"}},
          .inputs = {{" 100%\n\xc3\xa4.ply ", 7, 99}, {"/b c/d.las", 8, 100}}};
}

TEST(ProvenanceLines, AreReadBackWhateverTheNames) {
  const Lines lines = lines_of(example());
  for (const std::string& line : lines) {
    EXPECT_EQ(provenance_line("  " + line + "\r\n"), line);
    EXPECT_LT(line.size(), 1000u);
  }
  const auto records = records_of(lines);
  ASSERT_EQ(records.size(), 1u);
  const ProvenanceRecord &read = records[0], written = example();
  EXPECT_EQ(read.version, written.version);
  EXPECT_EQ(read.stages, written.stages);
  EXPECT_EQ(read.settings, written.settings);
  ASSERT_EQ(read.inputs.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.inputs[i].name, written.inputs[i].name);
    EXPECT_EQ(read.inputs[i].points, written.inputs[i].points);
    EXPECT_EQ(read.inputs[i].bytes, written.inputs[i].bytes);
  }
  EXPECT_EQ(
      to_text(read),
      "pointsweep 1.2.3: knn(k=8) | normals; order sweep; keep k1,k2; from %20100%25%0A%C3%A4.ply%20, /b c/d.las");
}

/// Returns a record whose stage and setting are longer than a line, a VLR and an unsigned number of 16 bits.
ProvenanceRecord long_record() {
  ProvenanceRecord record = example();
  std::string polygon = "crop(polygon='POLYGON((";
  for (int i = 0; i < 9000; ++i)
    polygon += std::to_string(i) + (i % 7 == 0 ? "   " : " ") + std::to_string(i * i) + ", ";
  record.stages = {"knn(k=8)", polygon + "))')", "normals"};
  record.settings = {{"keep", std::string(2000, ' ') + std::string(5000, '%')}, {"order", "sweep"}};
  return record;
}

TEST(ProvenanceLines, GoOnWhereAStageOrSettingIsLong) {
  const ProvenanceRecord record = long_record();
  const Lines lines = lines_of(record);
  for (const std::string& line : lines) EXPECT_EQ(provenance_line("  " + line + "\r\n"), line);
  const auto records = records_of(lines);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].stages, record.stages);
  EXPECT_EQ(records[0].settings, record.settings);
  EXPECT_EQ(records[0].inputs.size(), record.inputs.size());
  const std::string whole = "pointsweep stage " + std::string(20'000, 'a');  // of a version that did not divide lines
  EXPECT_EQ(provenance_line(whole), whole);
  EXPECT_EQ(provenance_line("pointsweep stage " + std::string(70'000, 'a')), std::nullopt);
  EXPECT_TRUE(records_of(Lines{"pointsweep 1.2.3", "pointsweep + goes on from nothing"})[0].stages.empty());
}

TEST(ProvenanceLines, OfAPathThatIsTooLongHoldTheNameAlone) {
  ProvenanceRecord record = example();
  record.inputs = {{std::string(2000, 'a') + "/scan.ply", 1, 2}};
  EXPECT_EQ(lines_of(record).back(), "pointsweep input 1 points, 2 bytes: scan.ply");
}

TEST(ProvenanceLines, OfVeryManyInputsCountTheRest) {
  ProvenanceRecord record = example();
  record.inputs.assign(5000, {"tile_with_a_name_of_some_length.las", 1000, 34000});
  const Lines lines = lines_of(record);
  std::size_t bytes = 0;
  for (const std::string& line : lines) bytes += line.size();
  EXPECT_LT(bytes, 40000u);
  const auto read = records_of(lines);
  EXPECT_EQ(read[0].inputs.size() + read[0].more_inputs, 5000u);
}

TEST(ProvenanceLines, ThatMakeNoSenseAreIgnored) {
  EXPECT_FALSE(provenance_line("made by pointsweep 1"));
  EXPECT_FALSE(provenance_line("pointsweep 1 \x01"));
  EXPECT_FALSE(provenance_line(""));
  const Lines lines = {"pointsweep rocks",
                       "pointsweep ",
                       "pointsweep 1",
                       "pointsweep input 3 points: a",
                       "pointsweep stage",
                       "pointsweep input 99999999999999999999999 points, 1 bytes: a",
                       "pointsweep input 1 points, 2 bytes: "};
  for (const ProvenanceRecord& record : records_of(lines)) {
    EXPECT_TRUE(record.inputs.empty());
    EXPECT_TRUE(record.stages.empty());
    EXPECT_FALSE(to_text(record).empty());
  }
  EXPECT_TRUE(records_of({}).empty());
}

TEST(ProvenanceLines, OfManyFilesStayInsideWhatHeadersMayHold) {
  Lines lines;
  for (int file = 0; file < 5000; ++file)
    add_provenance(lines,
                   Lines{"pointsweep 1", "pointsweep input 1 points, 2 bytes: tile_" + std::to_string(file) + ".las"});
  std::size_t bytes = 0;
  for (const std::string& line : lines) bytes += line.size() + 10;
  EXPECT_LT(bytes, std::size_t{1} << 20);
  EXPECT_EQ(lines.back(), "pointsweep note more records are left out");
  EXPECT_EQ(lines[1], "pointsweep input 1 points, 2 bytes: tile_0.las");
}

class ProvenanceOfFiles : public testing::Test {
 protected:
  void write(const std::string& name, const Lines& provenance, std::shared_ptr<const FormatExtras> extras = nullptr) {
    OutputPlan plan;
    plan.path = folder_ / name;
    for (const char* axis : {"x", "y", "z"}) plan.schema.append(axis, Type::f64);
    plan.schema.append("height_above_ground", Type::f32);
    plan.count = 2;
    plan.bounds = Box{{0, 0, 0}, {1, 1, 1}};
    plan.provenance = provenance;
    plan.extras = std::move(extras);
    plan.overwrite = true;
    const auto writer = create_writer(plan);
    writer->write(std::vector<std::byte>(2 * plan.schema.stride));
    writer->finish();
  }

  TemporaryFolder folder_;
};

TEST_F(ProvenanceOfFiles, ComesBackFromEveryFormatThatHoldsIt) {
  const Lines lines = lines_of(example());
  for (const char* name : {"a.ply", "a.las", "a.xyz", "a.txt", "a.asc", "a.pts"}) {
    write(name, lines);
    const auto reader = open_reader(folder_ / name);
    EXPECT_EQ(reader->info().provenance, lines) << name;
    EXPECT_EQ(reader->info().count, 2u) << name;
    EXPECT_TRUE(reader->info().schema.find("height_above_ground")) << name;
    EXPECT_TRUE(reader->info().warnings.empty()) << name;
  }
  write("a.csv", lines);
  EXPECT_TRUE(open_reader(folder_ / "a.csv")->info().provenance.empty());
}

TEST_F(ProvenanceOfFiles, MayBeLong) {
  const Lines lines = lines_of(long_record());
  for (const char* name : {"a.ply", "a.las", "a.txt", "a.pcd"}) {
    write(name, lines);
    const auto reader = open_reader(folder_ / name);
    EXPECT_EQ(reader->info().provenance, lines) << name;
    EXPECT_EQ(reader->info().count, 2u) << name;
  }
}

TEST_F(ProvenanceOfFiles, FillsAsManyVlrsAsItNeeds) {
  Lines lines;
  for (int i = 0; i < 3000; ++i) lines.push_back("pointsweep note " + std::to_string(i) + std::string(50, '.'));
  write("a.las", lines);
  const auto reader = open_reader(folder_ / "a.las");
  EXPECT_EQ(reader->info().provenance, lines);
  EXPECT_TRUE(reader->info().warnings.empty());
}

TEST_F(ProvenanceOfFiles, OfTheInputIsNotWrittenTwice) {
  for (const char* name : {"a.ply", "a.las"}) {
    Lines lines = {"pointsweep 1", "pointsweep stage sort"};
    write(name, lines);
    lines.insert(lines.end(), {"pointsweep 2", "pointsweep stage normals"});
    for (int pass = 0; pass < 3; ++pass) {
      const auto first = open_reader(folder_ / name);
      write(std::string("again_") + name, lines, first->info().extras);
      EXPECT_EQ(open_reader(folder_ / (std::string("again_") + name))->info().provenance, lines);
    }
  }
}

TEST_F(ProvenanceOfFiles, ThatNamesColumnsIsNotTakenForTheHeaderOfAText) {
  write("a.xyz", {"pointsweep 1", "pointsweep keep a,x,y,z", "pointsweep keep x y z a"});
  EXPECT_TRUE(open_reader(folder_ / "a.xyz")->info().schema.find("height_above_ground"));
}

}  // namespace
}  // namespace pointsweep
