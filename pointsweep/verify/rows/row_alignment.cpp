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
  // upper_bound() counts a chosen point in the gap after this point, so a rank includes the chosen points before it.
  return ranks;
}

namespace {

class Comparison {
 public:
  Comparison(RowSource& in, RowSource& out, const std::vector<bool>& replaced, const OutputWays& ways)
      : in_(in), out_(out), pairs_(comparable_pairs(replaced, ways)) {
    result_.points_in = in.count();
    result_.points_out = out.count();
    for (const FieldPair& pair : pairs_.all()) result_.attributes.push_back({.name = pair.name()});
    const std::size_t n = pairs_.all().size();
    sums_in_.resize(n), sums_out_.resize(n);
    words_in_.resize(n), words_out_.resize(n);
    if (in.count() != out.count()) result_.first_different = std::min(in.count(), out.count());
  }

  Arrivals run(const PhaseProgress& progress, const std::function<void(std::uint64_t, Vec3)>& look) {
    const std::uint64_t rows = std::max(in_.count(), out_.count());
    const std::size_t block = std::min(in_.block_rows(), out_.block_rows());
    for (std::uint64_t first = 0; first < rows; first += block) {
      compare(first, std::min<std::uint64_t>(block, rows - first), look);
      if (progress) progress("comparing", std::min(first + block, rows), rows);
    }
    for (std::size_t p = 0; p < result_.attributes.size(); ++p) {
      result_.attributes[p].sum_in = sums_in_[p].sum();
      result_.attributes[p].sum_out = sums_out_[p].sum();
    }
    result_.sum_in = points_in_.sum();
    result_.sum_out = points_out_.sum();
    return std::move(result_);
  }

 private:
  /// Pairs the fields of the input with those of the output, and notes the fields that the output lacks.
  FilePairs comparable_pairs(const std::vector<bool>& replaced, const OutputWays& ways) {
    std::vector<FieldPair> all;
    for (std::size_t f = 0; f < in_.schema().fields.size(); ++f) {
      if (replaced[f]) continue;
      const Field& field = in_.schema().fields[f];
      if (auto pairs = pairs_of_field(in_.schema(), f, out_.schema(), ways.places, ways.stored_name)) {
        all.insert(all.end(), pairs->begin(), pairs->end());
      } else if (ways.own_field != nullptr && ways.own_field(field.name) == 0 && field.count == 1) {
        absent_.push_back(field);
      } else {
        result_.missing.push_back(field.name);
      }
    }
    return {in_, out_, ways.in_any_order, std::move(all)};
  }

  static std::size_t rows_of(const RowSource& source, std::uint64_t first, std::size_t n) {
    return first >= source.count() ? 0 : std::min<std::uint64_t>(n, source.count() - first);
  }

  void compare(std::uint64_t first, std::size_t n, const std::function<void(std::uint64_t, Vec3)>& look) {
    const std::size_t rows_in = rows_of(in_, first, n), rows_out = rows_of(out_, first, n);
    const std::byte* in = in_.read(first, rows_in).data();
    const std::byte* out = out_.read(first, rows_out).data();
    decode(in_, in, rows_in);
    for (std::size_t i = 0; i < rows_in; ++i) see_input(first + i, {x_[i], y_[i], z_[i]}, look);
    look_for_absent(in, rows_in);
    decode(out_, out, rows_out);
    for (std::size_t i = 0; i < rows_out; ++i) follow_order({x_[i], y_[i], z_[i]});
    for (std::size_t i = 0; i < n; ++i, in += in_.schema().stride, out += out_.schema().stride) {
      if (i < rows_in) add(pairs_.of_input(first + i), in, sums_in_, points_in_, words_in_, &FieldPair::expected);
      if (i < rows_in) note_rounding(first + i, in);
      if (i < rows_out) add(pairs_.of_output(first + i), out, sums_out_, points_out_, words_out_, &FieldPair::found);
      if (i < rows_in && i < rows_out && words_in_ != words_out_) note_different(first + i, in, out);
    }
  }

  void note_rounding(std::uint64_t row, const std::byte* in) {
    const std::span<const FieldPair> pairs = pairs_.of_input(row);
    for (std::size_t p = 0; p < pairs.size(); ++p)
      if (pairs[p].is_coordinate())
        result_.attributes[p].rounded_by = std::max(result_.attributes[p].rounded_by, pairs[p].rounding(in));
  }

  /// Moves fields with a value other than 0 from `absent_` to the missing attributes: an output may lack a field of its
  /// format only if all values are 0.
  void look_for_absent(const std::byte* records, std::size_t n) {
    std::erase_if(absent_, [&](const Field& field) {
      for (std::size_t i = 0; i < n; ++i)
        if (value_of(field, records + i * in_.schema().stride) != 0) {
          result_.missing.push_back(field.name);
          return true;
        }
      return false;
    });
  }

  void decode(const RowSource& source, const std::byte* records, std::size_t n) {
    x_.resize(n), y_.resize(n), z_.resize(n);
    decode_positions(position_fields(source.schema(), source.name()), records, source.schema().stride, n, x_.data(),
                     y_.data(), z_.data());
  }

  void see_input(std::uint64_t row, Vec3 p, const std::function<void(std::uint64_t, Vec3)>& look) {
    is_finite(p) ? result_.bounds.include(p) : void(++result_.nonfinite);
    look(row, p);
  }

  void follow_order(Vec3 p) {
    const bool finite = is_finite(p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      if (finite && (met_nonfinite_ || p[a] < last_[a])) result_.ascending[axis] = false;
    }
    finite ? void(last_ = p) : void(met_nonfinite_ = true);
  }

  static void add(std::span<const FieldPair> pairs, const std::byte* record, std::vector<MultisetSum>& sums,
                  MultisetSum& points, std::vector<std::uint64_t>& words,
                  std::uint64_t (FieldPair::*word)(const std::byte*) const) {
    std::uint64_t whole = 0;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      words[p] = (pairs[p].*word)(record);
      sums[p].add(words[p]);
      whole = mix(whole ^ words[p]);
    }
    points.add(whole);
  }

  void note_different(std::uint64_t row, const std::byte* in, const std::byte* out) {
    result_.first_different = std::min(row, result_.first_different.value_or(row));
    ++result_.rows_different;
    for (std::size_t p = 0; p < result_.attributes.size(); ++p) {
      AttributeArrival& attribute = result_.attributes[p];
      if (words_in_[p] == words_out_[p] || ++attribute.rows_different > 1) continue;
      attribute.first_different = row;
      attribute.expected = pairs_.all()[p].expected_value(in);
      attribute.found = pairs_.all()[p].found_value(out);
    }
  }

  RowSource& in_;
  RowSource& out_;
  std::vector<Field> absent_;  ///< fields of the input that the output lacks; all values must be 0
  Arrivals result_;
  FilePairs pairs_;
  std::vector<MultisetSum> sums_in_, sums_out_;  ///< sums over the values of each pair of fields
  MultisetSum points_in_, points_out_;
  std::vector<std::uint64_t> words_in_, words_out_;  ///< hashes of the current row, for each pair
  std::vector<double> x_, y_, z_;
  Vec3 last_{-Box::kInf, -Box::kInf, -Box::kInf};
  bool met_nonfinite_ = false;
};

}  // namespace

Arrivals compare_arrivals(RowSource& in, RowSource& out, const std::vector<bool>& replaced, const OutputWays& ways,
                          const PhaseProgress& progress, const std::function<void(std::uint64_t, Vec3)>& look) {
  return Comparison(in, out, replaced, ways).run(progress, look);
}

}  // namespace pointsweep
