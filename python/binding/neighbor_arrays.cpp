// SPDX-License-Identifier: MIT
#include "python/binding/neighbor_arrays.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include "pointsweep/fail.h"
#include "python/binding/neighbor_sink.h"

namespace nb = nanobind;

namespace pointsweep {
namespace {

/// Throws Error if `values` neighbours, each a distance and a row number of `row_bytes` bytes, exceed the memory of the
/// machine.
void require_memory(double values, std::size_t row_bytes) {
  const double there = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  const double needed = values * static_cast<double>(row_bytes + sizeof(double));
  if (needed > there)
    fail(
        "the neighbours would take {:.0f} GB, and this machine has {:.0f} GB: ask for fewer (k), or write them to "
        "files "
        "with the tool's verb neighbors.",
        needed / 1e9, there / 1e9);
}

Type row_type_for(std::uint64_t points, std::uint64_t lists, std::size_t k) {
  const Type type = points >= std::numeric_limits<std::uint32_t>::max() ? Type::u64 : Type::u32;
  require_memory(static_cast<double>(lists) * static_cast<double>(k), size_of(type));
  return type;
}

}  // namespace

NeighborArrays::NeighborArrays(std::size_t k, std::uint64_t lists, std::uint64_t points)
    : k_(k),
      row_type_(row_type_for(points, lists, k)),
      rows_(lists * k * size_of(row_type_)),
      distances_(lists * k * sizeof(double)) {}

NeighborArrays NeighborArrays::of_places(std::size_t k, std::uint64_t places, std::uint64_t points) {
  NeighborArrays made(k, places, points);
  made.count_ = places;
  std::memset(made.rows_.bytes.get(), 0xFF, places * k * size_of(made.row_type_));
  std::memset(made.distances_.bytes.get(), 0xFF, places * k * sizeof(double));  // NaN
  return made;
}

std::shared_ptr<const LocalOperator> NeighborArrays::op() {
  return std::make_shared<NeighborSink>("neighbor_arrays", [this](const Neighborhoods& in) { write(in); });
}

template <class Row>
void NeighborArrays::write(const Neighborhoods& in, Row* rows, double* distances) const {
  for (std::size_t i = 0; i < in.size(); ++i) {
    Row* const row = rows + in.row(i) * k_;
    double* const distance = distances + in.row(i) * k_;
    const std::size_t count = in.count(i);
    for (std::size_t j = 0; j < count; ++j) {
      row[j] = static_cast<Row>(in.neighbor_row(i, j));
      distance[j] = std::sqrt(in.distance2(i, j));
    }
    std::fill(row + count, row + k_, std::numeric_limits<Row>::max());
    std::fill(distance + count, distance + k_, std::numeric_limits<double>::quiet_NaN());
  }
}

void NeighborArrays::write(const Neighborhoods& in) {
  auto* const distances = reinterpret_cast<double*>(distances_.bytes.get());
  if (row_type_ == Type::u64) {
    write(in, reinterpret_cast<std::uint64_t*>(rows_.bytes.get()), distances);
  } else {
    write(in, reinterpret_cast<std::uint32_t*>(rows_.bytes.get()), distances);
  }
}

template <class Row>
void NeighborArrays::put(const PlaceLists& lists, Row* rows, double* distances) const {
  const CellNeighbor* next = lists.neighbors.data();
  for (std::size_t i = 0; i < lists.places.size(); ++i)
    for (std::size_t j = 0; j < lists.counts[i]; ++j, ++next) {
      rows[lists.places[i] * k_ + j] = static_cast<Row>(next->row);
      distances[lists.places[i] * k_ + j] = std::sqrt(next->distance2);
    }
}

void NeighborArrays::put(const PlaceLists& lists) {
  auto* const distances = reinterpret_cast<double*>(distances_.bytes.get());
  if (row_type_ == Type::u64)
    put(lists, reinterpret_cast<std::uint64_t*>(rows_.bytes.get()), distances);
  else
    put(lists, reinterpret_cast<std::uint32_t*>(rows_.bytes.get()), distances);
}

/// Writer that fills the lists of points without neighbours with missing values. The operator of op() fills the lists
/// of finite points alone, since it never gets points with non-finite coordinates.
class NeighborArrays::EmptyRows final : public Writer {
 public:
  EmptyRows(NeighborArrays& arrays, const Schema& schema)
      : arrays_(arrays), stride_(schema.stride), offset_(schema.fields[*schema.find("neighbor_count")].offset) {}

  void write(std::span<const std::byte> records) override { write_at(next_row_, records); }
  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override {
    const std::size_t rows = records.size() / stride_;
    for (std::size_t i = 0; i < rows; ++i) {
      std::uint32_t count;
      std::memcpy(&count, records.data() + i * stride_ + offset_, sizeof count);
      if (count > 0) continue;
      const std::size_t row_bytes = arrays_.k_ * size_of(arrays_.row_type_), bytes = arrays_.k_ * sizeof(double);
      std::memset(arrays_.rows_.bytes.get() + (row + i) * row_bytes, 0xFF, row_bytes);
      std::memset(arrays_.distances_.bytes.get() + (row + i) * bytes, 0xFF, bytes);  // NaN
    }
    next_row_ = row + rows;
    bytes_written_ += records.size();
  }
  void finish() override {}

 private:
  NeighborArrays& arrays_;
  std::size_t stride_, offset_;
  std::uint64_t next_row_ = 0;
};

std::unique_ptr<Writer> NeighborArrays::writer(const OutputPlan& plan) {
  count_ = plan.count;
  return std::make_unique<EmptyRows>(*this, plan.schema);
}

nb::tuple NeighborArrays::arrays() {
  const std::vector<std::size_t> shape = {count_, k_};
  return nb::make_tuple(numpy_array(std::move(rows_), shape, row_type_),
                        numpy_array(std::move(distances_), shape, Type::f64));
}

}  // namespace pointsweep
