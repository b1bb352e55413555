// SPDX-License-Identifier: MIT
#include "pointsweep/order/stream.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <thread>
#include <tuple>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/order/pieces.h"
#include "pointsweep/order/slabs_on_demand.h"
#include "pointsweep/storage/local/temp_folder.h"
#include "pointsweep/threads.h"
#include "tests/order/cloud_source.h"

namespace pointsweep {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Entry {
  Vec3 p;
  std::uint64_t row = 0;
  std::vector<std::byte> bytes;  ///< bytes of the working record
};

/// Returns whether a precedes b in the canonical order, written from its definition.
bool precedes(int axis, const Entry& a, const Entry& b) {
  const auto key = [axis](const Entry& e) { return std::tuple(e.p[axis], e.p.x, e.p.y, e.p.z, e.row); };
  return key(a) < key(b);
}

std::vector<Entry> entries_of(const Stream& stream, const std::vector<std::byte>& records) {
  const Schema& schema = stream.record_schema();
  std::vector<Entry> entries;
  for (std::size_t at = 0; at < records.size(); at += schema.stride) {
    Entry e;
    const std::byte* record = records.data() + at;
    for (int a = 0; a < 3; ++a)
      e.p[a] = value_of(schema.fields[*schema.find(a == 0 ? "x" : a == 1 ? "y" : "z")], record);
    e.row = static_cast<std::uint64_t>(value_of(schema.fields.back(), record));
    e.bytes.assign(record, record + schema.fields.back().offset);
    entries.push_back(std::move(e));
  }
  return entries;
}

struct Streamed {
  std::vector<Slab> slabs;
  std::vector<std::vector<Entry>> points;  ///< by slab, sorted by row
  std::vector<Entry> nonfinite;
};

Streamed streamed(const Stream& stream) {
  Streamed result{stream.slabs(), {}, {}};
  for (std::size_t s = 0; s < stream.slabs().size(); ++s) {
    std::vector<std::byte> records(stream.slabs()[s].count * stream.record_schema().stride);
    stream.read(s, records);
    result.points.push_back(entries_of(stream, records));
    std::ranges::sort(result.points.back(), {}, &Entry::row);
  }
  std::vector<std::byte> records(stream.nonfinite_count() * stream.record_schema().stride);
  stream.read_nonfinite(0, records);
  result.nonfinite = entries_of(stream, records);
  return result;
}

Streamed run(const PointSource& source, const StreamOptions& options, const Survey& look) {
  return streamed(Stream(source, look, options));
}

/// Checks all promises of stream.h against the source.
template <class T>
void check(const CloudSource<T>& cloud, const StreamOptions& options, const Streamed& streamed) {
  const std::uint32_t stride = cloud.source.schema.stride;
  const std::uint64_t most = options.max_slab_points != 0 ? options.max_slab_points : 2 * options.slab_points;
  std::vector<int> seen(cloud.source.count, 0);
  const auto see = [&](const Entry& e) {
    ASSERT_LT(e.row, cloud.source.count);
    ++seen[e.row];
    ASSERT_EQ(std::memcmp(e.bytes.data(), &cloud.bytes[e.row * stride], stride), 0);
  };
  std::uint64_t first = 0;
  const Entry* greatest = nullptr;
  for (std::size_t s = 0; s < streamed.slabs.size(); ++s) {
    const Slab& slab = streamed.slabs[s];
    ASSERT_EQ(slab.first, first);
    ASSERT_GT(slab.count, 0u);
    ASSERT_LE(slab.count, most);
    first += slab.count;
    Box box;
    for (const Entry& e : streamed.points[s]) {
      see(e);
      ASSERT_TRUE(is_finite(e.p));
      box.include(e.p);
    }
    ASSERT_EQ(slab.box, box);
    const auto [low, high] = std::ranges::minmax_element(
        streamed.points[s], [&](const Entry& a, const Entry& b) { return precedes(options.axis, a, b); });
    ASSERT_TRUE(greatest == nullptr || precedes(options.axis, *greatest, *low));
    greatest = &*high;
  }
  for (std::size_t i = 0; i < streamed.nonfinite.size(); ++i) {
    see(streamed.nonfinite[i]);
    ASSERT_FALSE(is_finite(streamed.nonfinite[i].p));
    ASSERT_TRUE(i == 0 || streamed.nonfinite[i - 1].row < streamed.nonfinite[i].row);
  }
  ASSERT_EQ(std::ranges::count(seen, 1), static_cast<std::ptrdiff_t>(seen.size()));
}

StreamOptions small_options(int axis) {
  StreamOptions options;
  options.axis = axis;
  options.slab_points = 50;
  options.max_slab_points = 120;
  options.payload = {3};
  options.buffer_bytes = 1 << 17;
  return options;
}

std::filesystem::path temp_parent() { return std::filesystem::temp_directory_path(); }

bool same(const Streamed& a, const Streamed& b) {
  const auto equal = [](const Entry& p, const Entry& q) { return p.row == q.row && p.bytes == q.bytes; };
  if (a.slabs.size() != b.slabs.size()) return false;
  for (std::size_t s = 0; s < a.slabs.size(); ++s) {
    if (a.slabs[s].first != b.slabs[s].first || a.slabs[s].count != b.slabs[s].count) return false;
    if (std::memcmp(&a.slabs[s].box, &b.slabs[s].box, sizeof(Box)) != 0) return false;
    if (!std::ranges::equal(a.points[s], b.points[s], equal)) return false;
  }
  return std::ranges::equal(a.nonfinite, b.nonfinite, equal);
}

/// Checks streams in memory and spilled, made by one thread and by four: all keep the promises and are equal.
template <class T>
void check_all_ways(const std::vector<Vec3>& points, StreamOptions options) {
  const CloudSource<T> cloud(points);
  const Survey look = survey(cloud.source, options.axis, false);
  const TempFolder folder(temp_parent());
  std::vector<Streamed> results;
  for (const unsigned threads : {1, 4}) {
    for (const TempFolder* spill : {static_cast<const TempFolder*>(nullptr), &folder}) {
      options.spill = spill;
      with_threads(threads, [&] { results.push_back(run(cloud.source, options, look)); });
      check(cloud, options, results.back());
      if (testing::Test::HasFatalFailure()) return;
      EXPECT_TRUE(same(results.front(), results.back())) << threads << " threads, spilled: " << (spill != nullptr);
    }
  }
}

std::vector<Vec3> made_by(std::size_t n, const std::function<Vec3(std::size_t)>& point) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) points.push_back(point(i));
  return points;
}

