// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/slab_loader.h"

#include <cstring>

#include "pointsweep/search/cut.h"

namespace pointsweep {

namespace {

/// What a load needs besides its result; kept per thread, so that the steady state allocates nothing.
struct LoadScratch {
  std::vector<std::byte> records;
  std::vector<double> x, y, z;
  std::vector<std::uint64_t> row;
  Cut cut;
};

void decode_rows(const Field& field, const std::byte* records, std::size_t stride, std::vector<std::uint64_t>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::byte* at = records + i * stride + field.offset;
    if (field.type == Type::u32) {
      std::uint32_t row;
      std::memcpy(&row, at, sizeof row);
      rows[i] = row;
    } else {
      std::memcpy(&rows[i], at, sizeof rows[i]);
    }
  }
}

std::unique_ptr<WindowCell> gather(const LoadScratch& s, std::uint32_t begin, std::uint32_t end) {
  auto window_cell = std::make_unique<WindowCell>();
  window_cell->cell = Cell(end - begin);
  Cell& cell = window_cell->cell;
  for (std::uint32_t i = 0; i < cell.size(); ++i) {
    const std::uint32_t from = s.cut.order[begin + i];
    cell.x[i] = s.x[from], cell.y[i] = s.y[from], cell.z[i] = s.z[from], cell.row[i] = s.row[from];
  }
  cell.seal();
  window_cell->index_in_slab.assign(s.cut.order.begin() + begin, s.cut.order.begin() + end);
  return window_cell;
}

}  // namespace

SlabLoader::SlabLoader(const Stream& stream, const SweepPlan& plan, std::uint32_t cell_points)
    : stream_(stream),
      plan_(plan),
      cell_points_(cell_points),
      position_(position_fields(stream.record_schema(), "the working record")),
      row_(stream.record_schema().fields.back()) {}

LoadedSlab SlabLoader::load(std::uint32_t slab, bool keep_records) const {
  thread_local LoadScratch s;
  const std::size_t stride = stream_.record_schema().stride, n = stream_.slabs()[slab].count;
  s.records.resize(n * stride);
  stream_.read(slab, s.records);
  s.x.resize(n), s.y.resize(n), s.z.resize(n), s.row.resize(n);
  decode_positions(position_, s.records.data(), stride, n, s.x.data(), s.y.data(), s.z.data());
  decode_rows(row_, s.records.data(), stride, s.row);
  cut(s.x, s.y, s.z, s.row, cell_points_, s.cut);

  LoadedSlab loaded;
  loaded.cells.reserve(s.cut.cells());
  for (std::size_t c = 0; c < s.cut.cells(); ++c) {
    auto cell = gather(s, s.cut.begin[c], s.cut.begin[c + 1]);
    cell->slab = slab;
    cell->columns.resize(plan_.column_bytes.size());
    cell->column_pointers.resize(plan_.column_bytes.size(), nullptr);
    fill_file_columns(s.records, *cell);
    loaded.cells.push_back(std::move(cell));
  }
  if (keep_records) loaded.records.assign(s.records.begin(), s.records.end());
  return loaded;
}

void SlabLoader::fill_file_columns(const std::vector<std::byte>& records, WindowCell& cell) const {
  const Schema& schema = stream_.record_schema();
  for (const FileColumn& file : plan_.file_columns) {
    cell.make_column(file.column, plan_.column_bytes[file.column]);
    const std::size_t bytes = size_of(file.type);
    Field to{.name = "", .type = file.type};
    std::byte* out = cell.columns[file.column].data();
    for (const std::uint32_t index : cell.index_in_slab) {
      for (const std::size_t f : file.fields) {
        const Field& from = schema.fields[f];
        const std::byte* record = records.data() + std::size_t{index} * schema.stride;
        if (from.type == file.type && from.is_plain()) {
          std::memcpy(out, record + from.offset, bytes);
        } else {
          set_value(to, out, value_of(from, record));
        }
        out += bytes;
      }
    }
  }
}

}  // namespace pointsweep
