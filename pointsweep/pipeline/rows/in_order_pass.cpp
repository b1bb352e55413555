// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/in_order_pass.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/order/working_record.h"
#include "pointsweep/pipeline/rows/ordered_output.h"
#include "pointsweep/points/promised_type.h"
#include "pointsweep/points/record_map.h"
#include "pointsweep/row_error.h"

namespace pointsweep {
namespace {

/// Largest number of points that an operator gets at a time. A large batch allows it to search for nearby points
/// together (operators/nearest/place_group.h).
constexpr std::size_t kOrderedBatch = 32768;

/// Returns the name of a field for a coordinate of the position. This name contains a blank, unlike all names that the
/// library gives to attributes.
std::string position_name(const char* axis) { return std::string("position ") + axis; }

/// Converts records of a source to records that begin with the place that the operator gives the point.
class Placement {
 public:
  Placement(const Schema& source, const std::vector<std::size_t>& payload, const InOrderOperator& op)
      : position_(position_fields(source, "the input")), stride_(source.stride), op_(op) {
    for (const char* axis : kAxisNames) schema_.append(axis, Type::f64);
    const std::array<const Field*, 3> own = {&position_.x, &position_.y, &position_.z};
    for (std::size_t a = 0; a < 3; ++a) {
      Field field = *own[a];
      field.name = position_name(kAxisNames[a]);
      carried_.append(std::move(field), schema_);
    }
    for (const std::size_t f : payload) carried_.append(source.fields[f], schema_);
  }

  const Schema& schema() const { return schema_; }
  std::uint32_t source_stride() const { return stride_; }

  void run(const std::byte* from, std::size_t n, std::byte* to) const {
    std::vector<double> x(n), y(n), z(n);
    decode_positions(position_, from, stride_, n, x.data(), y.data(), z.data());
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 p{x[i], y[i], z[i]};
      const Vec3 place = is_finite(p) ? op_.place_of(p) : p;
      std::byte* record = to + i * schema_.stride;
      std::memcpy(record, &place, sizeof place);
      carried_.copy(from + i * stride_, record);
    }
  }

 private:
  PositionFields position_;
  std::uint32_t stride_;
  const InOrderOperator& op_;
  Schema schema_;
  RecordMap carried_;
};

/// Returns a function that reads rows by `read` and converts them by `placement`.
ReadRows placing(ReadRows read, std::shared_ptr<const Placement> placement) {
  return [read = std::move(read), placement = std::move(placement), scratch = std::vector<std::byte>()](
             std::uint64_t row, std::span<std::byte> records) mutable {
    const std::size_t n = records.size() / placement->schema().stride;
    scratch.resize(n * placement->source_stride());
    const std::size_t got = read(row, scratch);
    placement->run(scratch.data(), got, records.data());
    return got;
  };
}

/// Converts working records to the OrderedPoints that an InOrderWork takes.
class OrderedBatch {
 public:
  /// `are_placed`: the records begin with a place that is not their position. Rows other than the `rows` rows from
  /// `first_row` on may have values that the stage cannot read.
  OrderedBatch(const Schema& record, const PlannedPass& pass, bool are_placed, std::uint64_t first_row,
               std::uint64_t rows)
      : schema_(record),
        place_(position_fields(record, "the stream")),
        position_(place_),
        first_row_(first_row),
        own_rows_(rows) {
    if (are_placed) {
      const auto field = [&](const char* axis) { return record.fields[record.find(position_name(axis)).value()]; };
      position_ = {field("x"), field("y"), field("z")};
    }
    for (const std::uint16_t column : pass.plan.stages.front().reads)
      for (std::size_t c = 0; c < pass.file_fields.size(); ++c)
        if (pass.plan.file_columns[c].column == column)
          for (const std::string& name : pass.file_fields[c])
            values_of_.emplace_back(record.fields[*record.find(name)], pass.plan.file_columns[c].type);
  }

  /// Throws the error of the lowest row so far with a value that the stage cannot read.
  void require_values() const { refused_.throw_if_any(); }

  /// Returns the points of `n` records, without records whose place is not finite.
  OrderedPoints of(const std::byte* records, std::size_t n) {
    places_.clear(), positions_.clear(), rows_.clear(), values_.clear(), words_.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const std::byte* record = records + i * schema_.stride;
      const Vec3 place = vector_at(place_, record);
      if (!is_finite(place)) continue;
      places_.push_back(place);
      positions_.push_back(vector_at(position_, record));
      rows_.push_back(row_of(schema_, record));
      FirstRowError of_others;
      FirstRowError& refused = rows_.back() - first_row_ < own_rows_ ? refused_ : of_others;
      for (const Value& value : values_of_)
        values_.push_back(value.of(record, rows_.back(), words_.emplace_back(), refused));
    }
    return {places_, positions_, rows_, values_, words_};
  }

 private:
  /// Reads a number from a record and converts it to the type that the contract of the stage names.
  class Value {
   public:
    Value(const Field& stored, Type type) : promised_(stored, type), made_{.name = "", .type = type} {}
    double of(const std::byte* record, std::uint64_t row, std::array<std::byte, 8>& word,
              FirstRowError& refused) const {
      promised_.convert(record, row, word.data(), refused);
      return value_of(made_, word.data());
    }

   private:
    PromisedType promised_;
    Field made_;
  };
  static Vec3 vector_at(const PositionFields& fields, const std::byte* record) {
    return {value_of(fields.x, record), value_of(fields.y, record), value_of(fields.z, record)};
  }