TEST(Stream, HoldsEveryPointOnceWhateverTheCloud) {
  rc::check([] {
    // Few different coordinates, so that ties are frequent, and some that are no numbers.
    const auto coordinate = rc::gen::weightedOneOf<double>(
        {{60, rc::gen::map(rc::gen::inRange(-4, 5), [](int i) { return i * 0.25; })},
         {30, rc::gen::map(rc::gen::arbitrary<std::int16_t>(), [](int i) { return i * 1e-3; })},
         {1, rc::gen::element(kNaN, kInf, -kInf, -0.0, 1e300, -1e300, 5e-324)}});
    const auto point = rc::gen::apply(
        [](double x, double y, double z) {
          return Vec3{x, y, z};
        },
        coordinate, coordinate, coordinate);
    const auto points = *rc::gen::container<std::vector<Vec3>>(*rc::gen::inRange<std::size_t>(0, 600), point);
    StreamOptions options = small_options(*rc::gen::inRange(0, 3));
    options.slab_points = *rc::gen::inRange<std::uint64_t>(1, 40);
    options.max_slab_points = *rc::gen::inRange<std::uint64_t>(1, 100);
    check_all_ways<double>(points, options);
    RC_ASSERT(!testing::Test::HasFailure());
  });
}

TEST(Stream, OfRandomPointsHasSlabsOfAboutTheSizeAskedFor) {
  const CloudSource<float> cloud(random_points(100000, 1));
  StreamOptions options;
  options.slab_points = 5000;
  options.payload = {3};
  const Streamed streamed = run(cloud.source, options, survey(cloud.source, {}, false));
  check(cloud, options, streamed);
  EXPECT_GE(streamed.slabs.size(), 15u);
  EXPECT_LE(streamed.slabs.size(), 25u);
}

TEST(Stream, KeepsItsPromisesForRandomPointsOnEveryAxis) {
  for (int axis = 0; axis < 3; ++axis) check_all_ways<float>(random_points(20000, 2), small_options(axis));
}

