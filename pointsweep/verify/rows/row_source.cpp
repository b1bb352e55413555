// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/row_source.h"

#include <limits>

#include "pointsweep/fail.h"

namespace pointsweep {

RowSource::RowSource(InputCloud& cloud) : RowSource(cloud, cloud.readers().front()->info().path.string(), "") {}

RowSource::RowSource(InputCloud& cloud, std::string name, const std::string& left_out)
    : schema_(cloud.schema()),
      count_(cloud.count()),
      name_(std::move(name)),
      read_([&cloud](std::uint64_t row, std::span<std::byte> records) { return cloud.read(row, records); }) {
  std::erase_if(schema_.fields, [&](const Field& field) { return field.name == left_out; });
  const std::vector<std::uint64_t> first_rows = cloud.first_rows();
  for (std::size_t i = 0; i < cloud.readers().size(); ++i)
    files_.push_back({first_rows[i], &cloud.readers()[i]->info().schema});
}

RowSource::RowSource(Reader& reader)
    : schema_(reader.info().schema),
      count_(reader.info().count),
      name_(reader.info().path.string()),
      files_{{0, &reader.info().schema}},
      read_([&reader](std::uint64_t row, std::span<std::byte> records) { return reader.read(row, records); }) {}

RowSource::RowSource(RowSource& rows, std::span<const std::uint64_t> chosen)
    : schema_(rows.schema_),
      count_(chosen.size()),
      name_(rows.name_),
      read_([&rows, chosen](std::uint64_t row, std::span<std::byte> records) {
        const std::size_t stride = rows.schema().stride;
        const auto some = chosen.subspan(row, std::min(chosen.size() - row, records.size() / stride));
        for_each_record(rows, some, [&](std::size_t i, const std::byte* record) {
          std::copy_n(record, stride, records.data() + i * stride);
        });
        return some.size();
      }) {
  for (const FileOfRows& file : rows.files_)
    files_.push_back(
        {static_cast<std::uint64_t>(std::ranges::lower_bound(chosen, file.first) - chosen.begin()), file.schema});
}

RowSource RowSource::without_nonfinite(const RowSource& rows) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  RowSource changed = rows;
  const PositionFields position = position_fields(rows.schema_, rows.name_);
  const std::size_t stride = rows.schema_.stride;
  changed.read_ = [read = rows.read_, position, stride](std::uint64_t row, std::span<std::byte> records) {
    const std::size_t count = read(row, records);
    for (std::size_t at = 0; at < count * stride; at += stride)
      if (!is_finite(position_in(position, &records[at])))
        for (const Field& field : {position.x, position.y, position.z})
          if (holds(field, kNone)) set_value(field, &records[at], kNone);
    return count;
  };
  return changed;
}

std::span<const std::byte> RowSource::read(std::uint64_t first, std::size_t count) {
  const std::size_t bytes = count * schema_.stride;
  block_.resize(std::max(block_.size(), bytes));
  const std::size_t got = bytes == 0 ? 0 : read_(first, std::span(block_).first(bytes));
  if (got != count) fail("{}: ends at point {} of {}; it has changed while it was read.", name_, first + got, count_);
  return std::span(block_).first(bytes);
}

std::span<const std::byte> RowSource::read_block(std::uint64_t first) {
  return read(first, static_cast<std::size_t>(std::min<std::uint64_t>(block_rows(), count_ - first)));
}

void for_each_position(RowSource& source, const char* phase, const PhaseProgress& progress,
                       const std::function<void(std::uint64_t, Vec3)>& use) {
  const PositionFields position = position_fields(source.schema(), source.name());
  const std::size_t stride = source.schema().stride;
  std::vector<double> x, y, z;
  for_each_block(source, phase, progress, [&](std::uint64_t first, const std::byte* records, std::size_t n) {
    x.resize(n), y.resize(n), z.resize(n);
    decode_positions(position, records, stride, n, x.data(), y.data(), z.data());
    for (std::size_t i = 0; i < n; ++i) use(first + i, {x[i], y[i], z[i]});
  });
}

void for_each_record(RowSource& source, std::span<const std::uint64_t> rows,
                     const std::function<void(std::size_t, const std::byte*)>& use) {
  const std::size_t stride = source.schema().stride, block = source.block_rows();
  for (std::size_t i = 0; i < rows.size();) {
    const std::uint64_t first = rows[i] / block * block;
    const std::byte* const records = source.read_block(first).data();
    for (; i < rows.size() && rows[i] < first + block; ++i) use(i, records + (rows[i] - first) * stride);
  }
}

}  // namespace pointsweep
