// SPDX-License-Identifier: MIT
/// Runs that are stopped and resumed give the bytes of uninterrupted runs, whenever they are stopped.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>

#include "pointsweep/error.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/support/reference_engine.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

struct Work {
  std::string name;
  std::string pipeline;
  std::string output = "out.ply";
  Order order = Order::input;
  std::vector<std::string> inputs = {"a.xyz", "b.xyz"};
  std::vector<std::string> keep = {};
  Nonfinite nonfinite = Nonfinite::by_format;
  std::string format = {};  ///< CloudOptions::format
};

class Resume : public testing::Test {
 protected:
  Resume() {
    std::vector<Vec3> points;
    for (const auto& [name, shape] : hostile_shapes()) {
      const bool surface = name == "closed surface", sparse = name == "outliers in a box a thousand times larger";
      const bool copies = name == "most at one place of a surface", nowhere = name == "some not finite";
      const std::size_t n = surface ? 1600 : sparse || nowhere ? 150 : copies ? 300 : 0;
      for (const Vec3& p : make_cloud(shape, n, 11)) points.push_back(p);
    }
    write("a.xyz", points, 0, points.size() / 3);
    write("b.xyz", points, points.size() / 3, points.size());
    std::erase_if(points, [](const Vec3& p) { return !is_finite(p); });
    write("finite.xyz", points, 0, points.size());
    std::vector<Vec3> bar;
    for (int i = 0; i < 4000; ++i) bar.push_back({i * 0.0025, i * 17 % 97 * 0.01, i * 29 % 199 * 0.01});
    write("bar.xyz", bar, 0, bar.size());
  }

  void write(const std::string& name, const std::vector<Vec3>& points, std::size_t begin, std::size_t end) const {
    std::string text;
    for (std::size_t i = begin; i < end; ++i) text += fmt::format("{} {} {}\n", points[i].x, points[i].y, points[i].z);
    folder_.write(name, text);
  }

  EngineOptions options(const Work& work) const {
    EngineOptions options;
    options.slab_points = 90;
    options.cell_points = 32;
    options.resources.threads = 2;
    options.resources.memory_bytes = 256 << 20;
    options.order = work.order;
    options.nonfinite = work.nonfinite;
    options.overwrite = true;
    options.resources.temp_folder = folder_.path();
    return options;
  }
  EngineOptions resuming(const Work& work) const {
    EngineOptions resuming = options(work);
    resuming.resume_folder = folder_ / "done";
    resuming.checkpoint_seconds = 0;
    return resuming;
  }

  Statistics run_all(const Work& work, const EngineOptions& options) const {
    std::vector<std::filesystem::path> inputs;
    for (const std::string& name : work.inputs) inputs.push_back(folder_ / name);
    InputCloud cloud(inputs, {.format = work.format});
    if (work.pipeline.empty()) return sort(cloud, folder_ / work.output, options, work.keep);
    if (work.pipeline != "neighbors")
      return run(cloud, build_chain(parse_pipeline(work.pipeline), cloud, work.keep), {folder_ / work.output, {}, {}},
                 options);
    const Chain graph{{.k = 9, .radius = 0.3}, {std::make_shared<NeighborRows>(9, cloud.count(), true)}};
    const Outputs arrays{{}, {{"neighbors", folder_ / work.output}, {"distances", folder_ / "distances.npy"}}, {}};
    return run(cloud, graph, arrays, options);
  }

  /// Runs until the `stop`-th report of progress. Returns the statistics if the run completes before, else nothing.
  /// Counts the reports in reports_.
  std::optional<Statistics> run_until(std::uint64_t stop, const Work& work, EngineOptions options) {
    reports_ = 0;
    Watching watching([&](const Progress&) {
      if (++reports_ == stop) throw Cancelled();
    });
    options.observer = &watching;
    try {
      return run_all(work, options);
    } catch (const Cancelled&) {
      EXPECT_TRUE(std::filesystem::exists(options.resume_folder / "checkpoint") || stop < 8);
      return std::nullopt;
    }
  }

