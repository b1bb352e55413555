// SPDX-License-Identifier: MIT
/// The bytes of each value that one phase of a run hands to another, written by hand. A change of the layout of a value
/// must raise its version.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "pointsweep/order/row_store.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/pipeline/checkpoint/checkpoints.h"
#include "pointsweep/storage/local/temp_folder.h"
#include "pointsweep/sweep/sweep.h"
#include "tests/order/cloud_source.h"
#include "tests/storage/written_bytes.h"

namespace pointsweep {
namespace {

// Whole numbers as little-endian bytes in hexadecimal digits.
const std::string k0 = "0000000000000000", k1 = "0100000000000000", k2 = "0200000000000000", k3 = "0300000000000000",
                  k4 = "0400000000000000", k5 = "0500000000000000", k6 = "0600000000000000";
const std::string kZero = "0000000000000000", kOne = "000000000000f03f", kTwo = "0000000000000040",
                  kInfinite = "000000000000f07f", kMinusInfinite = "000000000000f0ff";
const std::string kOrigin = kZero + kZero + kZero;

const std::string kNoSpacing = "0d 'local spacing' 0100" + kOrigin + kZero + "00000000" + k0 + k0;

TEST(EncodedValues, Survey) {
  Survey value{.sample = {{1, 2, 0}}, .bounds = {{0, 0, 0}, {1, 2, 0}}, .exact = true, .axis = 1, .dimension = 2};
  expect_encoding(value, "06 'survey' 0100" + k1 + kOne + kTwo + kZero +                   // sample
                             kOrigin + kOne + kTwo + kZero +                               // bounds
                             "01 01" + kTwo);                                              // exact, axis, dimension
  expect_encoding(Survey{}, "06 'survey' 0100" + k0 + kInfinite + kInfinite + kInfinite +  // no point, empty box
                                kMinusInfinite + kMinusInfinite + kMinusInfinite + "00 00" + kTwo);
}

TEST(EncodedValues, LocalSpacing) { expect_encoding(LocalSpacing(), kNoSpacing); }

TEST(EncodedValues, Stream) {
  const CloudSource<double> cloud({{1, 0, 0}, {2, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 0}});
  const TempFolder folder(temp_parent(""));
  StreamOptions options;
  options.spill = SpillPlace::kept(folder.path() / "stream");
  const Stream stream(cloud.source, survey(cloud.source, std::nullopt, false), options);
  const std::string box = kOne + kZero + kZero + kTwo + kZero + kZero;
  expect_encoding(encoded(stream),
                  "06 'stream' 0100 00" + kNoSpacing +  // axis
                      k1 + k0 + k2 + box + k0 +         // a slab: first, count, box, least row
                      k1 + k0 + k2 + box + k0 +         // its piece: list, count, box, least row
                      k2 +                              // list of the nonfinite point
                      "0c 'record lists' 0100" +        //
                      "7000000000000000" + k3 +         // bytes of the file, lists
                      k2 + k1 + k0 + k0 +               // count, its block: first record, offset
                      k0 + k0 +                         // where the nonfinite point was before
                      k1 + k1 + k0 + "5400000000000000",
                  [&](std::span<const std::byte> bytes) {
                    Decoder in(bytes);
                    const Stream again(in, cloud.source, options);
                    in.finish();
                    return encoded(again);
                  });
}

TEST(EncodedValues, RowStore) {
  const TempFolder folder(temp_parent(""));
  const SpillPlace kept = SpillPlace::kept(folder.path() / "results");
  const std::vector<std::byte> fill(4);
  RowStore store(3, fill, kept, 65536);
  const std::vector<std::uint64_t> rows = {2, 0};
  store.put(rows, std::vector<std::byte>(8));
  expect_encoding(encoded(store),
                  "09 'row store' 0100 0d000000" +                              // buckets of 2^13 rows
                      std::string("0c 'record lists' 0100 1000000000000000") +  // bytes of the file
                      k1 + k2 + k1 + k0 + k0,                                   // lists; count, block
                  [&](std::span<const std::byte> bytes) {
                    Decoder in(bytes);
                    RowStore again(in, 3, fill, kept, 1 << 20);
                    in.finish();
                    return encoded(again);
                  });
}

TEST(EncodedValues, SweepProgress) {
  SweepProgress value;
  value.slabs_read = 7;
  value.window = {{1, 2, 3, 1, 2.0}};
  value.dropped = {{4, {{{0, 0, 0}, {1, 1, 2}}, 5, 6}}};
  value.saturated_locations = {{{1, 2, 0}, 3}};
  value.deferred = {{{0, 1, 2}, 5, 1, 2, std::numeric_limits<double>::infinity(), 1}};
  value.certified = 1, value.recalled = 2, value.recalled_slabs = 3, value.peak_points = 4;
  value.degenerate.emplace_back(6, std::vector<std::uint64_t>{1, 2});
  expect_encoding(value, "0e 'sweep progress' 0100 07000000" + k1 + "01000000 02000000 03000000 01000000" + kTwo + k1 +
                             k4 + kOrigin + kOne + kOne + kTwo + "05000000 06000000" +                       //
                             k1 + kOne + kTwo + kZero + k3 +                                                 //
                             k1 + kZero + kOne + kTwo + k5 + "01000000 02000000" + kInfinite + "01000000" +  //
                             k1 + k2 + k3 + k4 + k1 + k6 + k2 + k1 + k2);
}

TEST(EncodedValues, Checkpoint) {
  Checkpoint value;
  value.memory_bytes = 5;
  value.ordered.emplace().axis = 1;
  value.sweep = 1;
  value.slab_points = 4;
  value.stream = {std::byte{0xaa}};
  value.results = {std::byte{0xbb}, std::byte{0xcc}};
  value.bucket_places = {{1, 2, 0}};
  value.mask = 1;
  value.values = {{}, {2.0}};
  value.counts.sweeps = 1;
  value.counts.certified = 2;
  value.counts.recalled = 3;
  value.counts.degenerate = 4;
  value.counts.nonfinite = 5;
  value.counts.peak_points = 6;
  value.counts.degenerate_results = {{"normals", 2, {3, 6}}};
  expect_encoding(value, "0a 'checkpoint' 0200" + k5 + hex(encoded(std::as_const(value.survey))) + "01" +
                             hex(encoded(std::as_const(*value.ordered))) + k1 + k4 +          //
                             k1 + "aa" + k2 + "bb cc" + k0 + k1 + kOne + kTwo + kZero + k1 +  //
                             k2 + k0 + k1 + kTwo +                                            // values
                             k1 + k2 + k3 + k4 + k5 + k6 +                                    // counts
                             k1 + "0700000000000000 'normals'" + k2 + k2 + k3 + k6);
}

}  // namespace
}  // namespace pointsweep