TEST(Stream, SplitsPointsThatAreEqualAlongTheAxisByTheOtherCoordinates) {
  std::vector<Vec3> points = random_points(5000, 3);
  for (Vec3& p : points) p.x = 7;
  check_all_ways<double>(points, small_options(0));
  for (Vec3& p : points) p.y = -1;
  check_all_ways<double>(points, small_options(0));
}

TEST(Stream, SplitsIdenticalPointsByTheirRows) {
  check_all_ways<float>(made_by(5000, [](std::size_t) { return Vec3{1, 2, 3}; }), small_options(1));
}

TEST(Stream, TakesTheTwoZerosForOneNumber) {
  check_all_ways<double>(made_by(3000,
                                 [](std::size_t i) {
                                   return Vec3{i % 2 ? 0.0 : -0.0, i % 3 ? -0.0 : 0.0, 0.0};
                                 }),
                         small_options(0));
}

TEST(Stream, SplitsACloudOfTwoValues) {
  check_all_ways<float>(made_by(5000,
                                [](std::size_t i) {
                                  return Vec3{i % 7 ? 1.0 : 2.0, static_cast<double>(i % 11), 0};
                                }),
                        small_options(0));
}

TEST(Stream, DoesNotCareHowTheInputIsSorted) {
  const auto ascending = made_by(9000, [](std::size_t i) { return Vec3{static_cast<double>(i), 0, 1}; });
  check_all_ways<double>(ascending, small_options(0));
  check_all_ways<double>({ascending.rbegin(), ascending.rend()}, small_options(0));
  check_all_ways<double>(made_by(9000,
                                 [](std::size_t i) {
                                   return Vec3{std::abs(static_cast<double>(i) - 4500), 0, 1};
                                 }),
                         small_options(0));
}

TEST(Stream, SplitsADensePlaceThatTheSampleMissed) {
  // The sample of the survey has evenly spread points, but nearly all points of the source are in one place.
  std::vector<Vec3> points = random_points(20000, 4);
  const CloudSource<double> even(points);
  for (std::size_t i = 0; i < points.size(); i += 1 + (i % 50 != 0))
    points[i] = {1 + 1e-9 * points[i].x, 1, points[i].z};
  const CloudSource<double> cloud(points);
  const StreamOptions options = small_options(0);
  check(cloud, options, run(cloud.source, options, survey(even.source, 0, false)));
}

TEST(Stream, SplitsPointsThatGetCloserWithoutEnd) {
  check_all_ways<double>(
      made_by(8000,
              [](std::size_t i) {
                return Vec3{std::ldexp(1.0 + static_cast<double>(i % 16) / 16, -static_cast<int>(i / 8)), 0, 0};
              }),
      small_options(0));
}

TEST(Stream, PutsPointsWithoutAPlaceAsideInAscendingRow) {
  std::vector<Vec3> points = random_points(30000, 5);
  for (std::size_t i = 0; i < points.size(); i += 3) points[i][static_cast<int>(i % 2)] = i % 9 ? kNaN : -kInf;
  check_all_ways<float>(points, small_options(2));
}

TEST(Stream, MayConsistOfPointsWithoutAPlaceOnly) {
  StreamOptions options = small_options(0);
  options.buffer_bytes = 4096;  // so small that sorting by row takes several pieces
  check_all_ways<float>(made_by(20000, [](std::size_t) { return Vec3{kNaN, 0, kInf}; }), options);
}

TEST(Stream, MayBeTiny) {
  for (const std::size_t n : {0, 1, 2, 3}) check_all_ways<float>(random_points(n, 6), small_options(0));
}

TEST(Stream, CarriesWholeRecordsIfAsked) {
  StreamOptions options = small_options(0);
  options.payload = {};
  options.whole_records = true;
  check_all_ways<float>(random_points(3000, 8), options);
}

TEST(Stream, JoinsThinSlabs) {
  // Half of the points share a coordinate. Pieces with only these points lie between pieces with few points.
  std::vector<Vec3> points = random_points(20000, 9);
  for (std::size_t i = 0; i < points.size(); i += 2) points[i].x = 0.5;
  const CloudSource<double> cloud(points);
  StreamOptions options = small_options(0);
  options.slab_points = 1000;
  options.max_slab_points = 4000;
  const Streamed streamed = run(cloud.source, options, survey(cloud.source, 0, false));
  check(cloud, options, streamed);
  for (std::size_t s = 1; s < streamed.slabs.size(); ++s)
    EXPECT_GT(streamed.slabs[s - 1].count + streamed.slabs[s].count, options.slab_points);
}

