// SPDX-License-Identifier: MIT
#include "pointsweep/operators/change/take_work.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/operators/nearest/point_cells.h"
#include "pointsweep/operators/nearest/point_records.h"
#include "pointsweep/operators/statistics/statistics_of_values.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/points/with_type.h"
#include "pointsweep/row_error.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// The result of a vote: `whole` if `is_whole`, else `real`.
struct VotedValue {
  bool is_whole = false;
  WholeNumber whole = 0;
  double real = 0;

  double number() const { return is_whole ? static_cast<double>(whole) : real; }
};

/// The factor between a colour channel of 8 bits and a channel of 16 bits with the same brightness: 65535 / 255.
constexpr int kWideOfNarrow = 257;

template <class Value>
VotedValue voted(Value value) {
  if constexpr (std::is_integral_v<Value>)
    return {.is_whole = true, .whole = value};
  else
    return {.real = value};
}

/// Combines values that are stored as T. Computes with Value: float64 or a whole number of 64 bits.
template <class T, class Value>
std::optional<VotedValue> vote_of(TakeVote vote, const std::byte* first, std::size_t count, std::size_t stride) {
  const auto value = [&](std::size_t i) {
    T stored;
    std::memcpy(&stored, first + i * stride, sizeof stored);
    return static_cast<Value>(stored);
  };
  if (count == 0) return std::nullopt;
  if (vote == TakeVote::nearest || (vote == TakeVote::majority && count == 1)) return voted(value(0));
  thread_local std::vector<Value> values, sorted;
  values.clear();
  for (std::size_t i = 0; i < count; ++i)
    if (std::is_integral_v<Value> || std::isfinite(static_cast<double>(value(i)))) values.push_back(value(i));
  const std::span<const Value> list = values;
  if (list.empty()) return std::nullopt;
  if (vote == TakeVote::mean) return VotedValue{.real = mean_of(list)};
  return voted(majority_of(list, sorted));
}

/// Converts a colour channel from 8 to 16 bits, or from 16 to 8 with rounding, so that its brightness is kept. With
/// other types the value is unchanged.
VotedValue with_brightness(VotedValue value, Type from, Type to) {
  if (from == Type::u8 && to == Type::u16) {
    value.whole *= kWideOfNarrow, value.real *= kWideOfNarrow;
  } else if (from == Type::u16 && to == Type::u8) {
    value = {.real = std::nearbyint(value.number() / kWideOfNarrow)};
  }
  return value;
}

template <class T>
std::optional<T> as_type(const VotedValue& value, const TargetRange& range, bool rounds) {
  if constexpr (std::is_integral_v<T>) {
    if (value.is_whole) return whole_in<T>(range, value.whole);
    const double whole = std::nearbyint(value.real);
    if (!rounds && whole != value.real) return std::nullopt;
    return whole_in<T>(range, whole);
  } else {
    const auto number = static_cast<T>(value.number());
    const bool fits = value.is_whole ? static_cast<WholeNumber>(number) == value.whole
                                     : std::isfinite(number) || !std::isfinite(value.real);
    return fits ? std::optional(number) : std::nullopt;
  }
}

/// Returns the result of the vote over the values of `taken` in `records`, which are `record_bytes` apart, nearest
/// point first. Returns nullopt if there is no record or no value votes: NaN and infinite values have no vote, except
/// that `nearest`, and `majority` over one record, take any value unchanged. A colour gets the range of its target; 16
/// bits are rounded to 8 bits, halves to even.
std::optional<VotedValue> voted_value(const TakenAttribute& taken, TakeVote vote, std::span<const std::byte> records,
                                      std::size_t record_bytes) {
  const std::size_t count = records.size() / record_bytes;
  std::optional<VotedValue> value = with_type(taken.source.type, [&]<class T>() {
    using Value = std::conditional_t<std::is_floating_point_v<T>, double,
                                     std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>>;
    return vote_of<T, Value>(vote, records.data() + taken.from, count, record_bytes);
  });
  if (value && taken.is_color) value = with_brightness(*value, taken.source.type, taken.range.type);
  return value;
}

