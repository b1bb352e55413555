// SPDX-License-Identifier: MIT
/// Every pass over the input decodes it on all threads, whatever earlier passes have dropped or made. The output has
/// equal bytes for any number of threads.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "tests/pipeline/in_memory.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kLostRows = 500, kWavyChunkRows = 1000;

/// A place where decoders wait for each other: a decoder that comes in one of the phases waits for a second, until two
/// have met. It waits several times, since the first decoder of a phase may be the last one of the phase before.
class Meeting {
 public:
  explicit Meeting(std::set<std::string> phases) : phases_(std::move(phases)) {}
  void enter() {
    std::unique_lock lock(mutex_);
    Seen& seen = seen_[phase_];
    seen.most = std::max(seen.most, ++inside_);
    changed_.notify_all();
    if (phases_.contains(phase_) && seen.most < 2 && seen.misses < 10)
      seen.misses += !changed_.wait_for(lock, std::chrono::milliseconds(500), [&] { return seen.most >= 2; });
    --inside_;
  }
  void begin(const std::string& phase) {
    const std::lock_guard lock(mutex_);
    phase_ = phase;
  }
  /// Returns the number of decoders seen at once, by phase.
  std::map<std::string, int> phases() const {
    std::map<std::string, int> all;
    for (const auto& [phase, seen] : seen_) all[phase] = seen.most;
    return all;
  }

 private:
  struct Seen {
    int most = 0;
    int misses = 0;
  };
  const std::set<std::string> phases_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string phase_;
  std::map<std::string, Seen> seen_;
  int inside_ = 0;
};

/// A hilly square, as records of x, y, z and intensity. Rows are decoded in chunks of `chunk_rows` rows; 0: in any
/// range. kLostRows rows have no finite place.
class WavyReader final : public Reader {
 public:
  WavyReader(Meeting* meeting, std::uint64_t rows, std::uint64_t chunk_rows)
      : meeting_(meeting), chunk_rows_(chunk_rows) {
    for (const char* field : {"x", "y", "z", "intensity"}) info_.schema.append(field, Type::f64);
    info_.path = "waves";
    info_.count = rows;
  }
  bool has_decoders() const override { return true; }
  bool decodes_any_range() const override { return chunk_rows_ == 0; }
  Chunk chunk_of(std::uint64_t row) const override {
    if (chunk_rows_ == 0) return Reader::chunk_of(row);
    const std::uint64_t first = row / chunk_rows_ * chunk_rows_;
    return {first, std::min(chunk_rows_, info_.count - first), 0, 0, std::nullopt};
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
        const bool lost = (row + i) * 2654435761 % reader_.info().count < kLostRows;
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
  std::uint64_t chunk_rows_;
};

InputCloud wavy_square(Meeting* meeting, std::uint64_t rows, std::uint64_t chunk_rows) {
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<WavyReader>(meeting, rows, chunk_rows));
  return InputCloud(std::move(readers));
}

/// Returns the number of decoders at work at once, by phase of a run over a cloud in which some rows have no finite
/// place. Decoders wait for each other in the phases `expected`.
std::map<std::string, int> decoders_by_phase(const std::string& pipeline, std::uint64_t chunk_rows,
                                             EngineOptions options, const std::set<std::string>& expected) {
  Meeting meeting(expected);
  Watching observer([&](const Progress& p) { meeting.begin(p.phase); });
  options.resources.threads = 2;
  options.resources.memory_bytes = 1 << 30;
  options.observer = &observer;
  // So many rows that each phase takes several turns: the first turn comes before the phase is reported.
  InputCloud cloud = wavy_square(&meeting, 150'000, chunk_rows);
  run_in_memory(cloud, chain_of_any_cloud(pipeline), options);
  return meeting.phases();
}

TEST(AllThreads, DecodeTheInputInEveryPass) {
  const std::map<std::string, std::set<std::string>> phases_that_decode_all = {
      {"where(intensity < 90) | normals", {"updating", "ordering", "writing"}},
      {"sor | where(intensity < 90) | normals", {"updating", "ordering", "writing"}},
      {"voxel(size=0.001) | normals", {"ordering", "writing"}},
      {"normals | splats | fair | resort", {"ordering", "writing"}},
      {"set(intensity = intensity / 2)", {"writing"}},
  };
  const std::string crossed = "where(intensity < 90) | normals";  // tried with both chunks and both rules
  for (const std::uint64_t chunk_rows : {std::uint64_t{0}, kWavyChunkRows})
    for (const auto& [pipeline, phases] : phases_that_decode_all)
      for (const Nonfinite rule : {Nonfinite::keep, Nonfinite::drop}) {
        if (pipeline != crossed && (chunk_rows == 0) != (rule == Nonfinite::keep)) continue;
        SCOPED_TRACE(pipeline);
        EngineOptions options;
        options.nonfinite = rule;
        std::set<std::string> expected = phases;
        if (rule == Nonfinite::drop) expected.insert("checking");
        std::map<std::string, int> decoders = decoders_by_phase(pipeline, chunk_rows, options, expected);
        for (const std::string& phase : expected) EXPECT_EQ(decoders[phase], 2) << phase;
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
  struct Way {
    unsigned threads;
    std::uint64_t chunk_rows;
    bool spill;
  };
  for (const char* const pipeline : pipelines) {
    SCOPED_TRACE(pipeline);
    std::vector<std::byte> of_one;
    for (const Way& way : {Way{1, kWavyChunkRows, false}, Way{2, 0, false}, Way{8, kWavyChunkRows, true}}) {
      InputCloud cloud = wavy_square(nullptr, 60'000, way.chunk_rows);
      EngineOptions options;
      options.resources.threads = way.threads;
      options.resources.memory_bytes = 1 << 30;
      options.spill = way.spill;
      const RunResult result = run_in_memory(cloud, chain_of_any_cloud(pipeline), options);
      if (way.threads == 1) of_one = result.records;
      EXPECT_TRUE(result.records == of_one) << way.threads << " threads";
    }
    EXPECT_FALSE(of_one.empty());
  }
}

}  // namespace
}  // namespace pointsweep