TEST(Stream, ReadsPartsOfThePointsWithoutAPlace) {
  std::vector<Vec3> points = random_points(1000, 10);
  for (std::size_t i = 0; i < points.size(); i += 10) points[i].z = kNaN;
  const CloudSource<float> cloud(points);
  const Stream stream(cloud.source, survey(cloud.source, {}, false), small_options(0));
  ASSERT_EQ(stream.nonfinite_count(), 100u);
  std::vector<std::byte> records(3 * stream.record_schema().stride);
  stream.read_nonfinite(42, records);
  const std::vector<Entry> entries = entries_of(stream, records);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(entries[i].row, 10 * (42 + i));
}

TEST(Stream, SaysHowManyRowsAreRead) {
  const CloudSource<float> cloud(random_points(50000, 11));
  StreamOptions options = small_options(0);
  std::vector<std::uint64_t> told;
  options.progress = [&](std::uint64_t rows) { told.push_back(rows); };
  const Stream stream(cloud.source, survey(cloud.source, {}, false), options);
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(std::ranges::is_sorted(told));
  EXPECT_EQ(told.back(), 50000u);
}

TEST(Stream, PassesOnWhatTheSourceThrows) {
  const CloudSource<float> cloud(random_points(50000, 12));
  const Survey look = survey(cloud.source, {}, false);
  PointSource failing = cloud.source;
  failing.read = [&](std::uint64_t row, std::span<std::byte> out) -> std::size_t {
    if (row > 20000) fail("scan.ply: byte 12: unreadable");
    return cloud.source.read(row, out);
  };
  EXPECT_THROW(Stream(failing, look, small_options(0)), Error);
  failing.read = [&](std::uint64_t row, std::span<std::byte> out) {
    return row > 20000 ? 0 : cloud.source.read(row, out);
  };
  EXPECT_THROW(Stream(failing, look, small_options(0)), Error);
}

TEST(Stream, SpillsWhatItDoesNotHoldInMemory) {
  const CloudSource<float> cloud(random_points(50000, 13));
  const Survey look = survey(cloud.source, {}, false);
  StreamOptions options = small_options(0);
  const Stream held(cloud.source, look, options);
  EXPECT_EQ(held.spilled_bytes(), 0u);
  EXPECT_GE(held.memory_bytes(), 50000u * held.record_schema().stride);
  const TempFolder folder(temp_parent());
  options.spill = &folder;
  const Stream spilled(cloud.source, look, options);
  EXPECT_GE(spilled.spilled_bytes(), 50000u * spilled.record_schema().stride);
  EXPECT_LT(spilled.memory_bytes(), held.memory_bytes());
}

TEST(Stream, OfLargeCoordinatesLosesNothing) {
  std::vector<Vec3> points = random_points(5000, 7);
  for (Vec3& p : points) p = p + Vec3{4.5e5, 5.2e6, 300};
  check_all_ways<double>(points, small_options(1));
}

/// Expects every input row in exactly one slab, inside the box of the slab and not below its least row.
void check_slabs(const Streamed& streamed, std::size_t points) {
  std::vector<int> seen(points, 0);
  for (std::size_t s = 0; s < streamed.slabs.size(); ++s) {
    for (const Entry& e : streamed.points[s]) {
      ++seen[e.row];
      ASSERT_EQ(distance2(streamed.slabs[s].box, e.p), 0);
      ASSERT_GE(e.row, streamed.slabs[s].least_row);
    }
  }
  ASSERT_EQ(std::ranges::count(seen, 1), static_cast<std::ptrdiff_t>(points));
}

TEST(StreamNotCanonical, ANoisyWallAcrossTheAxisIsNotCutIntoSheets) {
  std::vector<Vec3> points = random_points(40000, 4);  // 6 x 4 x 2
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = i % 100 == 0 ? Vec3{30 * points[i].x, points[i].y, points[i].z}
                             : Vec3{1e-4 * points[i].x, points[i].y, points[i].z};
  const CloudSource<double> cloud(points);
  StreamOptions options;
  options.slab_points = 1000;
  const auto thin_slabs = [&] {
    const Streamed streamed = run(cloud.source, options, survey(cloud.source, 0, false));
    check_slabs(streamed, points.size());
    return std::ranges::count_if(streamed.slabs,
                                 [](const Slab& s) { return s.box.extent().x < 1e-4 && s.box.extent().y > 2; });
  };
  EXPECT_GT(thin_slabs(), 20);
  options.canonical = false;
  EXPECT_EQ(thin_slabs(), 0);
}

