// SPDX-License-Identifier: MIT
#include "pointsweep/reader.h"

#include <cassert>
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "pointsweep/fail.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/writer.h"

namespace pointsweep {

Chunk Reader::chunk_of(std::uint64_t) const { return {.rows = info_.count, .bounds = info_.bounds}; }

std::unique_ptr<RowDecoder> Reader::decoder(const WantedFields&) const { return nullptr; }

std::size_t Reader::read(std::uint64_t row, std::span<std::byte> records) {
  if (row >= info_.count) return 0;
  if (!own_decoder_) own_decoder_ = decoder();
  assert(own_decoder_ && "a reader has decoders or reads rows itself");
  const std::size_t rows = own_decoder_->read(row, records);
  // The buffers of a decoder are not needed after the last row, for example when the next of many files is read.
  if (row + rows == info_.count) own_decoder_.reset();
  return rows;
}

void Writer::write_at(std::uint64_t, std::span<const std::byte>) {
  throw std::logic_error("write_at() was called on a writer whose can_write_at() is false");
}

ArrayReader::ArrayReader(std::span<const float> xyz) {
  info_.count = xyz.size() / 3;
  add({"x", "y", "z"}, xyz);
}

ArrayReader::ArrayReader(std::span<const double> xyz) {
  info_.count = xyz.size() / 3;
  add({"x", "y", "z"}, xyz);
}

void ArrayReader::add(const std::vector<std::string>& names, std::span<const float> values) {
  add_column(names, Type::f32, std::as_bytes(values));
}

void ArrayReader::add(const std::vector<std::string>& names, std::span<const double> values) {
  add_column(names, Type::f64, std::as_bytes(values));
}

void ArrayReader::add_column(const std::vector<std::string>& names, Type type, std::span<const std::byte> values) {
  const std::size_t bytes = names.size() * size_of(type);
  if (values.size() != info_.count * bytes) {
    fail_usage("the array for '{}' holds {} values, but {} points need {}.", names.empty() ? "" : names[0],
               values.size() / size_of(type), info_.count, info_.count * names.size());
  }
  columns_.push_back({values.data(), bytes});
  for (const std::string& name : names) info_.schema.append(name, type);
  info_.path = "array";
  info_.format = "arrays in memory";
  info_.bytes += values.size();
}

std::size_t ArrayReader::read(std::uint64_t row, std::span<std::byte> records) {
  const std::size_t stride = info_.schema.stride;
  const std::size_t rows = rows_for(row, records);
  std::size_t offset = 0;
  for (const Column& column : columns_) {
    for (std::size_t i = 0; i < rows; ++i) {
      std::memcpy(records.data() + i * stride + offset, column.values + (row + i) * column.bytes, column.bytes);
    }
    offset += column.bytes;
  }
  return rows;
}

template <class T>
ArrayWriter<T>::ArrayWriter(const OutputPlan& plan, const std::vector<std::string>& names, std::span<T> values)
    : stride_(plan.schema.stride), values_(values), count_(plan.count) {
  for (const std::string& name : names) {
    const auto index = plan.schema.find(name);
    if (!index) fail_usage("there is no field '{}' to collect.", name);
    fields_.push_back(plan.schema.fields[*index]);
  }
  if (values.size() != count_ * fields_.size()) {
    fail_usage("the array for '{}' has room for {} values, but {} points need {}.", names.empty() ? "" : names[0],
               values.size(), count_, count_ * fields_.size());
  }
}

template <class T>
void ArrayWriter<T>::write(std::span<const std::byte> records) {
  write_at(rows_written_, records);
}

template <class T>
void ArrayWriter<T>::write_at(std::uint64_t row, std::span<const std::byte> records) {
  const std::size_t rows = records.size() / stride_;
  if (row > count_ || rows > count_ - row) fail("more points came than the {} that were announced.", count_);
  for (std::size_t i = 0; i < rows; ++i) {
    const std::byte* record = records.data() + i * stride_;
    T* out = values_.data() + (row + i) * fields_.size();
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      Field target;
      target.type = std::is_same_v<T, float>           ? Type::f32
                    : std::is_same_v<T, double>        ? Type::f64
                    : std::is_same_v<T, std::uint32_t> ? Type::u32
                                                       : Type::u64;
      if (fields_[f].is_plain() && fields_[f].type == target.type) {
        std::memcpy(out + f, record + fields_[f].offset, sizeof(T));
        continue;
      }
      const double value = value_of(fields_[f], record);
      if (!holds(target, value))
        fail("Row {}: '{}' is {}, which is not {}, the type of the array; collect it in a wider one.", row + i,
             fields_[f].name, value, name_of(target.type));
      set_value(target, reinterpret_cast<std::byte*>(out + f), value);
    }
  }
  rows_written_ += rows;
  bytes_written_ += rows * fields_.size() * sizeof(T);
}

template <class T>
void ArrayWriter<T>::finish() {
  if (rows_written_ < count_) fail("only {} of the {} points that were announced came.", rows_written_, count_);
}

template class ArrayWriter<float>;
template class ArrayWriter<double>;
template class ArrayWriter<std::uint32_t>;
template class ArrayWriter<std::uint64_t>;

}  // namespace pointsweep
