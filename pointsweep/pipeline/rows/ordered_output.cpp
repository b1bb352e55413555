// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/ordered_output.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "pointsweep/order/canonical_order.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kPositionBytes = 3 * sizeof(double);

/// Returns the schema of a record of `before` unnamed bytes, then x, y and z.
Schema position_after(std::uint32_t before) {
  Schema schema;
  schema.stride = before;
  for (const char* axis : kAxisNames) schema.append(axis, Type::f64);
  return schema;
}

/// Returns the first `bytes` of each record of a slab, in canonical order.
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

std::vector<std::uint32_t> order_of(const Stream& stream, const std::vector<std::byte>& records) {
  const Schema& schema = stream.record_schema();
  const std::size_t n = records.size() / schema.stride;
  std::vector<double> x(n), y(n), z(n);
  std::vector<std::uint64_t> row(n);
  decode_positions(position_fields(schema, "the working record"), records.data(), schema.stride, n, x.data(), y.data(),
                   z.data());
  const Field& field = schema.fields.back();
  for (std::size_t i = 0; i < n; ++i) {
    // A row of type u32 fills the low half of the zeroed u64.
    std::memcpy(&row[i], records.data() + i * schema.stride + field.offset, size_of(field.type));
  }
  std::vector<std::uint32_t> order;
  canonical_order(stream.axis(), x, y, z, row, order);
  return order;
}

std::vector<std::uint32_t> ranks(const Stream& stream, const std::vector<std::byte>& records) {
  const std::vector<std::uint32_t> order = order_of(stream, records);
  std::vector<std::uint32_t> rank(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
  return rank;
}

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

/// Rows of the input and of carried records, for one thread.
class Reordering::Rows {
 public:
  Rows(const Reordering& all, ReadRows read) : all_(all), read_(std::move(read)) {}

  void read_inputs(std::uint64_t row, std::size_t n) {
    inputs_.resize(n * all_.input_.schema.stride);
    read_fully(all_.input_, read_, row, inputs_);
  }
  void read_carried(std::uint64_t row, std::size_t n) {
    carried_.resize(n * all_.rows_.record_bytes());
    all_.rows_.read(row, carried_);
  }
  const std::byte* input(std::size_t i) const { return inputs_.data() + i * all_.input_.schema.stride; }
  const std::byte* carried(std::size_t i) const { return carried_.data() + i * all_.rows_.record_bytes(); }

  /// Stores the positions that decide the places of `n` rows, `stride` bytes apart.
  void put_positions(std::size_t n, std::size_t stride, std::byte* to) const {
    for (std::size_t i = 0; i < n; ++i, to += stride) {
      if (all_.by_moved_positions_) {
        std::memcpy(to, carried(i + 1) - kPositionBytes, kPositionBytes);
        continue;
      }
      const PositionFields& p = all_.input_position_;
      const double position[3] = {value_of(p.x, input(i)), value_of(p.y, input(i)), value_of(p.z, input(i))};
      std::memcpy(to, position, sizeof position);
    }
  }

 private:
  const Reordering& all_;
  ReadRows read_;
  std::vector<std::byte> inputs_, carried_;
};

Reordering::Reordering(InputCloud& cloud, const RowFile& rows, const OutputLayout& layout, bool by_moved_positions)
    : input_(source_of(cloud)),
      rows_(rows),
      layout_(layout),
      by_moved_positions_(by_moved_positions),
      input_position_(position_fields(cloud.schema(), "the input")) {}

PointSource Reordering::positions() const {
  const auto fill = [this](Rows& rows, std::uint64_t row, std::size_t n, std::byte* out) {
    by_moved_positions_ ? rows.read_carried(row, n) : rows.read_inputs(row, n);
    rows.put_positions(n, kPositionBytes, out);
  };
  return source(position_after(0), fill);
}

PointSource Reordering::records() const {
  const std::uint32_t bytes = layout_.schema().stride;
  const auto fill = [this, bytes](Rows& rows, std::uint64_t row, std::size_t n, std::byte* out) {
    rows.read_inputs(row, n);
    rows.read_carried(row, n);
    const std::size_t stride = bytes + kPositionBytes;
    for (std::size_t i = 0; i < n; ++i)
      layout_.assemble(rows.input(i), rows.carried(i), 1, out + i * stride, {row + i});
    rows.put_positions(n, stride, out + bytes);
  };
  return source(position_after(bytes), fill);
}

PointSource Reordering::source(Schema schema, const Fill& fill) const {
  const auto filling = [this, fill, stride = schema.stride](ReadRows read) -> ReadRows {
    const auto rows = std::make_shared<Rows>(*this, std::move(read));
    return [fill, stride, rows](std::uint64_t row, std::span<std::byte> out) {
      fill(*rows, row, out.size() / stride, out.data());
      return out.size() / stride;
    };
  };
  const auto for_thread = [this, filling](const std::vector<std::size_t>&) {
    ReadRows read = input_.for_thread({});
    return read ? filling(std::move(read)) : ReadRows();
  };
  return {std::move(schema), input_.count, filling(input_.read), for_thread, input_.chunk_end};
}

}  // namespace pointsweep