TEST(StreamNotCanonical, CopiesOfAPointAreSplitByRowsThatAscend) {
  std::vector<Vec3> points = random_points(3000, 4);
  for (std::size_t i = 0; i < points.size(); i += 1 + i % 2) points[i] = {0.5, 0.25, 0.125};
  const CloudSource<double> cloud(points);
  StreamOptions options;
  options.slab_points = 100, options.canonical = false;
  const Streamed streamed = run(cloud.source, options, survey(cloud.source, 0, false));
  check_slabs(streamed, points.size());
  std::vector<std::uint64_t> least;
  for (const Slab& slab : streamed.slabs) {
    if (slab.box.lo == slab.box.hi && slab.count > 1) least.push_back(slab.least_row);
  }
  EXPECT_GT(least.size(), 10u);
  EXPECT_TRUE(std::ranges::is_sorted(least));
  EXPECT_EQ(std::ranges::adjacent_find(least), least.end());
}

void expect_the_same_from_its_kept_file(bool canonical) {
  std::mt19937_64 rng(3);
  std::vector<Vec3> points = made_by(20000, [&](std::size_t i) {
    const double far = i % 500 == 0 ? 100 : 1;
    return Vec3{far * std::uniform_real_distribution<double>(0, 1)(rng), far * 0.01 * static_cast<double>(i % 97),
                i % 700 == 0 ? kNaN : 0};
  });
  const CloudSource<double> cloud(points);
  const TempFolder folder(temp_parent());
  StreamOptions options;
  options.slab_points = 900;
  options.canonical = canonical;
  options.spill = SpillPlace::kept(folder.path() / "stream");
  std::optional<Stream> first(std::in_place, cloud.source, survey(cloud.source, std::nullopt, false), options);
  const Streamed before = streamed(*first);
  const LocalSpacing spacing = first->spacing_in_slabs();
  const std::vector<std::byte> bytes = encoded(*first);
  first.reset();
  Decoder saved(bytes);
  const Stream again(saved, cloud.source, options);
  saved.finish();
  EXPECT_TRUE(same(before, streamed(again)));
  EXPECT_GT(before.nonfinite.size(), 0u);
  EXPECT_EQ(spacing.has_sparse_places(), canonical);  // other streams give sparse places slabs of their own
  for (const Vec3& p : points) {
    if (!is_finite(p)) continue;
    EXPECT_EQ(again.spacing_in_slabs().is_sparse(p), spacing.is_sparse(p));
  }
}

TEST(Stream, IsTheSameFromItsKeptFile) {
  for (const bool canonical : {false, true}) expect_the_same_from_its_kept_file(canonical);
}

/// A source that several threads can read, which counts the rows that were read.
template <class T>
struct SharedSource {
  CloudSource<T> cloud;
  std::atomic<std::uint64_t> rows_read = 0;
  std::chrono::microseconds delay{0};  ///< of each read

  explicit SharedSource(const std::vector<Vec3>& points) : cloud(points) {
    cloud.source.for_thread = [this](const std::vector<std::size_t>&) -> ReadRows {
      return [this](std::uint64_t row, std::span<std::byte> out) {
        const std::size_t n = cloud.source.read(row, out);
        rows_read += n;
        if (delay.count() > 0) std::this_thread::sleep_for(delay);
        return n;
      };
    };
  }
};

std::vector<Vec3> ordered_along_x(std::size_t n, std::size_t run) {
  std::vector<Vec3> points = random_points(n, 8);
  std::ranges::sort(points, {}, &Vec3::x);
  // Shuffles each run of successive points.
  std::mt19937_64 rng(5);
  for (std::size_t first = 0; first < n; first += run)
    std::shuffle(points.begin() + static_cast<std::ptrdiff_t>(first),
                 points.begin() + static_cast<std::ptrdiff_t>(std::min(n, first + run)), rng);
  return points;
}

