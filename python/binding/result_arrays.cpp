// SPDX-License-Identifier: MIT
#include "python/binding/result_arrays.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "pointsweep/fail.h"
#include "pointsweep/points/record_map.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/storage/local/temp_folder.h"

namespace nb = nanobind;

namespace pointsweep {
namespace {

nb::dlpack::dtype dtype_of(Type type) {
  using enum nb::dlpack::dtype_code;
  const bool is_float = type == Type::f32 || type == Type::f64;
  const bool is_signed = type == Type::i8 || type == Type::i16 || type == Type::i32 || type == Type::i64;
  const auto code = is_float ? Float : is_signed ? Int : UInt;
  return {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(8 * size_of(type)), 1};
}

/// Returns whether the fields are contiguous in a record and have the type of the array, so that a row is copied as
/// bytes.
bool is_one_piece(const std::vector<Field>& fields) {
  std::uint32_t next = fields.front().offset;
  return std::ranges::all_of(fields, [&](const Field& field) {
    const bool follows = field.is_plain() && field.offset == next && field.type == fields.front().type;
    next += static_cast<std::uint32_t>(size_of(field.type)) * field.count;
    return follows;
  });
}

}  // namespace

Type result_type(const Field& field) {
  if (field.is_plain()) return field.type;
  if (field.scale != 1 || field.bias != 0) return Type::f64;
  return field.bit_width <= 8 ? Type::u8 : field.bit_width <= 16 ? Type::u16 : Type::u32;
}

nb::object numpy_array(ArrayMemory memory, const std::vector<std::size_t>& shape, Type type) {
  std::byte* const bytes = memory.bytes.release();
  nb::capsule owner(bytes, [](void* held) noexcept { delete[] static_cast<std::byte*>(held); });
  return nb::cast(
      nb::ndarray<nb::numpy>(bytes, shape.size(), shape.data(), owner, /*strides=*/nullptr, dtype_of(type)));
}

/// Copies the fields of each record to the rows of the arrays.
class ResultArrays::Collector final : public Writer {
 public:
  Collector(ResultArrays& results, std::size_t stride) : results_(results), stride_(stride) {}

  void write(std::span<const std::byte> records) override { write_at(next_row_, records); }
  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override {
    const std::size_t rows = records.size() / stride_;
    if (row > results_.rows_ || rows > results_.rows_ - row)
      fail("more points came than the {} that were announced.", results_.rows_);
    for (Array& array : results_.arrays_) {
      const std::size_t bytes = array.row_bytes();
      if (array.first != nullptr) {
        copy(array, rows, records.data(), array.first + row * bytes);
        continue;
      }
      block_.resize(std::max(block_.size(), rows * bytes));
      copy(array, rows, records.data(), block_.data());
      results_.file_->write(array.offset + row * bytes, std::span(block_).first(rows * bytes));
    }
    next_row_ = row + rows;
    rows_written_ += rows;
    bytes_written_ += records.size();
  }
  void finish() override {
    if (rows_written_ < results_.rows_)
      fail("only {} of the {} points that were announced came.", rows_written_, results_.rows_);
  }

 private:
  void copy(const Array& array, std::size_t rows, const std::byte* records, std::byte* to) const {
    const std::size_t bytes = array.row_bytes();
    if (!is_one_piece(array.fields)) return convert(array, rows, records, to);
    const std::byte* from = records + array.fields.front().offset;
    with_fixed_size(bytes, [&](auto size) {
      for (std::size_t i = 0; i < rows; ++i, from += stride_, to += bytes) copy_bytes<size()>(to, from, bytes);
    });
  }

  void convert(const Array& array, std::size_t rows, const std::byte* record, std::byte* to) const {
    const Field target{.name = "", .type = array.type};
    for (std::size_t i = 0; i < rows; ++i, record += stride_)
      for (const Field& field : array.fields)
        for (std::uint32_t v = 0; v < field.count; ++v, to += size_of(array.type))
          set_value(target, to, value_of(field, record, v));
  }

