// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/engine_run.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using testing::Contains;
using testing::ElementsAre;

class Provenance : public Tool {
 protected:
  Provenance() {
    EXPECT_EQ(tool("generate statue in.ply -n 3000").status, 0);
    EXPECT_EQ(tool("generate statue more.las -n 1000 --seed 2").status, 0);
  }

  /// Returns the lines of the record in a file, without their prefixes.
  std::vector<std::string> said(const std::string& name) {
    const std::string all = contents(folder_ / name);
    std::vector<std::string> lines;
    for (std::size_t at = 0; (at = all.find("pointsweep ", at)) != all.npos; ++at)
      lines.push_back(all.substr(at + 11, all.find('\n', at) - at - 11));
    return lines;
  }
  std::string size_of(const std::string& name) { return std::to_string(std::filesystem::file_size(folder_ / name)); }
  std::string input_line(const std::string& name, int points) {
    return "input " + std::to_string(points) + " points, " + size_of(name) + " bytes: " + name;
  }
};

TEST_F(Provenance, OfPlyAndTextIsInCommentsWithPipelineOptionsAndInputs) {
  ASSERT_EQ(tool("normals in.ply more.las -o out.ply -k 12 --orient up").status, 0);
  EXPECT_THAT(said("out.ply"), ElementsAre("0.1.0", "stage knn(k=12)", "stage normals(orient=up)",
                                           input_line("in.ply", 3000), input_line("more.las", 1000)));
  for (const char* name : {"out.xyz", "out.pts", "out.asc", "out.txt"}) {
    ASSERT_EQ(
        tool(std::string("run in.ply ") + name + " --pipeline 'normals|splats' --keep normal --order sweep").status, 0);
    EXPECT_THAT(said(name), ElementsAre("0.1.0", "stage knn(k=16)", "stage normals", "stage splats", "keep normal",
                                        "order sweep", "axis z", input_line("in.ply", 3000)));
    EXPECT_NE(tool(std::string("info ") + name).out.find("points      3000"), std::string::npos);
  }
  ASSERT_EQ(tool("sort in.ply out.csv").status, 0);
  EXPECT_TRUE(said("out.csv").empty());
  EXPECT_TRUE(contents(folder_ / "out.csv").starts_with("x,y,z"));
}

TEST_F(Provenance, OfLasIsAVlrOfTheUserPointsweep) {
  ASSERT_EQ(tool("sort in.ply out.las --axis x").status, 0);
  const std::string las = contents(folder_ / "out.las");
  const std::size_t user = las.find("pointsweep", 375);
  ASSERT_EQ(las.substr(user + 10, 8), std::string("\0\0\0\0\0\0\1\0", 8)) << "padded to 16 bytes, then record 1";
  const std::string text =
      "pointsweep 0.1.0\npointsweep stage sort\npointsweep axis x\npointsweep " + input_line("in.ply", 3000) + "\n";
  EXPECT_EQ(las.substr(user - 2 + 54, text.size()), text);
  EXPECT_EQ(static_cast<unsigned char>(las[user + 18]) + 256 * static_cast<unsigned char>(las[user + 19]), text.size());
}

TEST_F(Provenance, TellsEveryOptionThatDecidesWhatIsWritten) {
  std::string rows = "# x y z curvature\nnan 0 0 5\n";
  for (int i = 0; i < 40; ++i)
    rows += std::to_string(i % 7) + " " + std::to_string(i / 7) + " " + std::to_string(0.01 * (i % 3)) + " 5\n";
  write("lost.xyz", rows);
  for (const auto& [run, line] : std::vector<std::pair<std::string, std::string>>{
           {"fair in.ply out.ply --positions float32", "positions float32"},
           {"normals in.ply out.ply --prefix p_", "prefix p_"},
           {"curvature lost.xyz out.ply --replace curvature", "replace curvature"},
           {"normals lost.xyz out.ply --nonfinite drop", "nonfinite drop"},
           {"normals in.ply out.ply --order sweep --axis x", "axis x"},
           {"run in.ply out.ply --pipeline 'knn(k=20) | normals | splats | fair | reneighbor(k=8) | normals'",
            "stage reneighbor(k=8)"}}) {
    ASSERT_EQ(tool(run + " -f").status, 0) << run;
    EXPECT_THAT(said("out.ply"), Contains(line)) << run;
    const Result result = tool("verify out.ply --sample 20");
    const bool unchecked = run.find("reneighbor") != std::string::npos;  // the second normals are not checked
    EXPECT_EQ(result.status, unchecked ? 3 : 0) << run << "\n" << result.out << result.err;
  }
}

