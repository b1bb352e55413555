// SPDX-License-Identifier: MIT
/// A reader of PTX files (Leica Geosystems), with all scans as one cloud.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/ptx/ptx_layout.h"

namespace pointsweep {
namespace {

/// The fields that get the values of a point in its record. The coordinates come first.
struct PtxRecord {
  Field scan, row, column;
  std::optional<Field> intensity;
  std::optional<std::uint32_t> color;  ///< offset of red, green, blue
};

class PtxReader final : public Reader {
 public:
  explicit PtxReader(const std::filesystem::path& path) : file_(path), layout_(find_ptx_layout(file_)) {
    info_.path = path;
    info_.format = fmt::format("PTX, {} scan{}", layout_.scans.size(), layout_.scans.size() == 1 ? "" : "s");
    info_.bytes = file_.size();
    info_.count = layout_.points;
    make_schema();
    if (layout_.empty != 0)
      info_.warnings.push_back(
          fmt::format("{}: {} of its {} cells are empty, since the scanner saw nothing there; they are left out.",
                      path.string(), layout_.empty, layout_.empty + layout_.points));
  }

  Chunk chunk_of(std::uint64_t row) const override {
    constexpr std::uint64_t kRows = PtxLayout::kPointsPerPlace;
    const std::size_t place = static_cast<std::size_t>(row / kRows);
    const std::uint64_t end = place + 1 < layout_.places.size() ? layout_.places[place + 1].offset : layout_.end;
    return {place * kRows, std::min(kRows, info_.count - place * kRows), layout_.places[place].offset, end,
            std::nullopt};
  }
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields&) const override { return std::make_unique<Decoder>(*this); }

 private:
  class Decoder final : public RowDecoder {
   public:
    explicit Decoder(const PtxReader& reader) : reader_(reader), points_(reader.file_, reader.layout_) {}

    std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
      const std::size_t rows = reader_.rows_for(row, records), stride = reader_.info().schema.stride;
      for (std::size_t i = 0; i < rows; ++i) decode(points_.at(row + i), records.data() + i * stride);
      return rows;
    }

   private:
    void decode(std::string_view line, std::byte* record);
    double number(std::string_view& line) const;
    std::byte color(std::string_view& line) const;

    const PtxReader& reader_;
    PtxCursor points_;
  };

  void make_schema() {
    std::uint64_t rows = 0, columns = 0;
    std::size_t widest = 0;
    for (const PtxScan& scan : layout_.scans) {
      rows = std::max(rows, scan.rows);
      columns = std::max(columns, scan.columns);
      widest = std::max(widest, scan.width);
    }
    const auto type_below = [](std::uint64_t count) { return count <= 65536 ? Type::u16 : Type::u32; };
    Schema& schema = info_.schema;
    const auto add = [&](const char* name, Type type) { return schema.fields[schema.append(name, type)]; };
    for (const char* axis : {"x", "y", "z"}) add(axis, Type::f64);
    if (widest > 3) record_.intensity = add("intensity", Type::f64);
    record_.scan = add("scan", Type::u16);
    record_.row = add("row", type_below(rows));
    record_.column = add("column", type_below(columns));
    if (widest < 7) return;
    record_.color = add("red", Type::u8).offset;
    add("green", Type::u8), add("blue", Type::u8);
  }

  InputFile file_;
  PtxLayout layout_;
  PtxRecord record_;
};

double PtxReader::Decoder::number(std::string_view& line) const {
  const std::string_view word = take_word(line);
  double value = 0;
  if (!parse_number(word, value))
    fail("{}: line {}: '{}' is no number; correct the line.", reader_.info().path.string(), points_.line(),
         word.substr(0, 40));
  return value;
}

std::byte PtxReader::Decoder::color(std::string_view& line) const {
  const std::string_view word = take_word(line);
  std::uint8_t value = 0;
  if (!parse_number(word, value))
    fail("{}: line {}: '{}' is no colour from 0 to 255; correct the line.", reader_.info().path.string(),
         points_.line(), word.substr(0, 40));
  return std::byte{value};
}

void PtxReader::Decoder::decode(std::string_view line, std::byte* record) {
  const PtxScan& scan = reader_.layout_.scans[static_cast<std::size_t>(points_.scan())];
  const PtxRecord& fields = reader_.record_;
  std::memset(record, 0, reader_.info().schema.stride);
  const double x = number(line), y = number(line), z = number(line);
  const auto& m = scan.matrix;
  std::array<double, 3> position;
  for (std::size_t axis = 0; axis < 3; ++axis)
    position[axis] = ((x * m[axis] + y * m[4 + axis]) + z * m[8 + axis]) + m[12 + axis];
  std::memcpy(record, position.data(), sizeof position);
  if (scan.width > 3) set_value(*fields.intensity, record, number(line));
  set_value(fields.scan, record, static_cast<double>(points_.scan()));
  set_value(fields.row, record, static_cast<double>(points_.cell() % scan.rows));
  set_value(fields.column, record, static_cast<double>(points_.cell() / scan.rows));
  for (std::size_t c = 0; c < 3 && scan.width == 7; ++c) record[*fields.color + c] = color(line);
  if (!is_blank(line))
    fail("{}: line {} has more than the {} numbers of the first line of its scan; correct it.",
         reader_.info().path.string(), points_.line(), scan.width);
}

constexpr std::string_view kPtxExtensions[] = {".ptx"};

/// Opens a file. x, y, z are float64 with the transformation of their scan applied; `scan`, `row` and `column` count
/// from 0; `intensity` is float64 and red, green, blue are uint8 if any scan has them, and 0 in scans that lack them.
/// Empty cells are left out; a warning counts them. Opening reads the file once. Throws Error for a damaged or
/// truncated file.
std::unique_ptr<Reader> open_ptx(const std::filesystem::path& path) { return std::make_unique<PtxReader>(path); }

}  // namespace

const Format kPtxFormat = {.name = "PTX",
                           .title = "PTX",
                           .details = "#ptx-and-pts",
                           .reads = "all scans as one cloud, transformations applied",
                           .writes = "no",
                           .extensions = kPtxExtensions,
                           .is = starts_as_ptx,
                           .open = open_ptx};

}  // namespace pointsweep
