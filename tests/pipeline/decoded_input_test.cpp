// SPDX-License-Identifier: MIT
/// Inputs that a run decodes once: each row is decoded once, and results do not change.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <random>

#include "pointsweep/fail.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/run/preview.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kRows = 5000, kChunkRows = 700;

/// A reader of x, y, z and intensity whose rows are to be decoded once, or each time, with or without decoders for
/// threads.
class SlowReader final : public Reader {
 public:
  struct Counts {
    std::atomic<std::uint64_t> decoded = 0;
    std::uint64_t fail_at = std::numeric_limits<std::uint64_t>::max();  ///< a row that cannot be decoded
  };
  enum class Decoding { once, each_time };

  SlowReader(Counts& counts, Decoding decoding, bool side_by_side, double nan_at = -1)
      : counts_(counts), side_by_side_(side_by_side) {
    for (const char* name : {"x", "y", "z", "intensity"}) info_.schema.append(name, Type::f64);
    info_.path = "slow";
    info_.count = kRows;
    info_.decode_once = decoding == Decoding::once;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform;
    for (std::uint64_t i = 0; i < kRows; ++i)
      for (const double v : {uniform(random), uniform(random), 0.1 * uniform(random), static_cast<double>(i)})
        values_.push_back(static_cast<double>(i) == nan_at && v != nan_at ? std::nan("") : v);
  }

  bool has_decoders() const override { return side_by_side_; }
  Chunk chunk_of(std::uint64_t row) const override {
    const std::uint64_t first = row / kChunkRows * kChunkRows;
    return {.first_row = first, .rows = std::min(kChunkRows, kRows - first), .bounds = {}};
  }
  std::unique_ptr<RowDecoder> decoder(const WantedFields&) const override {
    return side_by_side_ ? std::make_unique<Decoder>(*this) : nullptr;
  }
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override { return decode(row, records); }

 private:
  class Decoder final : public RowDecoder {
   public:
    explicit Decoder(const SlowReader& reader) : reader_(reader) {}
    std::size_t read(std::uint64_t row, std::span<std::byte> records) override { return reader_.decode(row, records); }

   private:
    const SlowReader& reader_;
  };

  std::size_t decode(std::uint64_t row, std::span<std::byte> records) const {
    const std::size_t rows = rows_for(row, records);
    if (row <= counts_.fail_at && counts_.fail_at < row + rows) fail("slow: row {} is damaged.", counts_.fail_at);
    std::memcpy(records.data(), values_.data() + 4 * row, rows * info_.schema.stride);
    counts_.decoded += rows;
    return rows;
  }

  Counts& counts_;
  bool side_by_side_;
  std::vector<double> values_;
};

using Decoding = SlowReader::Decoding;

InputCloud cloud_of(SlowReader::Counts& counts, Decoding decoding, bool side_by_side, double nan_at = -1) {
  std::vector<std::unique_ptr<Reader>> readers;
  for (int i = 0; i < 2; ++i)
    readers.push_back(std::make_unique<SlowReader>(counts, decoding, side_by_side, i == 0 ? nan_at : -1));
  return InputCloud(std::move(readers));
}

class InputDecodedOnce : public testing::Test {
 protected:
  std::string bytes_of(InputCloud& cloud, const std::string& pipeline, const EngineOptions& options,
                       const char* format) {
    EngineOptions overwriting = options;
    overwriting.overwrite = true;
    Outputs outputs;
    outputs.points = folder_ / (std::string("out") + format);
    run(cloud, build_chain(parse_pipeline(pipeline), Facts{}), outputs, overwriting);
    return contents(outputs.points);
  }

  TemporaryFolder folder_;
};