OnDemandOptions of_blocks(std::uint64_t rows, std::uint64_t most_waiting = 1 << 30) {
  return {.boxes = {}, .block_rows = rows, .read_ahead = 1, .most_waiting = most_waiting};
}

template <class T>
std::optional<Stream> on_demand(const SharedSource<T>& shared, const StreamOptions& options, const OnDemandOptions& how,
                                std::string* why_not = nullptr) {
  std::string reason;
  auto stream = Stream::on_demand(shared.cloud.source, survey(shared.cloud.source, options.axis, false), options, how,
                                  why_not != nullptr ? *why_not : reason);
  return stream;
}

TEST(StreamOnDemand, HoldsEveryPointOnceOrSaysWhyItCannot) {
  std::size_t made = 0;
  rc::check([&] {
    const auto coordinate = rc::gen::map(rc::gen::arbitrary<std::int16_t>(), [](int i) { return i * 1e-3; });
    const auto point = rc::gen::apply(
        [](double x, double y, double z) {
          return Vec3{x, y, z};
        },
        coordinate, coordinate, coordinate);
    const auto points = *rc::gen::container<std::vector<Vec3>>(*rc::gen::inRange<std::size_t>(1, 600), point);
    StreamOptions options = small_options(*rc::gen::inRange(0, 3));
    options.canonical = *rc::gen::arbitrary<bool>();
    const SharedSource<double> shared(points);
    std::string why_not;
    const auto stream = on_demand(shared, options, of_blocks(*rc::gen::inRange(1, 300)), &why_not);
    if (!stream) RC_DISCARD("has to be split");
    ++made;
    if (options.canonical) check(shared.cloud, options, streamed(*stream));
    RC_ASSERT(!testing::Test::HasFailure());
    RC_ASSERT(stream->spilled_bytes() == 0u);
  });
  EXPECT_GT(made, 20u);
}

TEST(StreamOnDemand, HasTheSlabsOfADistribution) {
  for (const bool canonical : {true, false}) {
    for (const std::size_t run_of : {1, 100, 20000}) {
      const SharedSource<float> shared(ordered_along_x(20000, run_of));
      StreamOptions options;
      options.slab_points = 700, options.payload = {3}, options.canonical = canonical;
      options.buffer_bytes = 16 << 20, options.max_slab_points = 20000;
      const auto stream = on_demand(shared, options, of_blocks(97));
      ASSERT_TRUE(stream);
      const Streamed wanted = run(shared.cloud.source, options, survey(shared.cloud.source, options.axis, false));
      EXPECT_TRUE(same(wanted, streamed(*stream))) << canonical << " " << run_of;
    }
  }
}

TEST(StreamOnDemand, DecodesEachBlockOnceWhereSlabsAreReadInOrder) {
  const SharedSource<double> shared(ordered_along_x(20000, 3000));
  StreamOptions options = small_options(0);
  options.slab_points = 500, options.max_slab_points = 2000;
  for (const unsigned threads : {1, 4}) {
    with_threads(threads, [&] {
      const std::uint64_t before = shared.rows_read;
      const auto stream = on_demand(shared, options, of_blocks(64));
      ASSERT_TRUE(stream);
      EXPECT_EQ(shared.rows_read - before, 40000u);  // surveyed and counted
      streamed(*stream);
      EXPECT_EQ(shared.rows_read - before, 60000u);
      streamed(*stream);  // reads all points again, from memory as far as possible
      EXPECT_GT(shared.rows_read - before, 60000u);
      EXPECT_LE(shared.rows_read - before, 80000u);
    });
  }
}

std::vector<std::byte> records_of_slab(const Stream& stream, std::size_t slab) {
  std::vector<std::byte> records(stream.slabs()[slab].count * stream.record_schema().stride);
  stream.read(slab, records);
  return records;
}