TEST_F(Provenance, DoesNotTellThreadsMemoryFoldersOrTheWayTheOptionsWereGiven) {
  const std::string plain = made("run in.ply out.ply --pipeline 'normals | splats | fair' --order sweep", "out.ply");
  std::filesystem::create_directory(folder_ / "sub");
  std::filesystem::copy_file(folder_ / "in.ply", folder_ / "sub/in.ply");
  write("chain.json",
        "[{\"type\": \"knn\", \"k\": 64}, {\"type\": \"normals\", \"orient\": \"none\"}, {\"type\": \"splats\"},"
        " {\"type\": \"fair\", \"g\": 0.50, \"f\": 5e-1}]");
  const std::string twice = "--order sweep -f --pipeline ";
  for (const std::string& other :
       {"sub/in.ply out.ply " + twice + "'knn(k=064) | normals(orient=none) | splats(axes=auto) | fair(g=0.500)'",
        "in.ply out.ply " + twice + "chain.json",
        "in.ply -o out.ply --threads 1 --memory 200M --axis z " + twice + "'normals|splats|fair'",
        "in.ply sub/out.ply --quiet --stats s.json --resume there " + twice + "'normals|splats|fair'"}) {
    const std::string file = other.find("sub/out") != other.npos ? "sub/out.ply" : "out.ply";
    EXPECT_EQ(made("run " + other, file), plain) << other;
  }
  EXPECT_EQ(made("splats in.ply a.las -k 12 --keep normal,splat_axis", "a.las"),
            made("splats in.ply b.las --keep splat_axis,normal -k 12 --threads 1", "b.las"));
}

TEST_F(Provenance, OfASecondPassIsAddedBehindTheFirst) {
  for (const std::string first : {"ply", "las", "xyz"}) {
    for (const std::string second : {"ply", "las", "xyz"}) {
      const std::string a = "first." + first, b = "second." + second, c = "third." + second;
      ASSERT_EQ(tool("normals in.ply " + a + " -f").status, 0);
      ASSERT_EQ(tool("curvature " + a + " " + b + " -f --keep k1").status, 0);
      ASSERT_EQ(tool("sort " + b + " " + c + " -f").status, 0);
      EXPECT_THAT(said(c), ElementsAre("0.1.0", "stage knn(k=16)", "stage normals", input_line("in.ply", 3000),  //
                                       "0.1.0", "stage knn(k=32)", "stage normals", "stage curvature", "keep k1",
                                       input_line(a, 3000), "0.1.0", "stage sort", "axis z", input_line(b, 3000)))
          << first << " " << second;
    }
  }
}

TEST_F(Provenance, OfSeveralInputsIsAllKept) {
  ASSERT_EQ(tool("sort in.ply a.las").status, 0);
  ASSERT_EQ(tool("sort more.las b.las --axis x").status, 0);
  ASSERT_EQ(tool("sort a.las b.las -o both.las --no-provenance").status, 0);
  EXPECT_THAT(said("both.las"), ElementsAre("0.1.0", "stage sort", "axis z", input_line("in.ply", 3000), "0.1.0",
                                            "stage sort", "axis x", input_line("more.las", 1000)));
}

TEST_F(Provenance, IsLeftOutOrHasPathsOnRequest) {
  ASSERT_EQ(tool("normals in.ply out.ply --no-provenance").status, 0);
  EXPECT_TRUE(said("out.ply").empty());
  ASSERT_EQ(tool("normals in.ply out.ply -f --provenance paths").status, 0);
  EXPECT_EQ(said("out.ply").back().substr(said("out.ply").back().find(": ")),
            ": " + (std::filesystem::canonical(folder_) / "in.ply").string());
  refused(2, "normals in.ply out.ply -f --provenance dates", "'dates' is not names or paths");
}

TEST_F(Provenance, NamesOfAnyBytesStayOneLineOfAscii) {
  const std::string name = " a\nb \xc3\xa4%41.ply";
  std::filesystem::copy_file(folder_ / "in.ply", folder_ / name);
  ASSERT_EQ(tool("normals \"$(printf ' a\\nb \\303\\244%%41.ply')\" out.ply").status, 0);
  EXPECT_TRUE(said("out.ply").back().ends_with(": %20a%0Ab %C3%A4%2541.ply")) << said("out.ply").back();
  EXPECT_EQ(tool("verify out.ply --sample 20").status, 0);
}

