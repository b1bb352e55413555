// SPDX-License-Identifier: MIT
/// Every pass over the input decodes it on all threads, whatever the passes before have left out or made; and the bytes
/// of the output are the same for any number of threads.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>

#include "tests/pipeline/in_memory.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kWavyRows = 200000;

/// Where decoders wait for each other: the first that comes in a phase of the run waits for a second.
class Meeting {
 public:
  void enter() {
    std::unique_lock lock(mutex_);
    Seen& seen = seen_[phase_];
    seen.most = std::max(seen.most, ++inside_);
    changed_.notify_all();
    if (seen.most < 2 && !seen.missed)
      seen.missed = !changed_.wait_for(lock, std::chrono::seconds(5), [&] { return seen.most >= 2; });
    --inside_;
  }
  void begin(const std::string& phase) {
    const std::lock_guard lock(mutex_);
    phase_ = phase;
  }
  /// The number of decoders seen at once, by phase.
  std::map<std::string, int> phases() const {
    std::map<std::string, int> all;
    for (const auto& [phase, seen] : seen_) all[phase] = seen.most;
    return all;
  }

 private:
  struct Seen {
    int most = 0;
    bool missed = false;
  };
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string phase_;
  std::map<std::string, Seen> seen_;
  int inside_ = 0;
};

/// A hilly square, as records of x, y, z and intensity. Its rows come in chunks of `chunk_rows`, or in any range if
/// that is 0; `lost` rows have no place.
class WavyReader final : public Reader {
 public:
  WavyReader(Meeting* meeting, std::uint64_t chunk_rows, std::uint64_t lost = 0)
      : meeting_(meeting), chunk_rows_(chunk_rows), lost_(lost) {
    for (const char* field : {"x", "y", "z", "intensity"}) info_.schema.append(field, Type::f64);
    info_.path = "waves";
    info_.count = kWavyRows;
  }
  bool has_decoders() const override { return true; }
  bool decodes_any_range() const override { return chunk_rows_ == 0; }
  Chunk chunk_of(std::uint64_t row) const override {
    if (chunk_rows_ == 0) return Reader::chunk_of(row);
    const std::uint64_t first = row / chunk_rows_ * chunk_rows_;
    return {first, std::min(chunk_rows_, kWavyRows - first), 0, 0, std::nullopt};
  }
  std::unique_ptr<RowDecoder> decoder(const WantedFields&) const override { return std::make_unique<Decoder>(*this); }

 private:
  class Decoder final : public RowDecoder {
   public:
    explicit Decoder(const WavyReader& reader) : reader_(reader) {}
    std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
      const std::size_t rows = reader_.rows_for(row, records);
      if (reader_.meeting_ != nullptr) reader_.meeting_->enter();
      for (std::size_t i = 0; i < rows; ++i) {
        const auto n = static_cast<double>(row + i);
        const double x = std::fmod(n * 0.754877666, 1), y = std::fmod(n * 0.569840291, 1);
        const bool lost = reader_.lost_ != 0 && (row + i) * 2654435761 % kWavyRows < reader_.lost_;
        const double values[] = {x, lost ? std::nan("") : y, 0.1 * std::sin(9 * x) * std::cos(7 * y),
                                 std::fmod(n, 100)};
        std::memcpy(records.data() + i * sizeof values, values, sizeof values);
      }
      return rows;
    }

   private:
    const WavyReader& reader_;
  };

  Meeting* meeting_;
  std::uint64_t chunk_rows_, lost_;
};

InputCloud wavy_square(Meeting* meeting, std::uint64_t chunk_rows, std::uint64_t lost = 0) {
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<WavyReader>(meeting, chunk_rows, lost));
  return InputCloud(std::move(readers));
}

/// The number of decoders at work at once, by phase of a run over a cloud with rows that have no place.
std::map<std::string, int> decoders_by_phase(const std::string& pipeline, std::uint64_t chunk_rows,
                                             EngineOptions options) {
  Meeting meeting;
  Watching observer([&](const Progress& p) { meeting.begin(p.phase); });
  options.resources.threads = 2;
  options.resources.memory_bytes = 1 << 30;
  options.observer = &observer;
  InputCloud cloud = wavy_square(&meeting, chunk_rows, 1000);
  run_in_memory(cloud, chain_of_any_cloud(pipeline), options);
  return meeting.phases();
}

TEST(AllThreads, DecodeTheInputInEveryPass) {
  const std::map<std::string, std::vector<std::string>> phases_that_decode_all = {
      {"where(intensity < 90) | normals", {"updating", "ordering", "writing"}},
      {"sor | where(intensity < 90) | normals", {"updating", "ordering", "writing"}},
      {"voxel(size=0.001) | normals", {"ordering", "writing"}},
      {"normals | splats | fair | resort", {"ordering", "writing"}},
      {"set(intensity = intensity / 2)", {"writing"}},
  };
  for (const std::uint64_t chunk_rows : {0u, 5000u})
    for (const auto& [pipeline, phases] : phases_that_decode_all)
      for (const Nonfinite rule : {Nonfinite::keep, Nonfinite::drop}) {
        SCOPED_TRACE(pipeline);
        EngineOptions options;
        options.nonfinite = rule;
        std::map<std::string, int> decoders = decoders_by_phase(pipeline, chunk_rows, options);
        for (const std::string& phase : phases) EXPECT_EQ(decoders[phase], 2) << phase;
        if (rule == Nonfinite::drop) {
          EXPECT_EQ(decoders["checking"], 2);
        }
      }
}

TEST(AllThreads, GiveTheBytesOfOne) {
  const char* const pipelines[] = {
      "where(intensity < 90) | normals",
      "where(intensity < 90) | where(y > 0.5) | set(intensity = intensity / 2)",
      "sor | where(x < 0.7) | normals",
      "voxel(size=0.01, keep=centroid) | normals",
      "normals | where(nz > 0.95) | reneighbor(k=9) | sor",
  };
  for (const char* const pipeline : pipelines)
    for (const bool spill : {false, true}) {
      SCOPED_TRACE(pipeline);
      std::vector<std::byte> of_one;
      for (const unsigned threads : {1u, 2u, 8u}) {
        InputCloud cloud = wavy_square(nullptr, threads == 2 ? 0 : 5000, 1000);
        EngineOptions options;
        options.resources.threads = threads;
        options.resources.memory_bytes = 1 << 30;
        options.spill = spill;
        const RunResult result = run_in_memory(cloud, chain_of_any_cloud(pipeline), options);
        if (threads == 1) of_one = result.records;
        EXPECT_TRUE(result.records == of_one) << threads << " threads";
      }
      EXPECT_FALSE(of_one.empty());
    }
}

}  // namespace
}  // namespace pointsweep
