// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/row_alignment.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "pointsweep/math/mix.h"

namespace pointsweep {
namespace {

using Word = std::uint64_t (FieldPair::*)(const std::byte*) const;

std::uint64_t word_of(std::span<const FieldPair> pairs, const std::byte* record, Word word) {
  std::uint64_t all = 0;
  for (const FieldPair& pair : pairs) all = mix(all ^ (pair.*word)(record));
  return all;
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
    const std::span<const std::byte> records = out_.read_block(first_);
    words_.clear();
    for (std::size_t at = 0; at < records.size(); at += out_.schema().stride)
      words_.push_back(word_of(pairs_.of_output(first_ + words_.size()), records.data() + at, &FieldPair::found));
  }

  RowSource& out_;
  FilePairs& pairs_;
  std::uint64_t row_ = 0, first_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace

std::optional<std::uint64_t> RowAlignment::place_of(std::uint64_t row) const {
  const auto at = std::ranges::lower_bound(kept, row);
  if (at == kept.end() || *at != row) return {};
  return static_cast<std::uint64_t>(at - kept.begin());
}

RowAlignment align_rows(RowSource& in, RowSource& out, FilePairs& pairs, const PhaseProgress& progress) {
  RowAlignment alignment;
  OutputWords words(out, pairs);
  for_each_row(in, "comparing", progress, [&](std::uint64_t row, const std::byte* record) {
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
  for_each_row(in, "comparing", progress, [&](std::uint64_t row, const std::byte* record) {
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
  for_each_row(out, "comparing", progress, [&](std::uint64_t row, const std::byte* record) {
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
  std::ranges::sort(rows);
  return rows;
}

std::vector<std::uint64_t> sweep_rows(RowSource& in, std::span<const std::uint64_t> rows, int axis,
                                      const PhaseProgress& progress) {
  const PositionFields position = position_fields(in.schema(), in.name());
  std::vector<std::pair<SweepKey, std::size_t>> sorted;  // key and index of each chosen row
  for_each_record(in, rows, [&](std::size_t i, const std::byte* record) {
    sorted.emplace_back(sweep_key(position_in(position, record), rows[i], axis), i);
  });
  std::ranges::sort(sorted);

  // Counts the points between successive chosen points.
  std::vector<std::uint64_t> between(rows.size() + 1);
  for_each_position(in, "ordering", progress, [&](std::uint64_t row, Vec3 p) {
    const auto after =
        std::ranges::upper_bound(sorted, sweep_key(p, row, axis), {}, &std::pair<SweepKey, std::size_t>::first);
    ++between[static_cast<std::size_t>(after - sorted.begin())];
  });
  std::vector<std::uint64_t> ranks(rows.size());
  std::uint64_t before = 0;
  for (std::size_t s = 0; s < sorted.size(); ++s) ranks[sorted[s].second] = before += between[s];
  // A chosen point is counted in the gap after itself, so its rank includes the chosen points before it.
  return ranks;
}

}  // namespace pointsweep