  void expect_as_uninterrupted(const Work& work, const Statistics& got) {
    EXPECT_TRUE(contents(folder_ / work.output) == bytes_);
    std::filesystem::remove(folder_ / work.output);
    EXPECT_EQ(got.certified, whole_.certified);
    EXPECT_EQ(got.degenerate, whole_.degenerate);
    EXPECT_EQ(got.degenerate_results, whole_.degenerate_results);
    EXPECT_EQ(got.nonfinite, whole_.nonfinite);
    EXPECT_EQ(got.sweeps, whole_.sweeps);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "done"));
  }

  void run_uninterrupted(const Work& work) {
    whole_ = run_all(work, options(work));
    bytes_ = contents(folder_ / work.output);
    EXPECT_FALSE(bytes_.empty());
    std::filesystem::remove(folder_ / work.output);
  }

  TemporaryFolder folder_;
  Statistics whole_;
  std::string bytes_;
  std::uint64_t reports_ = 0;
};

const std::vector<Work>& works() {
  static const std::vector<Work> works = {
      {"normals", "knn(k=8) | normals"},
      {"normals in sweep order", "knn(k=8) | normals", "out.las", Order::sweep, {"finite.xyz"}},
      {"normals within a radius", "knn(radius=0.2) | normals", "out.csv"},
      {"neighbours and distances", "neighbors", "out.npy"},
      {"curvature and splats", "knn(k=6) | normals | curvature | splats"},
      {"fairing and new neighbourhoods", "normals | splats | fair(f=9, g=9) | reneighbor | normals"},
      {"fairing in sweep order", "normals | splats | fair(f=9, g=9) | resort | reneighbor | normals", "out.ply",
       Order::sweep},
      {"sort", "", "out.ply"},
      {"outliers left out", "knn(k=6) | sor(multiplier=1) | where(outlier == 0) | normals"},
      {"outliers left out in sweep order",
       "knn(k=6) | sor(multiplier=1) | where(outlier == 0) | normals",
       "out.las",
       Order::sweep,
       {"finite.xyz"}},
      {"equal points and others left out", "unique | where(z > 0.1) | normals | where(nz > 0 || x < 0.5) | sor"},
      {"thinned", "decimate(0.9) | voxel(0.02) | normals | voxel(0.1, keep=hash) | sor"},
      {"thinned by disks", "poisson(0.02) | neighborhood_size | poisson(0.3, radius_from=neighbor_radius) | normals"},
      {"simplified", "knn(k=9) | normals | curvature | simplify(0.002, most=0.3) | reneighbor | normals"},
      {"ground", "normals | ground(cell=0.1, window=0.3) | where(classification == 2) | sor"},
      {"heights above ground", "ground(cell=0.1, window=0.3) | height(k=2) | where(height < 1) | normals"},
      {"components", "knn(k=3) | normals | components | where(component_size > 50) | normals"},
      {"segments", "knn(k=6) | normals | segments(angle=30) | where(segment_size > 5) | sor"},
      {"oriented normals", "knn(k=6) | normals | orient | reneighbor(radius=0.1) | dbscan(eps=0.1) | curvature"},
      {"components at the end", "knn(k=2) | components", "out.las"},
      {"ground at the end", "ground(cell=0.05, window=0.2)", "out.las"},
      {"thinned in sweep order", "normals | voxel(0.05)", "out.las", Order::sweep, {"finite.xyz"}},
      {"fairing of the finite points",
       "normals | splats | fair(f=9, g=9) | reneighbor | normals",
       "out.ply",
       Order::input,
       {"a.xyz", "b.xyz"},
       {},
       Nonfinite::drop},
      {"normals of the finite points in sweep order", "normals", "out.las", Order::sweep},
      {"sort of the finite points", "", "out.las"},
      {"a part of the normals in sweep order", "normals", "out.ply", Order::sweep, {"a.xyz", "b.xyz"}, {"nx"}},
  };
  return works;
}