TEST_F(InputDecodedOnce, EachRowIsDecodedOnceAndResultsAreTheSame) {
  for (const char* pipeline : {"knn(k=6) | normals", "knn(k=6) | where(intensity < 3000) | normals",
                               "knn(k=6) | normals | splats | fair | reneighbor | normals", "unique"})
    for (const Order order : {Order::input, Order::sweep})
      for (const bool side_by_side : {false, true})
        for (const char* format : {".ply", ".las"}) {
          SCOPED_TRACE(testing::Message() << pipeline << format << static_cast<int>(order) << side_by_side);
          SlowReader::Counts once, often;
          InputCloud slow = cloud_of(once, Decoding::once, side_by_side);
          InputCloud plain = cloud_of(often, Decoding::each_time, side_by_side);
          EngineOptions options;
          options.order = order;
          EXPECT_EQ(bytes_of(slow, pipeline, options, format), bytes_of(plain, pipeline, options, format));
          // A run with a LAS output first searches the input for points that are not finite.
          EXPECT_EQ(once.decoded, format == std::string(".las") ? 4 * kRows : 2 * kRows);
          EXPECT_GT(often.decoded, 2 * kRows);
        }
}

TEST_F(InputDecodedOnce, PointsThatAreDroppedKeepTheirNumbers) {
  SlowReader::Counts once, often;
  InputCloud slow = cloud_of(once, Decoding::once, true, 17);
  InputCloud plain = cloud_of(often, Decoding::each_time, true, 17);
  const Chain chain = build_chain(parse_pipeline("knn(k=20, radius=0.025) | normals"), Facts{});
  EngineOptions options;
  options.nonfinite = Nonfinite::drop;
  options.overwrite = true;
  Outputs outputs;
  outputs.points = folder_ / "out.ply";
  const Statistics of_slow = run(slow, chain, outputs, options), of_plain = run(plain, chain, outputs, options);
  EXPECT_EQ(of_slow.dropped, 1u);
  ASSERT_EQ(of_slow.degenerate_results.size(), of_plain.degenerate_results.size());
  ASSERT_FALSE(of_slow.degenerate_results.empty());
  EXPECT_GT(of_slow.degenerate_results[0].rows.back(), 17u);
  EXPECT_EQ(of_slow.degenerate_results[0].rows, of_plain.degenerate_results[0].rows);
}

TEST_F(InputDecodedOnce, IsRefusedBeforeItIsDecoded) {
  SlowReader::Counts counts;
  InputCloud slow = cloud_of(counts, Decoding::once, true);
  Outputs outputs;
  outputs.points = folder_.write("out.ply", "precious");
  EXPECT_THROW(run(slow, build_chain(parse_pipeline("normals"), Facts{}), outputs, {}), Error);
  EXPECT_EQ(counts.decoded, 0u);
  EXPECT_EQ(contents(outputs.points), "precious");
}

TEST_F(InputDecodedOnce, ThatIsDamagedEndsTheRunAndLeavesTheCloudAsItWas) {
  for (const bool side_by_side : {false, true}) {
    SlowReader::Counts counts;
    counts.fail_at = 4321;
    InputCloud slow = cloud_of(counts, Decoding::once, side_by_side);
    try {
      bytes_of(slow, "normals", {}, ".ply");
      ADD_FAILURE() << "the damage was not noticed";
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(), "slow: row 4321 is damaged.");
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.ply"));
    EXPECT_TRUE(slow.readers()[0]->info().decode_once);
    counts.fail_at = std::numeric_limits<std::uint64_t>::max();
    EXPECT_FALSE(bytes_of(slow, "normals", {}, ".ply").empty());
    std::filesystem::remove(folder_ / "out.ply");
  }
}

TEST_F(InputDecodedOnce, LeavesNothingInTheFolderOfARunThatIsResumed) {
  const std::filesystem::path laz = folder_ / "in.laz", las = folder_ / "in.las";
  if (!format_of_output(laz)->is_built_in()) GTEST_SKIP() << "built without LAZ";
  SlowReader::Counts counts;
  InputCloud generated = cloud_of(counts, Decoding::each_time, true);
  sort(generated, laz), sort(generated, las);
  InputCloud slow({laz}), plain({las});
  EngineOptions resuming;
  resuming.resume_folder = folder_ / "work";
  resuming.checkpoint_seconds = 0;
  resuming.provenance = false;
  Watching watching([](const Progress& progress) {
    if (progress.phase == std::string("sweeping") && progress.done > kRows) fail("interrupted");
  });
  resuming.observer = &watching;
  resuming.slab_points = 500;
  EXPECT_THROW(bytes_of(slow, "normals", resuming, ".ply"), Error);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "work"));
  resuming.observer = nullptr;
  EngineOptions plainly;
  plainly.provenance = false;
  EXPECT_EQ(bytes_of(slow, "normals", resuming, ".ply"), bytes_of(plain, "normals", plainly, ".ply"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "work"));
}

