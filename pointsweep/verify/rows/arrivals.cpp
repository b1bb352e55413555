// SPDX-License-Identifier: MIT
/// Comparison of all points and attributes of two clouds, row by row and by checksums.
#include <algorithm>

#include "pointsweep/math/mix.h"
#include "pointsweep/verify/rows/row_alignment.h"

namespace pointsweep {
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
      if (i < rows_out) add(pairs_.of_output(first + i), out, sums_out_, points_out_, words_out_, &FieldPair::found);
      if (i < rows_in && i < rows_out && words_in_ != words_out_) note_different(first + i, in, out);
    }
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