/// A run that writes checkpoints and is not stopped also has the bytes of a run without checkpoints.
TEST_F(Resume, StoppedAnywhereARunGoesOnToTheSameBytes) {
  for (const Work& work : works()) {
    run_uninterrupted(work);
    const std::optional<Statistics> with_checkpoints = run_until(0, work, resuming(work));
    ASSERT_TRUE(with_checkpoints) << work.name;
    expect_as_uninterrupted(work, *with_checkpoints);
    const std::uint64_t all = reports_;
    for (std::uint64_t stop = 2; stop <= all; stop += 1 + all / 3) {
      SCOPED_TRACE(fmt::format("{}, stopped at report {} of {}", work.name, stop, all));
      EXPECT_FALSE(run_until(stop, work, resuming(work)));
      EngineOptions other = resuming(work);
      other.resources.threads = 3;
      other.resources.memory_bytes = 200 << 20;
      other.checkpoint_seconds = 30;
      expect_as_uninterrupted(work, run_all(work, other));
      if (HasFailure()) return;
    }
  }
}

/// The run is stopped at the first and at the last report of every phase. The remaining rows of the bar are longest
/// along another axis than all rows, and the output states the axis.
TEST_F(Resume, StoppedInAnyPhaseARunWithSelectsAndValuesGoesOn) {
  const std::string values = "knn(k=6) | unique | sor(multiplier=1) | where(outlier == 0) | normals | sor";
  for (const Work& work : {Work{"selects and values", values, "out.ply", Order::input},
                           Work{"selects and values in sweep order", values, "out.ply", Order::sweep},
                           Work{"a slice of a bar", "where(x < 1) | normals", "out.ply", Order::sweep, {"bar.xyz"}}}) {
    run_uninterrupted(work);
    std::vector<std::uint64_t> stops;
    std::uint64_t reports = 0;
    std::string phase;
    EngineOptions counting = options(work);
    Watching watching([&](const Progress& progress) {
      ++reports;
      if (phase != progress.phase && reports > 1) stops.insert(stops.end(), {reports - 1, reports});
      phase = progress.phase;
    });
    counting.observer = &watching;
    counting.resume_folder = folder_ / "done";
    counting.checkpoint_seconds = 0;
    run_all(work, counting);
    EXPECT_GE(stops.size(), work.pipeline == values ? 2u * 6 : 2u * 3);
    for (const std::uint64_t stop : stops) {
      SCOPED_TRACE(fmt::format("{}, stopped at report {} of {}", work.name, stop, reports));
      // A checkpoint waits until the one before is on the disk, so the last report may not come.
      EXPECT_TRUE(!run_until(stop, work, resuming(work)) || stop + 2 > reports);
      expect_as_uninterrupted(work, run_all(work, resuming(work)));
      if (HasFailure()) return;
    }
  }
}

TEST_F(Resume, StoppedAgainAndAgainARunComesToItsEnd) {
  for (const Work& work : works()) {
    SCOPED_TRACE(work.name);
    run_uninterrupted(work);
    std::optional<Statistics> done;
    std::uint64_t processes = 0;
    while (!done && processes < 50) {
      ++processes;
      done = run_until(7 * processes, work, resuming(work));
    }
    EXPECT_GT(processes, 2u);
    ASSERT_TRUE(done);
    expect_as_uninterrupted(work, *done);
  }
}

TEST_F(Resume, DoesNotRepeatWhatWasDone) {
  const Work work = works().front();
  run_uninterrupted(work);
  run_until(0, work, resuming(work));
  const std::uint64_t all = reports_;
  EXPECT_FALSE(run_until(all * 2 / 3, work, resuming(work)));
  run_until(0, work, resuming(work));
  EXPECT_LT(reports_, all / 2);
}

/// Steps read the results of earlier steps around a point. So a resumed sweep reads several slabs again.
TEST_F(Resume, DoesNotLeaveWhatLiesAroundItsBeginToTheRecall) {
  const Work work = works()[4];
  run_uninterrupted(work);
  run_until(0, work, resuming(work));
  const std::uint64_t all = reports_;
  EXPECT_FALSE(run_until(all / 2, work, resuming(work)));
  const Statistics resumed = run_all(work, resuming(work));
  EXPECT_LT(resumed.recalled, whole_.recalled + resumed.points / 20);
  expect_as_uninterrupted(work, resumed);
}

