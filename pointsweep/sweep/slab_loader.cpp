// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/slab_loader.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "pointsweep/points/promised_type.h"
#include "pointsweep/points/record_map.h"

namespace pointsweep {

/// Buffers that one call of load() or cells_of() uses.
struct LoadScratch {
  std::vector<std::byte> records, cell_records;
  std::vector<CutPoint> points, sparse;
  std::vector<std::uint32_t> begin, sparse_begin;
};

/// Exclusive use of a LoadScratch during a call. The loader keeps a LoadScratch for each concurrent call, so that later
/// calls allocate no buffers.
class SlabLoader::OwnScratch {
 public:
  explicit OwnScratch(const SlabLoader& loader) : loader_(loader) {
    const std::lock_guard lock(loader.mutex_);
    if (loader.free_.empty()) loader.free_.push_back(std::make_unique<LoadScratch>());
    own_ = std::move(loader.free_.back());
    loader.free_.pop_back();
  }
  ~OwnScratch() {
    const std::lock_guard lock(loader_.mutex_);
    loader_.free_.push_back(std::move(own_));
  }
  OwnScratch(const OwnScratch&) = delete;
  OwnScratch& operator=(const OwnScratch&) = delete;
  LoadScratch& operator*() { return *own_; }

 private:
  const SlabLoader& loader_;
  std::unique_ptr<LoadScratch> own_;
};

namespace {

std::uint64_t row_at(const Field& field, const std::byte* record) {
  if (field.type == Type::u32) {
    std::uint32_t row;
    std::memcpy(&row, record + field.offset, sizeof row);
    return row;
  }
  std::uint64_t row;
  std::memcpy(&row, record + field.offset, sizeof row);
  return row;
}

/// Fills s.points with the positions of the records, relative to the middle of the slab. Points in sparse places come
/// last. Returns the number of the other points.
std::size_t make_cut_points(const PositionFields& position, std::size_t stride, const std::vector<std::byte>& records,
                            Vec3 middle, const LocalSpacing& spacing, LoadScratch& s) {
  constexpr std::size_t kChunk = 1024;
  std::array<double, kChunk> x, y, z;
  const std::size_t count = records.size() / stride;
  const bool may_be_sparse = spacing.has_sparse_places();
  s.points.resize(count);
  s.sparse.clear();
  std::size_t dense = 0;
  for (std::size_t first = 0; first < count; first += kChunk) {
    const std::size_t n = std::min<std::size_t>(kChunk, count - first);
    decode_positions(position, records.data() + first * stride, stride, n, x.data(), y.data(), z.data());
    for (std::size_t i = 0; i < n; ++i) {
      const CutPoint point{{static_cast<float>(x[i] - middle.x), static_cast<float>(y[i] - middle.y),
                            static_cast<float>(z[i] - middle.z)},
                           static_cast<std::uint32_t>(first + i)};
      if (may_be_sparse && spacing.is_sparse({x[i], y[i], z[i]}))
        s.sparse.push_back(point);
      else
        s.points[dense++] = point;
    }
  }
  std::ranges::copy(s.sparse, s.points.begin() + static_cast<std::ptrdiff_t>(dense));
  return dense;
}

using RowOf = std::function<std::uint64_t(std::uint32_t index)>;

/// Cuts the first `dense` points and the other points separately, so that a few outliers do not stretch the cells and
/// leaves of a surface.
void cut_apart(std::size_t dense, std::uint32_t cell_points, const RowOf& row_of, LoadScratch& s) {
  const std::span<CutPoint> points(s.points);
  cut_into_cells(points.first(dense), cell_points, row_of, s.begin);
  if (dense == points.size()) return;
  cut_into_cells(points.subspan(dense), cell_points, row_of, s.sparse_begin);
  for (std::size_t c = 1; c < s.sparse_begin.size(); ++c) {
    s.begin.push_back(static_cast<std::uint32_t>(dense) + s.sparse_begin[c]);
  }
}

}  // namespace

SlabLoader::SlabLoader(const Stream& stream, const SweepPlan& plan, std::uint32_t cell_points)
    : stream_(stream),
      plan_(plan),
      cell_points_(cell_points),
      position_(position_fields(stream.record_schema(), "the working record")),
      row_(stream.record_schema().fields.back()) {}

SlabLoader::~SlabLoader() = default;

LoadedSlab SlabLoader::load(std::uint32_t slab, bool keep_records) const {
  OwnScratch own(*this);
  LoadScratch& s = *own;
  s.records.resize(stream_.slabs()[slab].count * stream_.record_schema().stride);
  stream_.read(slab, s.records);
  LoadedSlab loaded{cut_into_window_cells(slab, s.records, s), {}};
  for (std::uint32_t c = 0; c < loaded.cells.size(); ++c) {
    loaded.cells[c]->number = c;
    expect_reaches(*loaded.cells[c], plan_.neighborhood);
  }
  if (keep_records) loaded.records.assign(s.records.begin(), s.records.end());
  return loaded;
}

std::vector<std::unique_ptr<WindowCell>> SlabLoader::cells_of(std::uint32_t slab,
                                                              std::span<const std::uint32_t> index_in_slab,
                                                              const std::vector<std::byte>& records) const {
  OwnScratch own(*this);
  LoadScratch& s = *own;
  auto cells = cut_into_window_cells(slab, records, s);
  for (const auto& cell : cells)
    for (std::uint32_t& index : cell->index_in_slab) index = index_in_slab[index];
  return cells;
}

/// Cuts records into cells. WindowCell::index_in_slab of the cells holds indices of `records`.
std::vector<std::unique_ptr<WindowCell>> SlabLoader::cut_into_window_cells(std::uint32_t slab,
                                                                           const std::vector<std::byte>& records,
                                                                           LoadScratch& s) const {
  const std::size_t stride = stream_.record_schema().stride;
  const Vec3 middle = stream_.slabs()[slab].box.center();
  const std::size_t dense = make_cut_points(position_, stride, records, middle, stream_.spacing_in_slabs(), s);
  const RowOf row_of = [&](std::uint32_t i) { return row_at(row_, records.data() + i * stride); };
  cut_apart(dense, cell_points_, row_of, s);
  std::vector<std::unique_ptr<WindowCell>> cells;
  cells.reserve(s.begin.size() - 1);
  for (std::uint32_t c = 0; c + 1 < s.begin.size(); ++c) {
    const std::span<CutPoint> points(s.points.data() + s.begin[c], s.begin[c + 1] - s.begin[c]);
    cut_into_leaves(points, row_of);
    cells.push_back(make_cell(slab, points, records, s.cell_records));
  }
  return cells;
}

/// Makes a cell of points of a slab. First gathers their records, with one cache miss for each point, so that all later
/// accesses hit the first-level cache.
std::unique_ptr<WindowCell> SlabLoader::make_cell(std::uint32_t slab, std::span<const CutPoint> points,
                                                  const std::vector<std::byte>& records,
                                                  std::vector<std::byte>& cell_records) const {
  const std::size_t stride = stream_.record_schema().stride;
  auto made = std::make_unique<WindowCell>();
  made->slab = slab;
  made->is_only_looked_at = stream_.slabs()[slab].is_halo;
  made->cell = Cell(static_cast<std::uint32_t>(points.size()));
  made->index_in_slab.resize(points.size());
  cell_records.resize(points.size() * stride);
  for (std::size_t i = 0; i < points.size(); ++i) made->index_in_slab[i] = points[i].index;
  with_fixed_size(stride, [&](auto size) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      copy_bytes<size()>(cell_records.data() + i * stride, records.data() + points[i].index * stride, stride);
    }
  });
  Cell& cell = made->cell;
  decode_positions(position_, cell_records.data(), stride, points.size(), cell.x, cell.y, cell.z);
  for (std::size_t i = 0; i < points.size(); ++i) cell.row[i] = row_at(row_, cell_records.data() + i * stride);
  cell.seal();
  made->columns.resize(plan_.column_bytes.size());
  made->column_pointers.resize(plan_.column_bytes.size(), nullptr);
  fill_file_columns(cell_records, *made);
  return made;
}

void SlabLoader::fill_file_columns(const std::vector<std::byte>& cell_records, WindowCell& cell) const {
  FirstRowError refused;
  for (const FileColumn& file : plan_.file_columns) {
    cell.make_column(file.column, plan_.column_bytes[file.column]);
    fill_file_column(file, stream_.record_schema(), cell_records.data(), {cell.cell.row, cell.cell.size()},
                     cell.columns[file.column].data(), refused);
  }
  if (!refused.any() || cell.is_only_looked_at) return;
  const std::lock_guard lock(mutex_);
  refused_.note(refused);
}

FirstRowError SlabLoader::refused() const {
  const std::lock_guard lock(mutex_);
  return refused_;
}

void fill_file_column(const FileColumn& file, const Schema& schema, const std::byte* records,
                      std::span<const std::uint64_t> rows, std::byte* out, FirstRowError& refused) {
  const std::size_t bytes = size_of(file.type), width = bytes * file.fields.size();
  for (const std::size_t f : file.fields) {
    const PromisedType promised(schema.fields[f], file.type);
    for (std::size_t i = 0; i < rows.size(); ++i)
      promised.convert(records + i * schema.stride, rows[i], out + i * width, refused);
    out += bytes;
  }
}

}  // namespace pointsweep