/// Writes the value into a made record; whole numbers stay exact. Returns false for a value that the attribute cannot
/// hold. `rounds`: true if fractions are rounded for whole-number types, halves to even.
bool put_value(const VotedValue& value, const TakenAttribute& taken, bool rounds, std::byte* record) {
  return with_type(taken.range.type, [&]<class T>() {
    const std::optional<T> stored = as_type<T>(value, taken.range, rounds);
    if (stored) std::memcpy(record + taken.to, &*stored, sizeof *stored);
    return stored.has_value();
  });
}

/// TakeWork finds the nearest points of a block of points, and then reads their values. kFoundAtOnce: about the number
/// of nearest points of a block. kLeastPlaces: least number of points that a block may have, since large k would make
/// blocks too small.
constexpr std::uint64_t kFoundAtOnce = 1 << 18, kLeastPlaces = 4096;
/// Number of points to which a thread gives values at a time.
constexpr std::size_t kTakenAtOnce = 1024;

std::uint64_t places_at_once(std::uint64_t k) { return std::max(kFoundAtOnce / k, kLeastPlaces); }

/// Returns the bytes of the numbers of the nearest points of a block of points, and of their values.
std::uint64_t found_bytes(std::uint64_t k, std::uint64_t value_bytes) {
  return places_at_once(k) * k * (sizeof(std::uint64_t) + value_bytes);
}

/// Takes values from the nearest points. Points of the other cloud are numbered as they come; coincident points come in
/// the order of their rows. So ties by number give the same points as ties by row, and the number of a point is also
/// the number of its record of values.
class TakeWork final : public InOrderWork {
 public:
  TakeWork(TakeRules rules, std::uint64_t value_bytes, const InOrderSetup& setup)
      : rules_(std::move(rules)),
        k_(static_cast<std::size_t>(rules_.options.k)),
        value_bytes_(value_bytes),
        other_(PointCells::Space::all, setup.axis, share(setup, sizeof(CellPoint)), setup.make_scratch()),
        values_(value_bytes_, share(setup, value_bytes_), setup.make_scratch()) {
    if (rules_.options.most) most2_ = *rules_.options.most * *rules_.options.most;
    for (const TakeTarget& target : rules_.targets) made_bytes_ += target.made.bytes();
    std::uint64_t number = 0;
    setup.other_points([&](const OtherPoints& points) {
      for (const Vec3 position : points.positions) other_.add(position, number++);
      values_.add(points.values);
    });
    other_.finish();
    values_.finish();
    if (number == 0)
      fail("{}: {} has no point with a finite place, so there is nothing to take.", rules_.place, rules_.options.cloud);
  }

  void add(unsigned, const OrderedPoints& points, Findings& findings) override {
    const auto most = static_cast<std::size_t>(places_at_once(k_));
    for (std::size_t first = 0; first < points.rows.size(); first += most)
      take(points, first, std::min(most, points.rows.size() - first), findings);
  }
  void end(unsigned, Findings&) override { refused_.throw_if_any(); }

 private:
  /// Returns the memory for data that take `bytes` per point of the other cloud: positions and values share the memory
  /// in proportion to their sizes.
  std::uint64_t share(const InOrderSetup& setup, std::uint64_t bytes) const {
    const std::uint64_t found = found_bytes(k_, value_bytes_);
    const std::uint64_t left = setup.memory_bytes - std::min(setup.memory_bytes, found);
    return left / (sizeof(CellPoint) + value_bytes_) * bytes;
  }