  ResultArrays& results_;
  std::size_t stride_;
  std::vector<std::byte> block_;  ///< values of one array on their way to the file
  std::uint64_t next_row_ = 0, rows_written_ = 0;
};

ResultArrays::ResultArrays(WantedArrays wanted, const std::filesystem::path& folder) : wanted_(std::move(wanted)) {
  const TempFolder made(temp_parent(folder));  // removed at the end of this function; the file has no name and stays
  file_.emplace(SpillPlace(&made));
}

std::vector<std::string> ResultArrays::Array::components() const {
  std::vector<std::string> names;
  for (const Field& field : fields)
    for (std::uint32_t v = 0; v < field.count; ++v)
      names.push_back(field.count == 1 ? field.name : field.name + "_" + std::to_string(v));
  return names;
}

nb::tuple ResultArrays::Array::with_names(ArrayMemory held, std::size_t rows) const {
  std::vector<std::size_t> shape = {rows};
  if (is_list) shape.push_back(values);
  return nb::make_tuple(numpy_array(std::move(held), shape, type), components());
}

void ResultArrays::add(const std::string& name, const std::vector<std::string>& fields, const OutputPlan& plan) {
  const bool all = wanted_.names.empty();
  const bool has_name = std::ranges::find(arrays_, name, &Array::name) != arrays_.end();
  if (has_name || (!all && !wanted_.names.contains(name))) return;
  std::vector<Field> found;
  std::size_t values = 0;
  std::set<std::string> taken;
  for (const std::string& field : fields) {
    const auto known = field_meant(plan.schema, field);
    if (!known || taken_.contains(plan.schema.fields[*known].name)) return;
    found.push_back(plan.schema.fields[*known]);
    taken.insert(std::exchange(found.back().name, field));  // a file may call x "X"
    values += found.back().count;
  }
  Type type = result_type(found.front());
  if (!std::ranges::all_of(found, [&](const Field& field) { return result_type(field) == type; })) {
    if (name != "xyz") return;
    type = Type::f64;  // coordinates of different types, such as those of LAS with a scale of 1 for some
  }
  if (all) taken_.merge(taken);
  const bool is_list = values != 1 || fields.front() != name;
  const std::size_t bytes = rows_ * values * size_of(type);
  std::byte* first = place_in(name, type, values);
  ArrayMemory memory(file_ || first != nullptr ? 0 : bytes);
  if (!file_ && first == nullptr) first = memory.bytes.get();
  const std::uint64_t offset = file_ ? file_->reserve(bytes) : 0;
  arrays_.push_back({name, type, std::move(found), std::move(memory), first, values, is_list, offset});
}

std::byte* ResultArrays::place_in(const std::string& name, Type type, std::size_t values) const {
  const auto there = wanted_.into.find(name);
  if (there == wanted_.into.end()) return nullptr;
  const WritableArray& array = there->second;
  if (array.type != type || array.rows != rows_ || array.values != values)
    fail_usage("out: the array for '{}' has {} rows of {} {}, but the result has {} rows of {} {}.", name, array.rows,
               array.values, name_of(array.type), rows_, values, name_of(type));
  return array.first;
}

void ResultArrays::add_in_other_spellings(const OutputPlan& plan) {
  for (const std::string& name : wanted_.names)
    if (plan.schema.find(name)) add(name, {name}, plan);
}

void ResultArrays::require_all_wanted() const {
  for (const std::string& name : wanted_.names)
    if (std::ranges::find(arrays_, name, &Array::name) == arrays_.end())
      fail_usage("keep: '{}' is not the name of an array that this run can return; write it as the input does.", name);
}

std::unique_ptr<Writer> ResultArrays::writer(const OutputPlan& plan) {
  rows_ = plan.count;
  if (!wanted_.made_only)
    for (const auto& [name, fields] : wanted_.groups) add(name, fields, plan);
  for (const Attribute& attribute : plan.made) {
    const bool moved = attribute.name == position_attribute().name;
    add(moved ? "xyz" : attribute.name, attribute.fields, plan);
  }
  if (!wanted_.made_only)
    for (const Field& field : plan.schema.fields) add(field.name, {field.name}, plan);
  add_in_other_spellings(plan);
  require_all_wanted();
  return std::make_unique<Collector>(*this, plan.schema.stride);
}

nb::dict ResultArrays::arrays() {
  nb::dict arrays;
  for (Array& array : arrays_)
    arrays[array.name.c_str()] = wanted_.into.contains(array.name) ? nb::make_tuple(rows_, array.components())
                                                                   : array.with_names(std::move(array.memory), rows_);
  arrays_.clear();
  wanted_.into.clear();
  return arrays;
}

nb::dict ResultArrays::read(std::size_t first, std::size_t rows) const {
  first = std::min(first, rows_);
  rows = std::min(rows, rows_ - first);
  nb::dict arrays;
  for (const Array& array : arrays_) {
    const std::size_t bytes = array.row_bytes();
    ArrayMemory block(rows * bytes);
    file_->read(array.offset + first * bytes, {block.bytes.get(), rows * bytes});
    arrays[array.name.c_str()] = array.with_names(std::move(block), rows);
  }
  return arrays;
}

}  // namespace pointsweep
