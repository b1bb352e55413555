// SPDX-License-Identifier: MIT
// array_calls normals|neighbors XYZ.f64 OUT K THREADS: one call of the library on an N×3 array of doubles in memory,
// for script/bench binding. Prints wall and CPU seconds of the call as JSON, and writes the normals or the distances as
// raw bytes.
#include <sys/resource.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/pointsweep.h"

namespace {

using namespace pointsweep;

std::vector<double> doubles_of(const char* path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::vector<double> values(static_cast<std::size_t>(file.tellg()) / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(double)));
  return values;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// CPU seconds of this process so far, in its own code and in the system.
struct Cpu {
  double user, system;
  static Cpu now() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return {seconds(usage.ru_utime), seconds(usage.ru_stime)};
  }
};

/// A writer that passes all records to two writers.
class Both final : public Writer {
 public:
  Both(std::unique_ptr<Writer> a, std::unique_ptr<Writer> b) : a_(std::move(a)), b_(std::move(b)) {}
  void write(std::span<const std::byte> records) override {
    a_->write(records);
    b_->write(records);
  }
  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override {
    a_->write_at(row, records);
    b_->write_at(row, records);
  }
  void finish() override {
    a_->finish();
    b_->finish();
  }

 private:
  std::unique_ptr<Writer> a_, b_;
};

std::vector<std::string> numbered(const std::string& name, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back(name + "_" + std::to_string(i));
  return names;
}

struct Answers {
  std::vector<float> normals;
  std::vector<std::uint32_t> rows;
  std::vector<double> distances;
};

void find_normals(Cloud& cloud, std::size_t k, const RunOptions& options, Answers& answers) {
  answers.normals.resize(3 * cloud.count());
  Outputs outputs;
  outputs.writer = [&](const OutputPlan& plan) {
    return std::make_unique<ArrayWriter<float>>(plan, std::vector<std::string>{"nx", "ny", "nz"},
                                                std::span(answers.normals));
  };
  run(cloud, {.neighborhood = {.k = k}, .stages = {operators::normals()}}, outputs, options);
}

void find_neighbors(Cloud& cloud, std::size_t k, const RunOptions& options, Answers& answers) {
  answers.rows.resize(k * cloud.count());
  answers.distances.resize(k * cloud.count());
  Outputs outputs;
  outputs.writer = [&](const OutputPlan& plan) {
    return std::make_unique<Both>(
        std::make_unique<ArrayWriter<std::uint32_t>>(plan, numbered("neighbor", k), std::span(answers.rows)),
        std::make_unique<ArrayWriter<double>>(plan, numbered("distance", k), std::span(answers.distances)));
  };
  const Chain chain{.neighborhood = {.k = k},
                    .stages = {operators::neighbors(k, cloud.count(), true)},
                    .keep = {"neighbors", "distances", "x"}};
  run(cloud, chain, outputs, options);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 6) return std::fputs("array_calls normals|neighbors XYZ.f64 OUT K THREADS\n", stderr), 2;
  const std::string task = argv[1];
  const std::vector<double> xyz = doubles_of(argv[2]);
  const std::size_t k = std::stoul(argv[4]);
  RunOptions options;
  options.resources.threads = static_cast<unsigned>(std::stoul(argv[5]));
  Answers answers;

  const Cpu before = Cpu::now();
  const auto begin = std::chrono::steady_clock::now();
  Cloud cloud(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  (task == "normals" ? find_normals : find_neighbors)(cloud, k, options, answers);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Cpu after = Cpu::now();
  const double user = after.user - before.user, system = after.system - before.system;
  std::printf("{\"wall_seconds\": %.6f, \"user_seconds\": %.6f, \"cpu_seconds\": %.6f}\n", wall, user, user + system);

  const auto bytes =
      task == "normals" ? std::as_bytes(std::span(answers.normals)) : std::as_bytes(std::span(answers.distances));
  std::ofstream(argv[3], std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