TEST_F(InputDecodedOnce, OfManyFilesTakesOneOpenFile) {
  SlowReader::Counts once, often;
  std::vector<std::unique_ptr<Reader>> slow, plain;
  for (int i = 0; i < 50; ++i) {
    slow.push_back(std::make_unique<SlowReader>(once, Decoding::once, i % 2 == 0));
    plain.push_back(std::make_unique<SlowReader>(often, Decoding::each_time, true));
  }
  InputCloud slow_cloud(std::move(slow)), plain_cloud(std::move(plain));
  const auto open_files = [] {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return std::distance(begin(all), end(all));
  };
  const auto before = open_files();
  std::ptrdiff_t most = 0;
  Watching watching([&](const Progress& progress) {
    if (progress.phase == std::string("decoding")) most = std::max(most, open_files() - before);
  });
  EngineOptions options;
  options.observer = &watching;
  const std::string bytes = bytes_of(slow_cloud, "unique", options, ".ply");
  EXPECT_GT(most, 0);
  EXPECT_LT(most, 10);
  EXPECT_EQ(once.decoded, 50 * kRows);
  options.observer = nullptr;
  EXPECT_EQ(bytes, bytes_of(plain_cloud, "unique", options, ".ply"));
}

TEST_F(InputDecodedOnce, OfSeveralDamagedFilesNamesTheFirst) {
  for (int turn = 0; turn < 20; ++turn) {
    std::vector<SlowReader::Counts> counts(10);
    std::vector<std::unique_ptr<Reader>> readers;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (i > 2) counts[i].fail_at = 100 * i;
      readers.push_back(std::make_unique<SlowReader>(counts[i], Decoding::once, i % 3 != 0));
    }
    InputCloud cloud(std::move(readers));
    EXPECT_THAT(sentence_of<Error>([&] { bytes_of(cloud, "normals", {}, ".ply"); }), testing::HasSubstr("row 300 is"));
  }
}

TEST_F(InputDecodedOnce, IsNotPutAsideWhereItsRowsAreOnlyCopied) {
  for (const bool side_by_side : {false, true})
    for (const std::uint64_t memory : {0u, 40u << 20}) {
      SlowReader::Counts once, often;
      InputCloud slow = cloud_of(once, Decoding::once, side_by_side);
      InputCloud plain = cloud_of(often, Decoding::each_time, side_by_side);
      EngineOptions options;
      options.overwrite = true;
      options.resources.memory_bytes = memory;
      const Outputs of_slow{.points = folder_ / "slow.ply"}, of_plain{.points = folder_ / "plain.ply"};
      const Statistics copied = run(slow, Chain{}, of_slow, options);
      run(plain, Chain{}, of_plain, options);
      EXPECT_EQ(copied.bytes_spilled_decoding, 0u);
      EXPECT_EQ(once.decoded, 2 * kRows);
      EXPECT_EQ(contents(of_slow.points), contents(of_plain.points));
      EXPECT_EQ(to_text(preview(slow, Chain{}, options, of_slow)).find("decoding"), std::string::npos);
    }
}

TEST_F(InputDecodedOnce, IsPutAsideForACopyWhoseFormatNeedsTheBounds) {
  SlowReader::Counts once;
  InputCloud slow = cloud_of(once, Decoding::once, true);
  const Statistics copied = run(slow, Chain{}, {.points = folder_ / "out.las"}, EngineOptions());
  EXPECT_EQ(copied.bytes_spilled_decoding, 2 * kRows * 32);
}

TEST_F(InputDecodedOnce, IsNamedInADryRun) {
  SlowReader::Counts counts;
  InputCloud slow = cloud_of(counts, Decoding::once, true);
  const std::string text = to_text(preview(slow, build_chain(parse_pipeline("normals"), Facts{})));
  EXPECT_NE(text.find("decoding      once, into a temporary file of 0.3 MB\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace pointsweep