  void take(const OrderedPoints& points, std::size_t first, std::size_t count, Findings& findings) {
    numbers_.assign(count * k_, PointRecords::kNone);
    found_.resize(numbers_.size() * value_bytes_);
    other_.nearest_of_all(points.positions.subspan(first, count), {.k = k_, .most2 = most2_},
                          [&](std::size_t i, const std::vector<CellNeighbor>& nearest) {
                            for (std::size_t j = 0; j < nearest.size(); ++j) numbers_[i * k_ + j] = nearest[j].row;
                          });
    values_.gather(numbers_, found_);
    const std::span<const std::uint64_t> rows = points.rows.subspan(first, count);
    findings.rows.insert(findings.rows.end(), rows.begin(), rows.end());
    const std::size_t made_before = findings.values.size();
    findings.values.resize(made_before + count * made_bytes_);
    std::vector<FirstRowError> refused(count / kTakenAtOnce + 1);
    parallel_for_blocks(count, kTakenAtOnce, [&](std::size_t begin, std::size_t n, unsigned) {
      for (std::size_t i = begin; i < begin + n; ++i) {
        std::byte* const record = findings.values.data() + made_before + i * made_bytes_;
        put_old_values(points, first + i, record);
        put_taken_values(i, rows[i], record, refused[begin / kTakenAtOnce]);
      }
    });
    for (const FirstRowError& part : refused) refused_.note(part);
  }

  /// Stores the previous values of the point in `record`; for new attributes, Attribute::fill.
  void put_old_values(const OrderedPoints& points, std::size_t point, std::byte* record) const {
    const std::size_t reads = points.rows.empty() ? 0 : points.words.size() / points.rows.size();
    std::size_t read = point * reads;
    for (const TakeTarget& target : rules_.targets) {
      if (!target.old) {
        std::memset(record, static_cast<int>(target.made.fill), target.made.bytes());
      } else {
        const Field before{.name = "", .type = target.old->type}, after{.name = "", .type = target.made.type};
        for (std::uint32_t c = 0; c < target.made.fields.size(); ++c, ++read) {
          const std::byte* const word = points.words[read].data();
          if (before.type == after.type)
            std::memcpy(record + c * size_of(after.type), word, size_of(after.type));
          else
            set_value(after, record, value_of(before, word), c);
        }
      }
      record += target.made.bytes();
    }
  }

  void put_taken_values(std::size_t i, std::uint64_t row, std::byte* record, FirstRowError& refused) const {
    const std::span<const std::uint64_t> numbers = std::span(numbers_).subspan(i * k_, k_);
    const auto count = static_cast<std::size_t>(std::ranges::find(numbers, PointRecords::kNone) - numbers.begin());
    const std::span<const std::byte> records = std::span(found_).subspan(i * k_ * value_bytes_, count * value_bytes_);
    const TakeOptions& options = rules_.options;
    for (const TakenAttribute& taken : rules_.taken) {
      std::optional<VotedValue> value = voted_value(taken, options.vote, records, value_bytes_);
      if (!value && options.missing) value = {.real = *options.missing};
      if (!value || put_value(*value, taken, options.vote == TakeVote::mean, record)) continue;
      refused.note(row, [&] { return refusal(taken, value->number()); });
    }
  }

  RowSentence refusal(const TakenAttribute& taken, double value) const {
    return {fmt::format("{}: row ", rules_.place),
            fmt::format(": '{0}' would be {1}, which is not {2}; drop({0}) before lets it have the type of {3}.",
                        taken.name, value, taken.range.text(), rules_.options.cloud)};
  }

  const TakeRules rules_;
  const std::size_t k_, value_bytes_;
  std::size_t made_bytes_ = 0;
  double most2_ = std::numeric_limits<double>::infinity();
  PointCells other_;
  PointRecords values_;
  std::vector<std::uint64_t> numbers_;  ///< numbers of the k nearest points of each point
  std::vector<std::byte> found_;        ///< values of the points in numbers_
  FirstRowError refused_;
};

}  // namespace

std::unique_ptr<InOrderWork> start_taking(TakeRules rules, const InOrderSetup& setup) {
  std::uint64_t value_bytes = 0;
  for (const TakenAttribute& taken : rules.taken) value_bytes += taken.source.bytes();
  return std::make_unique<TakeWork>(std::move(rules), value_bytes, setup);
}

std::uint64_t least_taking_bytes(std::uint64_t k, std::uint64_t value_bytes) {
  return PointCells::least_bytes() + PointRecords::least_bytes(value_bytes) + found_bytes(k, value_bytes);
}

}  // namespace pointsweep