/// A run was stopped. The next run differs, and must not continue it.
class Refused : public Resume {
 protected:
  Refused() { run_until(15, work_, resuming(work_)); }
  /// Returns the sentence with which the next run is refused.
  std::string sentence(const Work& work, const EngineOptions& options) {
    return sentence_of<Error>([&] { run_all(work, options); });
  }
  std::string sentence(const Work& work) { return sentence(work, resuming(work)); }
  /// Expects that the checkpoints still exist, and that the right run continues them.
  ~Refused() override {
    run_uninterrupted(work_);
    expect_as_uninterrupted(work_, run_all(work_, resuming(work_)));
  }
  Work work_ = works().front();
};

TEST_F(Refused, IfAnInputIsAnother) {
  Work other = work_;
  std::swap(other.inputs[0], other.inputs[1]);
  EXPECT_NE(sentence(other).find("holds another run: there it is input '"), std::string::npos) << sentence(other);
}

TEST_F(Refused, IfTheOutputIsAnother) {
  Work other = work_;
  other.output = "other.ply";
  EXPECT_NE(sentence(other).find("other.ply"), std::string::npos) << sentence(other);
}

TEST_F(Refused, IfThePipelineIsAnother) {
  Work other = work_;
  other.pipeline = "knn(k=9) | normals";
  EXPECT_NE(sentence(other).find("remove the folder"), std::string::npos) << sentence(other);
}

TEST_F(Refused, IfAnyOptionOfAStageIsAnother) {
  for (const char* pipeline : {"knn(k=8) | normals(orient=up)", "knn(k=8, radius=50) | normals",
                               "knn(k=8, adaptive=eigenentropy, k_min=3) | normals", "knn(k=8, k_from=x) | normals",
                               "knn(k=8, radius_from=x) | normals"}) {
    Work other = work_;
    other.pipeline = pipeline;
    EXPECT_NE(sentence(other).find("there it is pipeline knn(k=8) | normals(orient=none), here pipeline "),
              std::string::npos)
        << pipeline << "\n"
        << sentence(other);
  }
}

/// Makes the number of neighbours times a factor that is no option of the operator.
class Counted final : public LocalOperator {
 public:
  explicit Counted(double factor) : factor_(factor) {}
  std::string name() const override { return "counted"; }
  Contract contract() const override { return {{}, {}, {scalar("counted", Type::f64, "1", "")}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) out.column<double>(0)[i] = factor_ * static_cast<double>(in.count(i));
  }

 private:
  Options own_options() const override { return {{"factor", factor_}}; }
  double factor_;
};

TEST_F(Resume, IsRefusedToChainsMadeByHandThatDifferInAnOption) {
  const auto op = [](auto made) { return std::vector<ChainStage>{std::move(made)}; };
  const auto normals = [&](NormalsOptions options) { return op(std::make_shared<Normals>(options)); };
  const std::pair<Chain, Chain> pairs[] = {
      {{{.k = 8}, normals({})}, {{.k = 8}, normals({Orient::up, {}})}},
      {{{.k = 8}, normals({Orient::viewpoint, Vec3{0, 0, 1}})},
       {{.k = 8}, normals({Orient::viewpoint, Vec3{0, 0, 2}})}},
      {{{.k = 8}, op(std::make_shared<Counted>(1))}, {{.k = 8}, op(std::make_shared<Counted>(2))}},
  };
  const EngineOptions options = resuming(works().front());
  for (const auto& [first, second] : pairs) {
    const auto run_chain = [&](const Chain& chain, std::uint64_t stop) {
      InputCloud cloud({folder_ / "a.xyz", folder_ / "b.xyz"});
      EngineOptions stopping = options;
      std::uint64_t reports = 0;
      Watching watching([&](const Progress&) {
        if (++reports == stop) throw Cancelled();
      });
      stopping.observer = &watching;
      run(cloud, chain, {folder_ / "out.ply", {}, {}}, stopping);
    };
    EXPECT_THROW(run_chain(first, 15), Cancelled);
    const std::string refused = sentence_of<Error>([&] { run_chain(second, 0); });
    EXPECT_NE(refused.find("holds another run: there it is pipeline"), std::string::npos) << refused;
    run_chain(first, 0);
  }
}

