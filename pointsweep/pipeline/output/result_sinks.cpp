// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/result_sinks.h"

#include <cstring>

#include "pointsweep/pipeline/rows/ordered_output.h"

namespace pointsweep {

SweepOrderSink::SweepOrderSink(RowStore& store, const Stream& stream, const OutputLayout& layout,
                               std::uint32_t input_stride)
    : store_(store), stream_(stream), layout_(layout), input_stride_(input_stride), slabs_(stream.slabs().size()) {}

void SweepOrderSink::slab_read(std::uint32_t slab, std::vector<std::byte> records) {
  auto open = std::make_shared<Open>();
  open->rank = ranks(stream_, records);
  open->left = open->rank.size();
  open->records = std::move(records);
  const std::lock_guard lock(mutex_);
  slabs_[slab] = std::move(open);
}

void SweepOrderSink::finished(const Finished& points) {
  std::shared_ptr<Open> open;
  {
    const std::lock_guard lock(mutex_);
    open = slabs_[points.slab];
  }
  leave(points.slab, points.size);
  const std::size_t stride = stream_.record_schema().stride;
  std::vector<std::byte> inputs(points.size * input_stride_);
  std::vector<std::uint64_t> places(points.size);
  for (std::size_t i = 0; i < points.size; ++i) {
    const std::uint32_t index = points.index_in_slab[i];
    std::memcpy(inputs.data() + i * input_stride_, open->records.data() + index * stride, input_stride_);
    places[i] = stream_.slabs()[points.slab].first + open->rank[index];
  }
  store(points, inputs, places);
}

void SweepOrderSink::recalled(const Finished& points) {
  std::vector<std::byte> inputs;
  std::vector<std::uint64_t> places;
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < points.size; ++i) {
      const Kept& kept = kept_.at({points.slab, points.index_in_slab[i]});
      inputs.insert(inputs.end(), kept.record.begin(), kept.record.end());
      places.push_back(kept.place);
    }
  }
  store(points, inputs, places);
}

/// Assembles output records from the points' input records and results, and stores the output records at `places`.
void SweepOrderSink::store(const Finished& points, const std::vector<std::byte>& inputs,
                           const std::vector<std::uint64_t>& places) {
  std::vector<std::byte> outputs(points.size * layout_.schema().stride);
  layout_.assemble(inputs.data(), points.results, points.size, outputs.data(), {0, points.rows});
  store_.put(places, outputs);
}

void SweepOrderSink::deferred(std::uint32_t slab, std::uint32_t index) {
  {
    const std::lock_guard lock(mutex_);
    const Open& open = *slabs_[slab];
    const std::byte* record = open.records.data() + std::size_t{index} * stream_.record_schema().stride;
    kept_[{slab, index}] = {stream_.slabs()[slab].first + open.rank[index], {record, record + input_stride_}};
  }
  leave(slab, 1);
}

void SweepOrderSink::leave(std::uint32_t slab, std::uint64_t points) {
  const std::lock_guard lock(mutex_);
  slabs_[slab]->left -= points;
  if (slabs_[slab]->left == 0) slabs_[slab].reset();
}

}  // namespace pointsweep
