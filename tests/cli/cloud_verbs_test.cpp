// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

/// The verbs that run over a whole cloud, seen from the shell. What they compute is tested with the library.
class CloudVerbs : public Tool {
 protected:
  CloudVerbs() {
    EXPECT_EQ(tool("generate statue in.ply -n 4000 --noise 0.002").status, 0);
    EXPECT_EQ(tool("generate statue more.ply -n 1000 --seed 2").status, 0);
  }
};

TEST_F(CloudVerbs, EveryOptionOfNormalsThatSpeaksOfValuesChangesThem) {
  const std::string plain = made("normals in.ply out.ply --no-provenance", "out.ply");
  for (const char* option : {"-k 12", "--radius 0.05", "--orient up", "--orient viewpoint --viewpoint 3,0,0",
                             "--orient input", "--order sweep"})
    EXPECT_NE(made(std::string("normals in.ply out.ply --no-provenance --force ") + option, "out.ply"), plain)
        << option;
  EXPECT_NE(made("normals in.ply out.ply --no-provenance --force --radius 0.05", "out.ply"),
            made("normals in.ply out.ply --no-provenance --force -k 8 --radius 0.05", "out.ply"));
  EXPECT_NE(made("normals in.ply out.ply --no-provenance --force --order sweep", "out.ply"),
            made("normals in.ply out.ply --no-provenance --force --order sweep --axis x", "out.ply"));
  EXPECT_NE(made("normals in.ply out.ply --no-provenance --force --orient viewpoint --viewpoint 3,0,0", "out.ply"),
            made("normals in.ply out.ply --no-provenance --force --orient viewpoint --viewpoint -3,0,0", "out.ply"));
}

TEST_F(CloudVerbs, OptionsThatSpeakOfTheMachineDoNotChangeNormals) {
  const std::string plain = made("normals in.ply out.ply", "out.ply");
  for (const char* option : {"--memory 200M", "--threads 1", "--threads 3", "--temp-dir .", "--axis y", "--quiet",
                             "-k 16", "--orient none", "--order input"})
    EXPECT_EQ(made(std::string("normals in.ply out.ply --force ") + option, "out.ply"), plain) << option;
}

TEST_F(CloudVerbs, SeveralInputsAreOneCloud) {
  made("normals in.ply more.ply both.ply", "both.ply");
  EXPECT_NE(tool("info both.ply").out.find("points      5000"), std::string::npos);
}

TEST_F(CloudVerbs, NeighborsAreANumpyArrayAndEveryOptionChangesIt) {
  const std::string plain = made("neighbors in.ply out.npy", "out.npy");
  EXPECT_TRUE(plain.starts_with("\x93NUMPY"));
  EXPECT_NE(plain.find("'shape': (4000, 16)"), std::string::npos);
  EXPECT_NE(made("neighbors in.ply out.npy --force -k 3", "out.npy").find("(4000, 3)"), std::string::npos);
  EXPECT_NE(made("neighbors in.ply out.npy --force -k 1 --distances d.npy", "out.npy").find("(4000, 1)"),
            std::string::npos);
  EXPECT_NE(contents(folder_ / "d.npy").find("(4000, 1)"), std::string::npos);
  EXPECT_EQ(tool("verify in.ply out.npy").status, 0);
  EXPECT_EQ(tool("verify in.ply d.npy").status, 0);
  std::filesystem::remove(folder_ / "d.npy");
  EXPECT_NE(made("neighbors in.ply out.npy --force -k 30 --adaptive eigenentropy", "out.npy"),
            made("neighbors in.ply all.npy -k 30", "all.npy"));
  EXPECT_EQ(tool("verify in.ply out.npy -k 30 --adaptive eigenentropy --sample 500").status, 0);
  EXPECT_NE(made("neighbors in.ply out.npy --force --radius 0.03", "out.npy"), plain);
  EXPECT_EQ(made("neighbors in.ply out.npy --force --distances d.npy", "out.npy"), plain);
  EXPECT_NE(contents(folder_ / "d.npy").find("'<f8'"), std::string::npos);
}

