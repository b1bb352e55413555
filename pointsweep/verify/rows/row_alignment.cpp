// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/row_alignment.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {
namespace {

using Word = std::uint64_t (FieldPair::*)(const std::byte*) const;

std::uint64_t word_of(std::span<const FieldPair> pairs, const std::byte* record, Word word) {
  std::uint64_t all = 0;
  for (const FieldPair& pair : pairs) all = mix(all ^ (pair.*word)(record));
  return all;
}

/// Calls use(row, record) for each row.
template <class Use>
void for_each_row(RowSource& source, const PhaseProgress& progress, Use use) {
  for (std::uint64_t first = 0; first < source.count();) {
    stop_if_cancelled();
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(source.block_rows(), source.count() - first));
    const std::span<const std::byte> records = source.read(first, n);
    for (std::size_t i = 0; i < n; ++i) use(first + i, records.data() + i * source.schema().stride);
    first += n;
    if (progress) progress("comparing", first, source.count());
  }
}

/// A sequential reader of the hashes of the output's rows.
class OutputWords {
 public:
  OutputWords(RowSource& out, FilePairs& pairs) : out_(out), pairs_(pairs) { fill(); }
  bool ends() const { return row_ == out_.count(); }
  std::uint64_t row() const { return row_; }
  std::uint64_t word() const { return words_[row_ - first_]; }
  void step() {
    if (++row_ == first_ + words_.size()) fill();
  }

 private:
  void fill() {
    first_ = row_;
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(out_.block_rows(), out_.count() - first_));
    const std::span<const std::byte> records = out_.read(first_, n);
    words_.clear();
    for (std::size_t i = 0; i < n; ++i)
      words_.push_back(
          word_of(pairs_.of_output(first_ + i), records.data() + i * out_.schema().stride, &FieldPair::found));
  }

  RowSource& out_;
  FilePairs& pairs_;
  std::uint64_t row_ = 0, first_ = 0;
  std::vector<std::uint64_t> words_;
};

struct PlaceInOrder {
  bool nonfinite;
  std::array<double, 4> key;  ///< coordinate on the axis, x, y, z
  std::uint64_t row;

  friend bool operator<(const PlaceInOrder& a, const PlaceInOrder& b) {
    if (a.nonfinite != b.nonfinite) return b.nonfinite;
    if (!a.nonfinite && a.key != b.key) return a.key < b.key;
    return a.row < b.row;
  }
};

PlaceInOrder place_of(Vec3 p, std::uint64_t row, int axis) { return {!is_finite(p), {p[axis], p.x, p.y, p.z}, row}; }

}  // namespace

std::optional<std::uint64_t> RowAlignment::place_of(std::uint64_t row) const {
  const auto at = std::ranges::lower_bound(kept, row);
  if (at == kept.end() || *at != row) return {};
  return static_cast<std::uint64_t>(at - kept.begin());
}

RowAlignment align_rows(RowSource& in, RowSource& out, FilePairs& pairs, const PhaseProgress& progress) {
  RowAlignment alignment;
  OutputWords words(out, pairs);
  for_each_row(in, progress, [&](std::uint64_t row, const std::byte* record) {
    if (words.ends() || words.word() != word_of(pairs.of_input(row), record, &FieldPair::expected)) return;
    alignment.kept.push_back(row);
    words.step();
  });
  if (!words.ends()) alignment.not_of_input = words.row();
  return alignment;
}

std::vector<std::uint64_t> sample_of_both(const RowAlignment& alignment, std::uint64_t count, std::uint64_t size,
                                          std::uint64_t seed) {
  const std::vector<std::uint64_t>& kept = alignment.kept;
  const std::uint64_t left_out = count - kept.size();
  const std::uint64_t of_kept = std::min<std::uint64_t>(kept.size(), size - std::min(size / 2, left_out));
  std::vector<std::uint64_t> rows;
  for (const std::uint64_t i : sample_rows(kept.size(), of_kept, seed)) rows.push_back(kept[i]);
  std::uint64_t before = 0;  // number of rows of the output before the i-th dropped row
  for (const std::uint64_t i : sample_rows(left_out, size - of_kept, seed)) {
    while (before < kept.size() && kept[before] - before <= i) ++before;
    rows.push_back(i + before);
  }
  return rows;
}

