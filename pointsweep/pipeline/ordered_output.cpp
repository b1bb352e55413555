// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/ordered_output.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/fail.h"
#include "pointsweep/pipeline/nonfinite_points.h"
#include "pointsweep/pipeline/slab_order.h"
#include "pointsweep/prefetch.h"

namespace pointsweep {
namespace {

constexpr std::size_t kPositionBytes = 3 * sizeof(double);

/// A record of `before` unnamed bytes, then x, y and z.
Schema position_behind(std::uint32_t before) {
  Schema schema;
  schema.stride = before;
  for (const char* axis : {"x", "y", "z"}) schema.append(axis, Type::f64);
  return schema;
}

/// The first `bytes` of each record of a slab, in order.
std::vector<std::byte> sorted_slab(const Stream& stream, std::size_t slab, std::size_t bytes) {
  const std::size_t stride = stream.record_schema().stride;
  std::vector<std::byte> records(stream.slabs()[slab].count * stride);
  stream.read(slab, records);
  const std::vector<std::uint32_t> order = order_of(stream, records);
  std::vector<std::byte> sorted(order.size() * bytes);
  for (std::size_t i = 0; i < order.size(); ++i)
    std::memcpy(sorted.data() + i * bytes, records.data() + order[i] * stride, bytes);
  return sorted;
}

}  // namespace

void write_in_order(const Stream& stream, std::size_t bytes,
                    const std::function<void(std::span<const std::byte>)>& write,
                    const std::function<void(std::uint64_t)>& report) {
  const std::size_t slabs = stream.slabs().size();
  Prefetch<std::vector<std::byte>> sorted([&](std::size_t s) { return sorted_slab(stream, s, bytes); }, 0, slabs,
                                          thread_count());
  std::uint64_t done = 0;
  for (std::size_t s = 0; s < slabs; ++s) {
    write(sorted.next());
    report(done += stream.slabs()[s].count);
  }
  const std::size_t stride = stream.record_schema().stride;
  for_each_nonfinite(stream, [&](std::uint64_t, std::span<const std::byte> records) {
    for (std::size_t at = 0; at < records.size(); at += stride) write(records.subspan(at, bytes));
  });
}

Reordering::Reordering(InputCloud& cloud, const RowFile& rows, const OutputLayout& layout, bool by_moved_positions)
    : cloud_(cloud),
      rows_(rows),
      layout_(layout),
      by_moved_positions_(by_moved_positions),
      input_position_(position_fields(cloud.schema(), "the input")) {}

PointSource Reordering::positions() {
  return {position_behind(0), cloud_.count(), [this](std::uint64_t row, std::span<std::byte> out) {
            const std::size_t n = out.size() / kPositionBytes;
            if (by_moved_positions_) {
              carried_.resize(n * rows_.record_bytes());
              rows_.read(row, carried_);
            } else {
              read_inputs(row, n);
            }
            put_positions(n, kPositionBytes, out.data());
            return n;
          }};
}

PointSource Reordering::records() {
  const std::uint32_t bytes = layout_.schema().stride;
  return {position_behind(bytes), cloud_.count(), [this, bytes](std::uint64_t row, std::span<std::byte> out) {
            const std::size_t stride = bytes + kPositionBytes, n = out.size() / stride;
            read_inputs(row, n);
            carried_.resize(n * rows_.record_bytes());
            rows_.read(row, carried_);
            for (std::size_t i = 0; i < n; ++i) {
              layout_.assemble(inputs_.data() + i * cloud_.schema().stride, carried_.data() + i * rows_.record_bytes(),
                               1, out.data() + i * stride, {row + i});
            }
            put_positions(n, stride, out.data() + bytes);
            return n;
          }};
}

void Reordering::read_inputs(std::uint64_t row, std::size_t n) {
  inputs_.resize(n * cloud_.schema().stride);
  if (cloud_.read(row, inputs_) != n) {
    fail("The input ended at row {} although it had {} points: it changed while it was read.", row, cloud_.count());
  }
}

void Reordering::put_positions(std::size_t n, std::size_t stride, std::byte* to) {
  const std::size_t record = rows_.record_bytes();
  for (std::size_t i = 0; i < n; ++i, to += stride) {
    if (by_moved_positions_) {
      std::memcpy(to, carried_.data() + (i + 1) * record - kPositionBytes, kPositionBytes);
      continue;
    }
    const std::byte* input = inputs_.data() + i * cloud_.schema().stride;
    const double position[3] = {value_of(input_position_.x, input), value_of(input_position_.y, input),
                                value_of(input_position_.z, input)};
    std::memcpy(to, position, sizeof position);
  }
}

}  // namespace pointsweep