TEST_F(Provenance, IsAllThatVerifyNeeds) {
  for (const std::string run :
       {"normals in.ply out.ply -k 5 --orient viewpoint --viewpoint 1,2,3",
        "normals in.ply out.las -k 5 --order sweep --axis x", "sort in.ply out.xyz", "fair in.ply out.ply",
        "splats in.ply more.las -o out.ply --prefix p_ --radius 0.05",
        "curvature in.ply more.las -o out.las -k 20 --keep k1", "normals in.ply out.ply --provenance paths"}) {
    ASSERT_EQ(tool(run + " -f").status, 0) << run;
    const std::string out = run.find("out.ply") != run.npos   ? "out.ply"
                            : run.find("out.las") != run.npos ? "out.las"
                                                              : "out.xyz";
    const Result result = tool("verify --sample 100 " + out);
    EXPECT_EQ(result.status, 0) << run << "\n" << result.out << result.err;
    const bool sampled = run.starts_with("sort") || result.out.find("100 of ") != result.out.npos;
    EXPECT_TRUE(sampled) << run << "\n" << result.out;
  }
}

TEST_F(Provenance, LetsVerifyLookInTheFolderOfTheOutputAndInItsOwn) {
  std::filesystem::create_directory(folder_ / "sub");
  ASSERT_EQ(tool("normals in.ply sub/out.ply").status, 0);
  EXPECT_EQ(tool("verify sub/out.ply --sample 10").status, 0);
  std::filesystem::rename(folder_ / "in.ply", folder_ / "sub/in.ply");
  EXPECT_EQ(tool("verify sub/out.ply --sample 10").status, 0);
  std::filesystem::resize_file(folder_ / "sub/in.ply", 100);
  refused(1, "verify sub/out.ply", "has changed since");
  std::filesystem::remove(folder_ / "sub/in.ply");
  refused(1, "verify sub/out.ply", "'in.ply', which is neither in its folder nor in this one");
  refused(2, "verify more.las", "does not say how it was made");
}

/// An operator that the tool does not know.
class Height final : public LocalOperator {
 public:
  std::string name() const override { return "height"; }
  Contract contract() const override { return {{}, {}, {scalar("height", Type::f64, "length", "")}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) out.column<double>(0)[i] = in.position(i).z + above_;
  }

 private:
  Options own_options() const override { return {{"above", above_}}; }
  double above_ = 0.25;
};

TEST_F(Provenance, OfARunOfTheLibraryIsThatOfTheTool) {
  InputCloud cloud({folder_ / "in.ply"});
  const Chain normals{{.k = 12}, {std::make_shared<Normals>(NormalsOptions{Orient::viewpoint, Vec3{0, 0, 1.7}})}};
  run(cloud, normals, {.points = folder_ / "library.ply", .arrays = {}, .writer = {}});
  EXPECT_EQ(made("normals in.ply tool.ply -k 12 --orient viewpoint --viewpoint 0,0,1.7", "tool.ply"),
            contents(folder_ / "library.ply"));
}

TEST_F(Provenance, NamesOperatorsOfTheUserWithTheirOptions) {
  InputCloud cloud({folder_ / "in.ply"});
  const Chain chain{{.k = 9}, {std::make_shared<Normals>(), std::make_shared<Height>()}};
  run(cloud, chain, {.points = folder_ / "out.ply", .arrays = {}, .writer = {}});
  EXPECT_THAT(said("out.ply"), ElementsAre("0.1.0", "stage knn(k=9)", "stage normals", "stage height(above=0.25)",
                                           input_line("in.ply", 3000)));
  refused(2, "verify out.ply", "'knn(k=9) | normals | height(above=0.25)', of which not all operators are known here");
  const Result verified = tool("verify in.ply out.ply -k 9 --sample 100");
  EXPECT_EQ(verified.status, 3) << "the height of the user's operator is not checked\n" << verified.err;
}