TEST(StreamOnDemand, GivesTheSameBytesHoweverOftenAndInWhichOrderSlabsAreRead) {
  const SharedSource<double> shared(ordered_along_x(20000, 5000));
  StreamOptions options = small_options(0);
  options.slab_points = 500, options.max_slab_points = 2000;
  OnDemandOptions how = of_blocks(300, 8000);
  how.read_ahead = 3;
  const auto in_order = on_demand(shared, options, how);
  ASSERT_TRUE(in_order);
  std::vector<std::vector<std::byte>> wanted;
  for (std::size_t s = 0; s < in_order->slabs().size(); ++s) wanted.push_back(records_of_slab(*in_order, s));
  const std::size_t slabs = wanted.size();
  std::vector<std::size_t> any(3 * slabs);
  for (std::size_t i = 0; i < any.size(); ++i) any[i] = i % slabs;
  std::ranges::shuffle(any, std::mt19937(2));
  std::vector<std::size_t> ascending(any), descending(any);
  std::ranges::sort(ascending);
  std::ranges::sort(descending, std::greater());
  for (const auto& order : {any, ascending, descending}) {
    const auto stream = on_demand(shared, options, how);
    for (const std::size_t s : order) ASSERT_EQ(records_of_slab(*stream, s), wanted[s]) << s;
  }
  for (const unsigned threads : {2, 4}) {
    with_threads(threads, [&] {
      const auto stream = on_demand(shared, options, how);
      parallel_for(any.size(), [&](std::size_t i, unsigned) {
        EXPECT_EQ(records_of_slab(*stream, ascending[i]), wanted[ascending[i]]);
      });
      parallel_for(any.size(),
                   [&](std::size_t i, unsigned) { EXPECT_EQ(records_of_slab(*stream, any[i]), wanted[any[i]]); });
    });
  }
}

