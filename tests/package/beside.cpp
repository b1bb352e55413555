// SPDX-License-Identifier: MIT
/// A program outside of the source tree that generates a cloud, inspects a file, checks the result of a run, draws it
/// and writes its report.
#include <pointsweep/info.h>
#include <pointsweep/pointsweep.h>
#include <pointsweep/program/generate.h>
#include <pointsweep/program/report.h>
#include <pointsweep/verify.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

using namespace pointsweep;

int main(int argc, char** argv) try {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".", in = folder / "plane.ply",
                              out = folder / "normals.ply";
  Cloud points(generated_points("sphere", {.count = 3000}));
  Chain copy;
  copy.keep = {"x", "y", "z"};
  run(points, copy, {.points = in}, {.overwrite = true});
  Cloud cloud({in});
  RunSummary made;
  made.statistics = run(cloud, parse_chain("knn(k=8) | normals", cloud), {.points = out}, {.overwrite = true});

  const FileSummary summary = summarize(*open_reader(out));
  const bool is_seen =
      summary.info.count == 3000 && summary.bounds.hi.x <= 1 && summary.density() && *summary.spacing() < 0.1;
  const Verdict verdict = verify({}, out, {.sample = 100});
  const bool is_right = verdict.same() && verdict.is_complete() && verdict.made == std::vector<std::string>{"normal"};
  std::printf("%s", to_text(verdict).c_str());
  Cloud result({out});
  made.picture = render(result, {.width = 300, .height = 200, .color = "normal"});
  const bool is_shown = made.picture->drawn == 3000 && report_of(made).find("data:image/png") != std::string::npos;
  return is_seen && is_right && is_shown ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