std::vector<std::uint64_t> rows_with_twins(RowSource& in, const RowAlignment& alignment, FilePairs& pairs,
                                           std::span<const std::uint64_t> rows, const PhaseProgress& progress) {
  const std::size_t stride = in.schema().stride;
  std::vector<std::string> records;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> of_word;  // indices in `rows` by the hash of the row
  std::vector<bool> has_twin(rows.size());
  for_each_record(in, rows, [&](std::size_t i, const std::byte* record) {
    records.emplace_back(reinterpret_cast<const char*>(record), stride);
    of_word[word_of(pairs.of_input(rows[i]), record, &FieldPair::expected)].push_back(i);
  });
  for_each_row(in, progress, [&](std::uint64_t row, const std::byte* record) {
    const auto same = of_word.find(word_of(pairs.of_input(row), record, &FieldPair::expected));
    if (same == of_word.end()) return;
    for (const std::size_t i : same->second)
      if (alignment.has(row) != alignment.has(rows[i]) && std::memcmp(record, records[i].data(), stride) != 0)
        has_twin[i] = true;
  });
  std::vector<std::uint64_t> twins;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (has_twin[i]) twins.push_back(rows[i]);
  return twins;
}

std::optional<std::vector<PossibleRows>> rows_with_values(RowSource& in, RowSource& out, FilePairs& pairs,
                                                          std::span<const std::uint64_t> rows,
                                                          const PhaseProgress& progress) {
  std::vector<std::uint64_t> words(rows.size());
  std::unordered_map<std::uint64_t, PossibleRows> of_word;
  for_each_record(in, rows, [&](std::size_t i, const std::byte* record) {
    words[i] = word_of(pairs.of_input(rows[i]), record, &FieldPair::expected);
    of_word[words[i]];
  });
  for_each_row(out, progress, [&](std::uint64_t row, const std::byte* record) {
    const auto at = of_word.find(word_of(pairs.of_output(row), record, &FieldPair::found));
    if (at == of_word.end()) return;
    if (at->second.count++ < kMostPossibleRows) at->second.rows.push_back(row);
  });
  std::vector<PossibleRows> possible;
  for (const std::uint64_t word : words) {
    possible.push_back(of_word[word]);
    if (possible.back().count == 0) return std::nullopt;
  }
  return possible;
}

std::vector<std::uint64_t> sample_rows(std::uint64_t count, std::uint64_t size, std::uint64_t seed) {
  std::vector<std::uint64_t> rows;
  if (size >= count) {
    rows.resize(count);
    std::iota(rows.begin(), rows.end(), std::uint64_t{0});
    return rows;
  }
  // Floyd's algorithm (Bentley and Floyd, "A sample of brilliance", 1987): one draw for each row that is chosen.
  std::unordered_set<std::uint64_t> chosen;
  for (std::uint64_t last = count - size; last < count; ++last) {
    const std::uint64_t draw = mix(mix(seed) ^ last) % (last + 1);
    if (!chosen.insert(draw).second) chosen.insert(last);
  }
  rows.assign(chosen.begin(), chosen.end());
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::vector<std::uint64_t> sweep_rows(RowSource& in, std::span<const std::uint64_t> rows, int axis,
                                      const PhaseProgress& progress) {
  const PositionFields position = position_fields(in.schema(), in.name());
  std::vector<PlaceInOrder> places(rows.size());
  for_each_record(in, rows, [&](std::size_t i, const std::byte* record) {
    places[i] = place_of({value_of(position.x, record), value_of(position.y, record), value_of(position.z, record)},
                         rows[i], axis);
  });
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return places[a] < places[b]; });
  std::vector<PlaceInOrder> sorted;
  for (const std::size_t i : order) sorted.push_back(places[i]);

  // Counts the points between successive chosen points.
  std::vector<std::uint64_t> between(rows.size() + 1);
  for_each_position(in, "ordering", progress, [&](std::uint64_t row, Vec3 p) {
    ++between[std::upper_bound(sorted.begin(), sorted.end(), place_of(p, row, axis)) - sorted.begin()];
  });
  std::vector<std::uint64_t> ranks(rows.size());
  std::uint64_t before = 0;
  for (std::size_t s = 0; s < order.size(); ++s) ranks[order[s]] = before += between[s];
  // A chosen point is counted in the gap after itself, so its rank includes the chosen points before it.
  return ranks;
}

}  // namespace pointsweep