  const Schema& schema_;
  PositionFields place_, position_;
  std::uint64_t first_row_, own_rows_;
  std::vector<Value> values_of_;
  std::vector<Vec3> places_, positions_;
  std::vector<std::uint64_t> rows_;
  std::vector<double> values_;
  std::vector<std::array<std::byte, 8>> words_;
  FirstRowError refused_;
};

/// Passes all points of the stream with a finite place to `use` in order, at most kOrderedBatch at a time. Then throws
/// the error of the lowest row of the results with a value that the stage cannot read.
template <class Use>
void for_each_batch(const InOrderPass& run, Use use) {
  const std::size_t stride = run.stream.record_schema().stride;
  OrderedBatch batch(run.stream.record_schema(), run.pass, run.pass.has_places(), run.first_row, run.rows);
  const auto take = [&](std::span<const std::byte> records) {
    for (std::size_t at = 0; at < records.size(); at += kOrderedBatch * stride) {
      stop_if_cancelled();
      const std::size_t n = std::min(kOrderedBatch, (records.size() - at) / stride);
      use(batch.of(records.data() + at, n));
    }
  };
  write_in_order(run.stream, stride, take, run.progress);
  batch.require_values();
}

/// Converts the findings of an InOrderWork to result records, which contain the attributes PlannedPass::made, and
/// stores them in the results.
class FoundRecords {
 public:
  FoundRecords(const InOrderOperator& op, const InOrderPass& run)
      : run_(run), filled_(run.pass.fill_record()), dropped_(filled_) {
    const std::vector<Attribute> made = op.in_order_contract().makes;
    value_bytes_ = bytes_of(made);
    std::size_t to = 0;
    for (const Attribute& kept : run.pass.made) {
      if (kept.name == selection_attribute().name)
        dropped_[to] = std::byte{0};
      else
        kept_.add(offset_in(made, kept.name).value(), to, kept.bytes());
      to += kept.bytes();
    }
  }

  void put(Findings& found) {
    RowStore& results = run_.results;
    keep_own_rows(found);
    records_.clear();
    for (std::size_t i = 0; i < found.dropped.size(); ++i)
      records_.insert(records_.end(), dropped_.begin(), dropped_.end());
    results.put(found.dropped, records_);
    results.put(found.rows, values_of(found));
    found.dropped.clear(), found.rows.clear(), found.values.clear();
  }

 private:
  /// If the stream is one tile with points around it, removes the findings about rows of other tiles, numbers the rows
  /// of the tile like the results, and adds the number of undecided rows of the tile to InOrderPass::undecided.
  void keep_own_rows(Findings& found) const {
    if (!run_.is_part) return;
    const auto is_other = [&](std::uint64_t row) { return row - run_.first_row >= run_.rows; };
    std::erase_if(found.dropped, is_other);
    std::erase_if(found.undecided, is_other);
    if (run_.undecided != nullptr) *run_.undecided += found.undecided.size();
    found.undecided.clear();
    for (std::uint64_t& row : found.dropped) row -= run_.first_row;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found.rows.size(); ++i) {
      if (is_other(found.rows[i])) continue;
      found.rows[kept] = found.rows[i] - run_.first_row;
      std::memmove(found.values.data() + kept++ * value_bytes_, found.values.data() + i * value_bytes_, value_bytes_);
    }
    found.rows.resize(kept);
    found.values.resize(kept * value_bytes_);
  }

  std::span<const std::byte> values_of(const Findings& found) {
    if (filled_.size() == value_bytes_ && kept_.copies_whole(value_bytes_)) return found.values;
    records_.clear();
    for (std::size_t i = 0; i < found.rows.size(); ++i) {
      records_.insert(records_.end(), filled_.begin(), filled_.end());
      kept_.copy(found.values.data() + i * value_bytes_, records_.data() + i * filled_.size());
    }
    return records_;
  }

  const InOrderPass& run_;
  RecordMap kept_;  ///< copies kept attributes from the values of a finding
  std::size_t value_bytes_ = 0;
  std::vector<std::byte> filled_, dropped_, records_;
};

}  // namespace

PlacedSource::PlacedSource(const PointSource& from, const std::vector<std::size_t>& fields, const InOrderOperator& op) {
  const auto placement = std::make_shared<const Placement>(from.schema, fields, op);
  source = {placement->schema(), from.count, placing(from.read, placement)};
  if (from.for_thread) {
    std::vector<std::size_t> wanted = fields;
    for (const std::size_t axis : position_columns(from.schema)) wanted.push_back(axis);
    source.for_thread = [make = from.for_thread, wanted, placement](const std::vector<std::size_t>&) -> ReadRows {
      ReadRows own = make(wanted);
      return own ? placing(std::move(own), placement) : ReadRows();
    };
  }
  source.chunk_end = from.chunk_end;
  for (std::size_t f = kAxisNames.size(); f < source.schema.fields.size(); ++f) payload.push_back(f);
}

std::vector<std::uint32_t> for_other_parts(const InOrderOperator::ChoosePoints& choose, const PlannedPass& pass,
                                           const Schema& record, std::span<const std::byte> records) {
  OrderedBatch batch(record, pass, false, 0, ~std::uint64_t{0});
  const OrderedPoints points = batch.of(records.data(), records.size() / record.stride);
  batch.require_values();
  return choose(points);
}

std::string run_in_order(const InOrderPass& run) {
  const InOrderOperator& op = *run.pass.in_order();
  const std::unique_ptr<InOrderWork> work = op.start(run.setup);
  FoundRecords records(op, run);
  Findings found;
  for (unsigned round = 0; round < work->rounds(); ++round) {
    for_each_batch(run, [&](const OrderedPoints& points) {
      work->add(round, points, found);
      records.put(found);
    });
    work->end(round, found);
    records.put(found);
  }
  return work->warning();
}

}  // namespace pointsweep
