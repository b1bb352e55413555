// SPDX-License-Identifier: MIT
/// `verify` of outputs in every format of the registry: a right output is "OK", and a value that is off by the smallest
/// step is found.
#include <fmt/format.h>

#include "pointsweep/program/formats.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class VerifyFormats : public Tool {
 protected:
  /// Writes two LAS tiles without a common grid, so that the merged records have float64 coordinates.
  VerifyFormats() {
    made("generate terrain a.ply -n 1500");
    made("generate terrain b.ply -n 1000 --seed 2");
    std::filesystem::create_directory(folder_ / "tiles");
    made("convert a.ply tiles/a.las --scale 0.01");
    made("convert b.ply tiles/b.las --scale 0.0025 --offset 12.3333,5.1,0.00037");
  }

  /// Runs a pipeline from the tiles into `output`, and expects that `verify` finds nothing wrong and nothing open.
  void accepted(const std::string& output, const std::string& pipeline, const std::string& options = "") {
    std::filesystem::remove_all(folder_ / output);
    if (output.ends_with("/")) std::filesystem::create_directory(folder_ / output);
    made(fmt::format("run tiles/ {} --pipeline '{}' {}", output, pipeline, options));
    const Result result =
        tool(fmt::format("verify tiles/ {} {}", output, with_what_csv_does_not_record(output, pipeline, options)));
    EXPECT_EQ(result.status, 0) << output << " " << pipeline << " " << options << "\n" << result.out << result.err;
  }

  /// Returns the options that `verify` needs for CSV files, which have no record of their run; "" for other files.
  static std::string with_what_csv_does_not_record(const std::string& output, const std::string& pipeline,
                                                   const std::string& options) {
    if (output.find(".csv") == std::string::npos && options.find(".csv") == std::string::npos) return "";
    const std::size_t at = options.find("--positions");
    return fmt::format("--pipeline '{}' {}", pipeline, at == std::string::npos ? "" : options.substr(at));
  }
};

TEST_F(VerifyFormats, OneOutputInEveryFormat) {
  for (const std::string_view extension : writable_extensions()) {
    accepted(fmt::format("one{}", extension), "knn(k=8) | normals");
    if (extension.find("la") == std::string_view::npos)
      accepted(fmt::format("single{}", extension), "knn(k=8) | normals", "--positions float32");
  }
}

/// The fewest digits that identify a float32 differ from it by up to half of its last place.
TEST_F(VerifyFormats, MovedPointsAsFloatsInText) {
  for (const char* output : {"moved.xyz", "moved.pts"})
    accepted(output, "transform(scale=1.0001, translate=[500000, 5000000, 0])", "--positions float32");
}

TEST_F(VerifyFormats, TilesInEveryFormatHaveTheStepsOfTheirOwnGrids) {
  for (const std::string_view extension : writable_extensions()) {
    const std::string format = fmt::format("--output-format {}", extension);
    accepted("out/", "knn(k=8) | normals", format);
    if (extension == ".copc.laz") continue;  // its rows are in no order, so verify cannot tell which rows were dropped
    accepted("out/", "knn(k=8) | normals | where(nz > 0.9)", format);
    if (extension.find("la") == std::string_view::npos)
      accepted("out/", "knn(k=8) | normals", format + " --positions float32");
  }
  for (const char* options : {"", "--scale 0.001", "--scale 0.07"})
    for (const char* pipeline : {"knn(k=8) | set(x = x + 0.0003) | normals", "knn(k=8) | set(x = x + 1, y = 2 * y)"})
      accepted("out/", pipeline, options);
}

TEST_F(VerifyFormats, OnePointOfATileThatIsOneStepAwayIsFound) {
  for (const char* extension : {".las", ".csv", ".e57"}) {
    for (const auto& [folder, pipeline] :
         {std::pair{"right", "set(x = x)"}, {"wrong", "set(x = x + 0.0025 where row == 2000)"}}) {
      std::filesystem::remove_all(folder_ / folder);
      std::filesystem::create_directory(folder_ / folder);
      made(fmt::format("run tiles/ {}/ --pipeline '{}' --output-format {} --no-provenance", folder, pipeline,
                       extension));
    }
    EXPECT_EQ(tool("verify tiles/ right/ --order input").status, 0) << extension;
    refused(1, "verify tiles/ wrong/ --order input", "row 2000: x is");
  }
}

/// Equal points cannot be told apart in an output in another order. One of the equal rows must have the computed
/// values.
TEST_F(VerifyFormats, EqualPointsInAnotherOrder) {
  made(
      "run b.ply twice.ply --pipeline 'set(x = 100 * floor(x / 100), y = 100 * floor(y / 100), z = 0, nx = 0, ny = 0, "
      "nz = 1)'");
  std::filesystem::create_directory(folder_ / "cells");
  for (const char* output : {"cells/", "out.copc.laz"}) {
    const std::string division = output[0] == 'c' ? "--tile 400" : "";
    made(fmt::format("run twice.ply {} --force --pipeline 'set(u = row)' {}", output, division));
    EXPECT_EQ(tool(fmt::format("verify twice.ply {}", output)).status, 0) << output;
    made(fmt::format("run twice.ply {} --force --pipeline 'set(u = row, u = row + 1000 where row == 77)' {}", output,
                     division));
    refused(1, fmt::format("verify twice.ply {} --pipeline 'set(u = row)'", output), "(row 77 of the input): u is");
  }
  made("run twice.ply flat.ply --pipeline 'set(x = 0, y = 0)'");
  made("run flat.ply out.copc.laz --force --pipeline 'set(u = row)'");
  const Result result = tool("verify flat.ply out.copc.laz");
  EXPECT_EQ(result.status, 3) << result.out;
  EXPECT_NE(result.out.find("the output has more than 64 points that equal each of them"), std::string::npos)
      << result.out;
}

}  // namespace
}  // namespace pointsweep