TEST(StreamOnDemand, ASlabWaitsForBlocksThatOtherThreadsDecode) {
  SharedSource<double> shared(ordered_along_x(6000, 2000));
  StreamOptions options = small_options(0);
  options.slab_points = 500, options.max_slab_points = 2000;
  OnDemandOptions how = of_blocks(250);
  how.read_ahead = 4;
  const auto in_order = on_demand(shared, options, how);
  ASSERT_TRUE(in_order);
  std::vector<std::vector<std::byte>> wanted, got(in_order->slabs().size());
  for (std::size_t slab = 0; slab < got.size(); ++slab) wanted.push_back(records_of_slab(*in_order, slab));
  const auto stream = on_demand(shared, options, how);
  shared.delay = std::chrono::milliseconds(2);
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      try {
        for (std::size_t slab = next++; slab < got.size(); slab = next++) got[slab] = records_of_slab(*stream, slab);
      } catch (const Error& error) {
        ADD_FAILURE() << error.what();
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(got, wanted);
}

TEST(StreamOnDemand, IsRefusedWhereTooManyPointsWouldWait) {
  StreamOptions options = small_options(0);
  options.slab_points = 500, options.max_slab_points = 2000;
  const SharedSource<double> ordered(ordered_along_x(20000, 2000)), random(random_points(20000, 3));
  // With runs of 2,000 points and blocks of 100, at most two runs and a slab are decoded before the first slab is
  // handed over.
  EXPECT_TRUE(on_demand(ordered, options, of_blocks(100, 5000)));
  std::string why_not;
  EXPECT_FALSE(on_demand(ordered, options, of_blocks(100, 1500), &why_not));
  EXPECT_NE(why_not.find("points would wait in memory for the sweep, which has room for 1500"), std::string::npos)
      << why_not;
  EXPECT_FALSE(on_demand(random, options, of_blocks(1000, 19999), &why_not));
  EXPECT_TRUE(on_demand(random, options, of_blocks(1000, 20000)));
}

TEST(StreamOnDemand, IsRefusedForPointsThatNeedMoreThanOneReading) {
  std::vector<Vec3> points = random_points(3000, 3);
  points[77].y = kNaN;
  std::string why_not;
  EXPECT_FALSE(on_demand(SharedSource<double>(points), small_options(0), of_blocks(100), &why_not));
  EXPECT_EQ(why_not, "1 point has no finite coordinates");
  points[77].y = 0;
  for (std::size_t i = 0; i < 1000; ++i) points[i].x = 0.5;
  EXPECT_FALSE(on_demand(SharedSource<double>(points), small_options(0), of_blocks(100), &why_not));
  EXPECT_EQ(why_not, "1000 points lie so close along x that their slab has to be split");
}

TEST(StreamOnDemand, NoticesThatTheInputHasChangedSinceItWasCounted) {
  for (const double moved : {1e6, kNaN}) {
    for (const unsigned threads : {1, 4}) {
      SharedSource<double> shared(ordered_along_x(20000, 2000));
      StreamOptions options = small_options(0);
      options.slab_points = 500, options.max_slab_points = 2000;
      const auto stream = on_demand(shared, options, of_blocks(100));
      ASSERT_TRUE(stream);
      std::memcpy(&shared.cloud.bytes[7000 * shared.cloud.source.schema.stride], &moved, sizeof moved);
      with_threads(threads, [&] {
        try {
          parallel_for(stream->slabs().size(), [&](std::size_t s, unsigned) { records_of_slab(*stream, s); });
          ADD_FAILURE() << "the change was not noticed";
        } catch (const Error& error) {
          EXPECT_NE(std::string(error.what()).find("was written to while it was read"), std::string::npos);
        }
      });
    }
  }
}

TEST(StreamOnDemand, StopsBetweenBlocksWhenItIsCancelled) {
  const SharedSource<double> shared(ordered_along_x(20000, 20000));  // the first slab needs all blocks
  const auto stream = on_demand(shared, small_options(0), of_blocks(100));
  ASSERT_TRUE(stream);
  const std::uint64_t counted = shared.rows_read;
  CancellationToken token;
  token.cancel();
  const CancellationScope scope(&token);
  EXPECT_THROW(records_of_slab(*stream, 0), Cancelled);
  EXPECT_EQ(shared.rows_read, counted);
}

TEST(StreamOnDemand, CanMove) {
  const SharedSource<double> shared(ordered_along_x(5000, 100));
  auto stream = on_demand(shared, small_options(0), of_blocks(50));
  ASSERT_TRUE(stream);
  const Stream moved = std::move(*stream);
  stream.reset();
  check(shared.cloud, small_options(0), streamed(moved));
}

TEST(CutIntoBlocks, CoversAllRowsAndEndsWhereBoxesEnd) {
  const std::vector<RowBox> boxes{{0, 10, {}}, {10, 1, {}}, {11, 25, {}}};
  const std::vector<RowBlock> blocks = cut_into_blocks(100, 10, boxes);
  std::vector<std::uint64_t> ends;
  std::uint64_t row = 0;
  for (const RowBlock& block : blocks) {
    EXPECT_EQ(block.first_row, row);
    EXPECT_LE(block.rows, 10u);
    EXPECT_GT(block.rows, 0u);
    ends.push_back(row += block.rows);
  }
  EXPECT_EQ(row, 100u);
  for (const std::uint64_t end : {10, 11, 36}) EXPECT_TRUE(std::ranges::binary_search(ends, end)) << end;
  EXPECT_TRUE(cut_into_blocks(0, 10, {}).empty());
}

TEST(EstimateWaiting, IsAboutABoxForBoxesInARowAndAllForBoxesThatAllOverlap) {
  std::vector<Vec3> sample = random_points(16000, 1);  // x in [-3, 3]
  std::vector<RowBox> row, one_on_another;
  for (std::uint64_t i = 0; i < 16; ++i) {
    Box box{{-3 + 0.375 * static_cast<double>(i), -2, -1}, {-2.625 + 0.375 * static_cast<double>(i), 2, 1}};
    row.push_back({i * 1000, 1000, box});
    one_on_another.push_back({i * 1000, 1000, {{-3, -2, -1}, {3, 2, 1}}});
  }
  const std::uint64_t in_a_row = estimate_waiting(row, 0, sample, 16000, 100, 1);
  EXPECT_GE(in_a_row, 1000u);
  EXPECT_LE(in_a_row, 2200u);
  EXPECT_GT(estimate_waiting(row, 0, sample, 16000, 100, 20), in_a_row + 1000);
  EXPECT_EQ(estimate_waiting(one_on_another, 0, sample, 16000, 100, 1), 16000u);
  EXPECT_EQ(estimate_waiting(row, 1, sample, 16000, 100, 1), 16000u);  // across the row
  EXPECT_EQ(estimate_waiting(row, 0, {}, 16000, 100, 1), 16000u);
  // One box covers the second half of the row. When the sweep reaches it, the points of the first half have been handed
  // over.
  row.resize(8);
  row.push_back({8000, 8000, {{0, -2, -1}, {3, 2, 1}}});
  EXPECT_NEAR(static_cast<double>(estimate_waiting(row, 0, sample, 16000, 100, 1)), 8000, 300);
}

}  // namespace
}  // namespace pointsweep
