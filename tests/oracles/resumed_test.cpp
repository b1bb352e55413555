// SPDX-License-Identifier: MIT
// Runs that were stopped and resumed, compared with the formulas.
#include <fmt/format.h>

#include "pointsweep/error.h"
#include "pointsweep/reader.h"
#include "tests/formats/temporary_folder.h"
#include "tests/oracles/clouds.h"
#include "tests/oracles/oracle.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

RunResult read_back(const std::filesystem::path& file) {
  const std::unique_ptr<Reader> reader = open_reader(file);
  RunResult result;
  result.schema = reader->info().schema;
  result.records.resize(reader->info().count * result.schema.stride);
  for (std::uint64_t row = 0; row < reader->info().count;)
    row += reader->read(row, std::span(result.records).subspan(row * result.schema.stride));
  return result;
}

TEST(OraclesOfResumedRuns, WhatWasStoppedSeveralTimesIsWhatTheFormulasSay) {
  const TemporaryFolder folder;
  std::string text;
  for (const Vec3& p : bumpy_surface(sized(2500), 18)) text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  folder.write("in.xyz", text);
  for (const char* pipeline :
       {"knn(k=10) | normals | curvature | splats", "knn(radius=0.1) | normals | neighborhood_size",
        "knn(k=12) | normals | splats | fair(f=3, g=3) | normals"}) {
    InputCloud cloud({folder / "in.xyz"});
    const Chain chain = build_chain(parse_pipeline(pipeline), cloud);
    const Outputs outputs{.points = folder / "out.ply", .arrays = {}, .writer = {}};
    EngineOptions options = streamed(cloud.count());
    options.overwrite = true;
    options.resume_folder = folder / "done";
    options.checkpoint_seconds = 0;
    int stops = 0;
    for (bool done = false; !done;) {
      int reports = 0;
      Watching watching([&](const Progress&) {
        if (++reports == 4 + stops) throw Cancelled();
      });
      options.observer = &watching;
      try {
        run(cloud, chain, outputs, options);
        done = true;
      } catch (const Cancelled&) {
        ++stops;
      }
    }
    EXPECT_GE(stops, 1) << pipeline;
    expect_right(Oracle(cloud, chain).compare(read_back(folder / "out.ply")), pipeline, 0.001);
  }
}

}  // namespace
}  // namespace pointsweep
