// SPDX-License-Identifier: MIT
/// An outside program that looks at a file and checks the result of a run over it.
#include <pointsweep/info.h>
#include <pointsweep/pointsweep.h>
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
  std::vector<double> xyz;
  for (int i = 0; i < 3000; ++i) xyz.insert(xyz.end(), {double(i % 50), double(i / 50), double(i % 7) / 100});
  Cloud points(std::make_unique<ArrayReader>(xyz));
  run(points, parse_chain("decimate(1)", points), {.points = in}, {.overwrite = true});
  Cloud cloud({in});
  run(cloud, parse_chain("knn(k=8) | normals", cloud), {.points = out}, {.overwrite = true});

  const FileSummary summary = summarize(*open_reader(out));
  const bool is_seen =
      summary.info.count == 3000 && summary.bounds.hi.x == 49 && summary.density() && *summary.spacing() < 1.01;
  const Verdict verdict = verify({}, out, {.sample = 100});
  const bool is_right = verdict.same() && verdict.is_complete() && verdict.made == std::vector<std::string>{"normal"};
  std::printf("%s", to_text(verdict).c_str());
  return is_seen && is_right ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