TEST_F(Refused, IfOtherFieldsAreKept) {
  Work other = work_;
  other.keep = {"nx"};
  EXPECT_NE(sentence(other).find("made fields left out: ny nz"), std::string::npos) << sentence(other);
}

TEST_F(Refused, IfOrderOrAxisAreOthers) {
  Work other = work_;
  other.order = Order::sweep;
  EXPECT_NE(sentence(other).find("order sweep"), std::string::npos) << sentence(other);
  EngineOptions options = resuming(work_);
  options.axis = 1;
  EXPECT_NE(sentence(work_, options).find("axis y"), std::string::npos) << sentence(work_, options);
}

TEST_F(Refused, IfNamesTypesOrPointsOfTheOutputAreOthers) {
  EngineOptions prefix = resuming(work_), positions = prefix, nonfinite = prefix;
  prefix.prefix = "p_";
  positions.positions = Type::f32;
  nonfinite.nonfinite = Nonfinite::keep;
  for (const EngineOptions& other : {prefix, positions, nonfinite})
    EXPECT_NE(sentence(work_, other).find("holds another run"), std::string::npos) << sentence(work_, other);
}

TEST_F(Resume, RefusesMovedPositionsOfAnotherType) {
  Work work = works().front();
  work.pipeline = "normals | splats | fair(f=9, g=9)";
  EXPECT_FALSE(run_until(15, work, resuming(work)));
  EngineOptions other = resuming(work);
  other.positions = Type::f32;
  const std::string sentence = sentence_of<Error>([&] { run_all(work, other); });
  EXPECT_NE(sentence.find("there it is positions by default, here positions float32;"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("remove the folder"), std::string::npos) << sentence;
  run_uninterrupted(work);
  expect_as_uninterrupted(work, run_all(work, resuming(work)));
}

TEST_F(Refused, IfTheColumnsOfTheTextAreOthers) {
  Work other = work_;
  other.format = "text:y,x,z";
  EXPECT_NE(sentence(other).find("read as text:y,x,z"), std::string::npos) << sentence(other);
}

TEST_F(Resume, RefusesAnInputThatWasWrittenTo) {
  const Work work = works().front();
  EXPECT_FALSE(run_until(15, work, resuming(work)));
  folder_.write("a.xyz", contents(folder_ / "a.xyz") + "1 2 3\n");
  const std::string sentence = sentence_of<Error>([&] { run_all(work, resuming(work)); });
  EXPECT_NE(sentence.find("a.xyz"), std::string::npos) << sentence;
}

TEST_F(Resume, RefusesAnInputThatHasAsManyPointsAsBeforeButOthers) {
  const Work work = works().front();
  const std::filesystem::path input = folder_ / "a.xyz";
  std::string text = contents(input);
  EXPECT_FALSE(run_until(15, work, resuming(work)));
  const auto digit = text.find_last_of("012345678");
  ++text[digit];
  const auto before = std::filesystem::last_write_time(input);
  folder_.write("a.xyz", text);
  std::filesystem::last_write_time(input, before + std::chrono::seconds(1));  // more than a tick of the clock
  const std::string sentence = sentence_of<Error>([&] { run_all(work, resuming(work)); });
  EXPECT_NE(sentence.find("a.xyz"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("remove the folder"), std::string::npos) << sentence;
}

TEST_F(Resume, RefusesPolygonsThatWereWrittenTo) {
  const std::string file = (folder_ / "area.wkt").string(), area = "POLYGON ((-99 -99, 99 -99, 0 99, -99 -99))";
  Work work = works().front();
  work.pipeline = "knn(k=8) | crop(polygon='" + file + "') | normals";
  folder_.write("area.wkt", area);
  EXPECT_FALSE(run_until(15, work, resuming(work)));
  folder_.write("area.wkt", area + "\n");
  const std::string sentence = sentence_of<Error>([&] { run_all(work, resuming(work)); });
  EXPECT_NE(sentence.find("holds another run: there it is pipeline"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("checksum="), std::string::npos) << sentence;
  folder_.write("area.wkt", area);
  run_uninterrupted(work);
  expect_as_uninterrupted(work, run_all(work, resuming(work)));
}

TEST_F(Resume, RefusesAFolderOfOtherThings) {
  std::filesystem::create_directory(folder_ / "done");
  folder_.write("done/thesis.tex", "years of work");
  const Work work = works().front();
  const std::string sentence = sentence_of<Error>([&] { run_all(work, resuming(work)); });
  EXPECT_NE(sentence.find("thesis.tex"), std::string::npos) << sentence;
  EXPECT_EQ(contents(folder_ / "done/thesis.tex"), "years of work");
}

TEST_F(Resume, RefusesADamagedCheckpoint) {
  const Work work = works().front();
  EXPECT_FALSE(run_until(15, work, resuming(work)));
  const std::string right = contents(folder_ / "done/checkpoint");
  for (const std::size_t at : {std::size_t{3}, std::size_t{20}, right.size() / 2, right.size() - 1}) {
    std::string wrong = right;
    wrong[at] = static_cast<char>(wrong[at] ^ 1);
    folder_.write("done/checkpoint", wrong);
    const std::string sentence = sentence_of<Error>([&] { run_all(work, resuming(work)); });
    EXPECT_NE(sentence.find("damaged"), std::string::npos) << sentence;
  }
  folder_.write("done/checkpoint", right.substr(0, 10));
  EXPECT_NE(sentence_of<Error>([&] { run_all(work, resuming(work)); }).find("damaged"), std::string::npos);
}

TEST_F(Resume, RefusesSpilledDataThatAreShorterThanTheCheckpointSays) {
  const Work work = works().front();
  EXPECT_FALSE(run_until(15, work, resuming(work)));
  std::filesystem::resize_file(folder_ / "done/stream-0", 100);
  const std::string sentence = sentence_of<Error>([&] { run_all(work, resuming(work)); });
  EXPECT_NE(sentence.find("stream-0"), std::string::npos) << sentence;
}

TEST_F(Resume, RefusesAFolderInWhichAnotherRunIsWorking) {
  const Work work = works().front();
  EngineOptions first = resuming(work);
  std::string sentence;
  Watching watching([&](const Progress& p) {
    if (sentence.empty() && std::string(p.phase) == "sweeping")
      sentence = sentence_of<Error>([&] { run_all(work, resuming(work)); });
  });
  first.observer = &watching;
  run_uninterrupted(work);
  expect_as_uninterrupted(work, run_all(work, first));
  EXPECT_NE(sentence.find("another run is working"), std::string::npos) << sentence;
}

TEST_F(Resume, IsRefusedWhereARunCannotBeResumed) {
  const Work work = works().front();
  EngineOptions by_reference = resuming(work);
  by_reference.engine = Engine::reference;
  EXPECT_THROW(run_all(work, by_reference), UsageError);
  EngineOptions half_way = resuming(work);
  half_way.half_way_states = folder_ / "states.npy";
  EXPECT_THROW(run_all(work, half_way), UsageError);
  const std::vector<double> xyz(300);
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<ArrayReader>(std::span(xyz)));
  InputCloud in_memory(std::move(readers));
  const Chain chain = build_chain(parse_pipeline("normals"), in_memory);
  EXPECT_THROW(run(in_memory, chain, {folder_ / "out.ply", {}, {}}, resuming(work)), Error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "done"));
}

TEST_F(Resume, AFailureBeforeTheFirstCheckpointLeavesNoFolder) {
  Work work = works().front();
  work.output = "no/such/folder.ply";
  sentence_of<Error>([&] { run_all(work, resuming(work)); });
  EXPECT_FALSE(std::filesystem::exists(folder_ / "done"));
}

}  // namespace
}  // namespace pointsweep
