// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <thread>

#include "pointsweep/fail.h"
#include "pointsweep/order/local_spacing.h"
#include "pointsweep/order/pieces.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/threads.h"
#include "tests/order/cloud_source.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kChunk = 1000;

/// A source in which every chunk but the first fails. The thread that has read the first chunk reads a later chunk,
/// which fails before the second chunk.
struct FailingSource {
  CloudSource<double> cloud{random_points(20 * kChunk, 3)};
  std::atomic<bool> second_is_read = false, has_failed = false;

  FailingSource() {
    cloud.source.chunk_end = [](std::uint64_t row) { return (row / kChunk + 1) * kChunk; };
    cloud.source.for_thread = [this](const std::vector<std::size_t>&) -> ReadRows {
      return [this](std::uint64_t row, std::span<std::byte> out) -> std::size_t {
        const std::uint64_t chunk = row / kChunk;
        if (chunk == 1) second_is_read = true;
        if (chunk == 0) wait_for(second_is_read);
        if (chunk == 0) return cloud.source.read(row, out);
        if (chunk == 1) wait_for(has_failed);
        has_failed = true;
        fail("chunk {}.", chunk);
      };
    };
  }

  /// Waits for an event, at most a second. A single thread waits for the whole second.
  static void wait_for(const std::atomic<bool>& event) {
    for (int i = 0; !event && i < 1000; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
};

template <class Work>
std::string failure_of(const Work& work) {
  std::string text;
  with_threads(4, [&] {
    FailingSource failing;
    try {
      work(failing.cloud.source);
    } catch (const Error& error) {
      text = error.what();
    }
  });
  return text;
}

TEST(FirstFailureOfASource, IsThatOfTheLowestRowWhereRowsAreDistributed) {
  EXPECT_EQ(failure_of([](const PointSource& source) {
              StreamOptions options;
              options.axis = 0;
              options.buffer_bytes = 1 << 20;
              Stream(source, survey(source, 0, false), options);
            }),
            "chunk 1.");
}

TEST(FirstFailureOfASource, IsThatOfTheLowestRowWhereRowsAreRead) {
  EXPECT_EQ(failure_of([](const PointSource& source) {
              ParallelRows rows(source);
              std::vector<std::byte> records(source.count * source.schema.stride);
              rows.read(0, records);
            }),
            "chunk 1.");
}

TEST(FirstFailureOfASource, IsThatOfTheLowestRowWherePiecesAreCounted) {
  EXPECT_EQ(failure_of([](const PointSource& source) {
              const LocalSpacing spacing;
              const std::vector<Splitters> splitters{Splitters{}};
              count_pieces(source, PieceFinder(splitters, &spacing), 0, cut_into_blocks(source.count, kChunk, {}), {});
            }),
            "chunk 1.");
}

}  // namespace
}  // namespace pointsweep
