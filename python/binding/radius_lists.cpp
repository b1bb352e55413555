// SPDX-License-Identifier: MIT
#include "python/binding/radius_lists.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "python/binding/neighbor_sink.h"
#include "python/binding/result_arrays.h"

namespace nb = nanobind;

namespace pointsweep {

std::shared_ptr<const LocalOperator> RadiusLists::op() {
  return std::make_shared<NeighborSink>("radius_lists", [this](const Neighborhoods& in) { add(lists_of(in)); });
}

std::unique_ptr<RadiusLists::Batch> RadiusLists::lists_of(const Neighborhoods& in) {
  auto batch = std::make_unique<Batch>();
  std::size_t all = 0;
  for (std::size_t i = 0; i < in.size(); ++i) all += in.count(i);
  batch->rows.reserve(all);
  batch->distances.reserve(all);
  for (std::size_t i = 0; i < in.size(); ++i) {
    batch->points.push_back(in.row(i));
    batch->counts.push_back(static_cast<std::uint32_t>(in.count(i)));
    for (std::size_t j = 0; j < in.count(i); ++j) {
      batch->rows.push_back(in.neighbor_row(i, j));
      batch->distances.push_back(std::sqrt(in.distance2(i, j)));
    }
  }
  return batch;
}

RadiusLists::~RadiusLists() {
  for (std::unique_ptr<Batch> batch(newest_.load()); batch;) batch = std::move(batch->next);
}

void RadiusLists::add(std::unique_ptr<Batch> batch) {
  Batch* const added = batch.release();
  Batch* before = newest_.load();
  do {
    static_cast<void>(added->next.release());
    added->next.reset(before);
  } while (!newest_.compare_exchange_weak(before, added));
}

void RadiusLists::put(const PlaceLists& lists) {
  auto batch = std::make_unique<Batch>();
  batch->points.assign(lists.places.begin(), lists.places.end());
  for (const std::size_t count : lists.counts) batch->counts.push_back(static_cast<std::uint32_t>(count));
  batch->rows.reserve(lists.neighbors.size());
  batch->distances.reserve(lists.neighbors.size());
  for (const CellNeighbor& n : lists.neighbors) {
    batch->rows.push_back(n.row);
    batch->distances.push_back(std::sqrt(n.distance2));
  }
  add(std::move(batch));
}

template <class Row>
nb::tuple RadiusLists::joined(std::uint64_t lists, Type type) {
  ArrayMemory offsets((lists + 1) * sizeof(std::int64_t));
  auto* const first = reinterpret_cast<std::int64_t*>(offsets.bytes.get());
  std::memset(first, 0, (lists + 1) * sizeof(std::int64_t));
  for (const Batch* batch = newest_; batch != nullptr; batch = batch->next.get())
    for (std::size_t i = 0; i < batch->points.size(); ++i) first[batch->points[i] + 1] = batch->counts[i];
  for (std::uint64_t i = 0; i < lists; ++i) first[i + 1] += first[i];
  const auto all = static_cast<std::size_t>(first[lists]);
  ArrayMemory rows(all * sizeof(Row)), distances(all * sizeof(double));
  auto* const row = reinterpret_cast<Row*>(rows.bytes.get());
  auto* const distance = reinterpret_cast<double*>(distances.bytes.get());
  std::unique_ptr<Batch> batch(newest_.exchange(nullptr));
  for (; batch; batch = std::move(batch->next))  // frees each batch when it is copied, to save memory
    for (std::size_t i = 0, at = 0; i < batch->points.size(); at += batch->counts[i++]) {
      const std::int64_t to = first[batch->points[i]];
      for (std::size_t j = 0; j < batch->counts[i]; ++j)
        row[to + static_cast<std::int64_t>(j)] = static_cast<Row>(batch->rows[at + j]);
      std::memcpy(distance + to, batch->distances.data() + at, batch->counts[i] * sizeof(double));
    }
  return nb::make_tuple(numpy_array(std::move(offsets), {lists + 1}, Type::i64),
                        numpy_array(std::move(rows), {all}, type), numpy_array(std::move(distances), {all}, Type::f64));
}

nb::tuple RadiusLists::arrays(std::uint64_t lists, std::uint64_t points) {
  if (points >= std::numeric_limits<std::uint32_t>::max()) return joined<std::uint64_t>(lists, Type::u64);
  return joined<std::uint32_t>(lists, Type::u32);
}

}  // namespace pointsweep