TEST_F(Provenance, NamesNeighborhoodsOnlyWhereNeighborsAreSearched) {
  ASSERT_EQ(tool("run in.ply out.ply --pipeline 'knn(k=5) | where(x > 0) | set(w = 2)'").status, 0);
  EXPECT_THAT(said("out.ply"),
              ElementsAre("0.1.0", "stage where(\"x > 0\")", "stage set(\"w = 2\")", input_line("in.ply", 3000)));
  EXPECT_EQ(tool("verify out.ply").status, 0) << tool("verify out.ply").err;
  ASSERT_EQ(tool("run in.ply out.ply -f --pipeline 'knn(k=5) | where(x > 0) | neighborhood_size'").status, 0);
  EXPECT_THAT(said("out.ply"), ElementsAre("0.1.0", "stage knn(k=5)", "stage where(\"x > 0\")",
                                           "stage neighborhood_size", input_line("in.ply", 3000)));
}

TEST_F(Provenance, IsPrintedByInfoOldestFirst) {
  ASSERT_EQ(tool("normals in.ply more.las -o first.las -k 12 --orient up").status, 0);
  for (const std::string out : {"out.ply", "out.las", "out.xyz"}) {
    ASSERT_EQ(tool("sort first.las " + out + " --keep nx").status, 0);
    EXPECT_NE(tool("info " + out)
                  .out.find("  made by     pointsweep 0.1.0: knn(k=12) | normals(orient=up); from in.ply, more.las\n"
                            "  made by     pointsweep 0.1.0: sort; keep nx; axis z; from first.las\n"),
              std::string::npos)
        << tool("info " + out).out;
    const auto records = nlohmann::json::parse(tool("info --json " + out).out)["files"][0]["provenance"];
    ASSERT_EQ(records.size(), 2u);
    EXPECT_EQ(records[0]["stages"], nlohmann::json({"knn(k=12)", "normals(orient=up)"}));
    EXPECT_EQ(records[0]["inputs"][1]["name"], "more.las");
    EXPECT_EQ(records[0]["inputs"][1]["points"], 1000);
    EXPECT_EQ(records[1]["version"], "0.1.0");
    EXPECT_EQ(records[1]["settings"], nlohmann::json({{"keep", "nx"}, {"axis", "z"}}));
    EXPECT_EQ(records[1]["more_inputs"], 0);
  }
  EXPECT_EQ(tool("info more.las").out.find("made by"), std::string::npos);
  EXPECT_TRUE(nlohmann::json::parse(tool("info --json more.las").out)["files"][0]["provenance"].empty());
}

TEST_F(Provenance, IsPrintedInPrintableCharactersWhateverAFileHolds) {
  write("odd.ply",
        "ply\nformat ascii 1.0\ncomment pointsweep 0.1.0\ncomment pointsweep stage %1B[31mred%0Aline\n"
        "comment pointsweep keep %FF\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n1 2 3\n");
  const std::string out = tool("info odd.ply").out;
  EXPECT_NE(out.find("made by     pointsweep 0.1.0: %1B[31mred%0Aline; keep %FF\n"), std::string::npos) << out;
  EXPECT_EQ(tool("info --json odd.ply").status, 0);
}

TEST_F(Provenance, OfALongPipelineIsShortenedInTextAndWholeInJson) {
  std::string polygon = "POLYGON((";
  for (int i = 0; i < 9000; ++i) polygon += std::to_string(i) + " " + std::to_string(i * i) + ",";
  write("chain.json", "{\"pipeline\": [{\"type\": \"crop\", \"polygon\": \"" + polygon + "0 0))\"}]}");
  made("generate sphere sphere.ply -n 2000");
  made("run sphere.ply out.las --pipeline chain.json --quiet");
  const std::string text = tool("info out.las").out, json = tool("info --json out.las").out;
  EXPECT_LT(text.size(), 6000u);
  EXPECT_NE(text.find(" characters] "), std::string::npos);
  EXPECT_NE(json.find(polygon.substr(90'000)), std::string::npos);
  EXPECT_EQ(tool("verify out.las").status, 0);
}

TEST_F(Provenance, FindsAnOutputThatIsNotWhatItSays) {
  ASSERT_EQ(tool("normals in.ply out.ply -k 5").status, 0);
  std::string bytes = contents(folder_ / "out.ply");
  const std::size_t at = bytes.find("knn(k=5)");
  ASSERT_NE(at, bytes.npos);
  bytes[at + 6] = '6';
  write("out.ply", bytes);
  refused(1, "verify out.ply", "by brute force");
}

}  // namespace
}  // namespace pointsweep