TEST_F(CloudVerbs, SortFollowsTheAxis) {
  EXPECT_NE(made("sort in.ply x.ply --no-provenance --axis x", "x.ply"),
            made("sort in.ply z.ply --no-provenance --axis z", "z.ply"));
  EXPECT_EQ(made("sort in.ply auto.ply --no-provenance", "auto.ply"), contents(folder_ / "z.ply"))
      << "the statue is highest";
}

TEST_F(CloudVerbs, StatisticsAreJsonAndSayHowManyThreadsAndHowMuchMemory) {
  ASSERT_EQ(tool("normals in.ply out.ply --stats s.json --threads 1 --memory 300M -k 5").status, 0);
  const auto stats = nlohmann::json::parse(contents(folder_ / "s.json"));
  EXPECT_EQ(stats["points"], 4000);
  EXPECT_EQ(stats["certified"], 4000);
  EXPECT_EQ(stats["k"], 5);
  EXPECT_EQ(stats["threads"], 1);
  EXPECT_EQ(stats["memory_budget_bytes"], 300u << 20);
}

TEST_F(CloudVerbs, FewerThreadsWorkThanTheBudgetHasNoRoomForAndALineSaysSo) {
  for (const char* verb : {"run in.ply out.ply -f --no-provenance --pipeline 'knn(k=12) | normals | orient'",
                           "normals in.ply out.ply -f --no-provenance -k 80"}) {
    const std::string all = made(verb + std::string(" --threads 2"), "out.ply");
    const std::string refusal = tool(verb + std::string(" --memory 1M --threads 64")).err;
    const std::size_t at = refusal.find("give --memory ");
    ASSERT_NE(at, std::string::npos) << refusal;
    const std::string least = refusal.substr(at + 14, refusal.find('M', at + 14) - at - 13);
    const std::string few = verb + (" --threads 64 --memory " + least);
    const Result result = tool(few + " --stats s.json");
    EXPECT_EQ(result.status, 0) << few << result.err;
    EXPECT_NE(result.err.find(" of 64 threads work: a memory budget of "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("note: "), std::string::npos) << result.err;
    EXPECT_EQ(contents(folder_ / "out.ply"), all);
    EXPECT_LT(nlohmann::json::parse(contents(folder_ / "s.json"))["threads"], 64);
    EXPECT_NE(made(few + " --dry-run", ".out").find("note          "), std::string::npos);
  }
}

TEST_F(CloudVerbs, NothingThatExistsIsReplacedUnlessForced) {
  for (const char* name : {"out.ply", "out.npy", "s.json", "d.npy"}) write(name, "precious");
  refused(1, "normals in.ply out.ply", "out.ply");
  refused(1, "sort in.ply out.ply", "out.ply");
  refused(1, "neighbors in.ply out.npy", "out.npy");
  refused(1, "neighbors in.ply new.npy --distances d.npy", "d.npy");
  refused(1, "normals in.ply new.ply --stats s.json", "s.json");
  for (const char* name : {"out.ply", "out.npy", "s.json", "d.npy"}) EXPECT_EQ(contents(folder_ / name), "precious");
  EXPECT_FALSE(exists("new.ply"));
  EXPECT_FALSE(exists("new.npy"));
}

TEST_F(CloudVerbs, ADryRunIsRefusedForOutputsForWhichTheRunIsRefused) {
  const auto error = [](const Result& result) { return result.err.substr(result.err.find("error: ")); };
  for (const std::string command :
       {"normals in.ply in.ply --force", "normals in.ply more.ply in.ply", "normals in.ply out.unknown",
        "normals in.ply out", "normals in.ply out.npy", "sort in.ply out.unknown", "sort in.ply in.ply"}) {
    const Result run = tool(command), dry = tool(command + " --dry-run");
    EXPECT_EQ(run.status, 2) << command;
    EXPECT_EQ(dry.status, 2) << command;
    EXPECT_EQ(error(dry), error(run)) << command;
  }
}

TEST_F(CloudVerbs, ProgressNamesThePhases) {
  ASSERT_EQ(tool("normals in.ply out.ply --progress-fd 9 9>progress").status, 0);
  const std::string progress = contents(folder_ / "progress");
  for (const char* phase : {"ordering", "sweeping", "writing"})
    EXPECT_NE(progress.find(phase), std::string::npos) << phase;
}

}  // namespace
}  // namespace pointsweep
