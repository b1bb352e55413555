// SPDX-License-Identifier: MIT
/// A program outside of the source tree that uses the installed package: an own reader, operator, writer and observer,
/// the built-in operators by function, by name and as text, files, and errors. The program checks the results.
#include <pointsweep/pointsweep.h>
#include <pointsweep/program/nearest_names.h>
#include <pointsweep/program/quantities.h>
#include <pointsweep/program/run_options.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace {

int failures = 0;

void expect(bool right, const char* what) {
  if (right) return;
  std::fprintf(stderr, "wrong: %s\n", what);
  ++failures;
}

constexpr std::uint64_t kSide = 60;

/// A plane with a step at every tenth row of points.
class Terrace final : public pointsweep::Reader {
 public:
  Terrace() {
    info_.path = "terrace";
    info_.format = "terrace";
    for (const char* name : {"x", "y", "z"}) info_.schema.append(name, pointsweep::Type::f32);
    info_.count = kSide * kSide;
  }
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = rows_for(row, records);
    for (std::size_t i = 0; i < rows; ++i) {
      const auto x = static_cast<float>((row + i) % kSide), y = static_cast<float>((row + i) / kSide);
      const std::array<float, 3> p{x, y, std::floor(y / 10)};
      std::memcpy(records.data() + i * sizeof p, p.data(), sizeof p);
    }
    return rows;
  }
};

/// Makes the height of the highest neighbour above the point.
class Rise final : public pointsweep::PointOperator {
 public:
  std::string name() const override { return "rise"; }
  pointsweep::Contract contract() const override {
    return {
        .makes = {pointsweep::scalar("rise", pointsweep::Type::f32, "length", "highest neighbour above the point")}};
  }

 protected:
  void apply_to(std::size_t i, const pointsweep::Neighborhoods& in, pointsweep::Columns& out) const override {
    double rise = 0;
    for (std::size_t j = 0; j < in.count(i); ++j) rise = std::max(rise, in.offset(i, j).z);
    if (in.count(i) == 0) out.mark_degenerate(i);
    out.column<float>(0)[i] = static_cast<float>(rise);
  }
};

class Counter final : public pointsweep::Observer {
 public:
  void on_progress(const pointsweep::Progress&) override { ++reports; }
  int reports = 0;
};

class Sink final : public pointsweep::Writer {
 public:
  explicit Sink(std::size_t& bytes) : bytes_(bytes) {}
  void write(std::span<const std::byte> records) override { bytes_ += records.size(); }
  void finish() override {}

 private:
  std::size_t& bytes_;
};

void run_own_parts() {
  using namespace pointsweep;
  Cloud cloud(std::make_unique<Terrace>());
  const Chain chain{.neighborhood = {.k = 8}, .stages = {operators::normals(), std::make_shared<Rise>()}};
  std::vector<float> rise(cloud.count());
  std::size_t bytes = 0;
  Outputs outputs;
  outputs.writer = [&](const OutputPlan& plan) {
    return std::make_unique<ArrayWriter<float>>(plan, std::vector<std::string>{"rise"}, std::span(rise));
  };
  Counter counter;
  RunOptions options;
  options.resources = {.memory_bytes = 64 << 20, .threads = 1};
  options.observer = &counter;
  const Statistics statistics = run(cloud, chain, outputs, options);
  expect(statistics.certified == kSide * kSide, "all points certified");
  expect(counter.reports > 0, "the observer hears of progress");
  expect(rise[5 * kSide + 30] == 0 && rise[9 * kSide + 30] == 1, "the rise beside and away from a step");
  expect(to_json(statistics).find("\"certified\"") != std::string::npos, "statistics as JSON");
  outputs.writer = [&](const OutputPlan&) { return std::make_unique<Sink>(bytes); };
  run(cloud, chain, outputs);
  expect(bytes == kSide * kSide * (3 + 3 + 1) * sizeof(float), "positions, normals and the rise in a record");
}

void run_pipelines(const std::filesystem::path& folder) {
  using namespace pointsweep;
  Cloud terrace(std::make_unique<Terrace>());
  const std::filesystem::path sorted = folder / "sorted.ply", kept = folder / "kept.ply";
  sort(terrace, sorted, {.axis = 0, .overwrite = true});
  Cloud cloud({sorted});
  Chain chain = parse_chain("knn(k=12) | normals(orient=up)", cloud);
  append_stages(chain, "curvature", cloud);
  append_stage(chain, "where", {{"condition", std::string("nz > 0.999")}}, cloud);
  expect(plan_text(cloud, chain, {.points = kept}).find("curvature") != std::string::npos, "the plan names the stages");
  const Statistics statistics = run(cloud, chain, {.points = kept}, {.overwrite = true});
  Cloud result({kept});
  expect(result.count() == statistics.points_written && result.count() < cloud.count(), "flat points alone are left");
  expect(result.schema().find("nz").has_value(), "the output has the normals");
}

void refuse_what_is_wrong() {
  using namespace pointsweep;
  Cloud cloud(std::make_unique<Terrace>());
  try {
    parse_chain("knn(k=8) | flatten", cloud);
    expect(false, "an unknown operator is refused");
  } catch (const UsageError& error) {
    expect(std::string(error.what()).find("flatten") != std::string::npos, "the error names the operator");
  }
  try {
    open_reader("no such file.ply");
    expect(false, "a missing file is refused");
  } catch (const Error&) {
  }
  try {
    run(cloud, parse_chain("normals", cloud), {.points = "never.ply"}, {.engine = Engine::reference});
    expect(false, "an engine that is not linked is refused");
  } catch (const UsageError&) {
  }
  expect(parse_size("memory", "256M") == std::uint64_t{256} << 20, "sizes are read as the tool reads them");
  expect(run_option("temp_folder").flag == "--temp-dir", "options of runs are known by name");
  expect(probable_name("normls", {"curvature", "normals"}) == "normals", "a misspelt word has a probable meaning");
  Counter counter;
  counter.cancel();
  try {
    std::size_t bytes = 0;
    Outputs outputs;
    outputs.writer = [&](const OutputPlan&) { return std::make_unique<Sink>(bytes); };
    RunOptions options;
    options.observer = &counter;
    run(cloud, parse_chain("normals", cloud), outputs, options);
    expect(false, "a cancelled run ends");
  } catch (const Cancelled&) {
  }
}

}  // namespace

int main(int argc, char** argv) try {
  run_own_parts();
  run_pipelines(argc > 1 ? argv[1] : ".");
  refuse_what_is_wrong();
  if (failures == 0) std::puts("pointsweep is installed");
  return failures == 0 ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
