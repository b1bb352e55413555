// SPDX-License-Identifier: MIT
/// A reader of legacy VTK files: the points of POLYDATA, UNSTRUCTURED_GRID and STRUCTURED_GRID.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/records/record_readers.h"
#include "pointsweep/formats/vtk/vtk_layout.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

constexpr std::uint32_t kMostRecordBytes = 1 << 20;

/// Returns the fields of all arrays, which are adjacent in the record.
Schema schema_of(const VtkLayout& layout, const std::string& path) {
  Schema schema;
  for (const VtkArray& array : layout.arrays) {
    if (&array == layout.arrays.data())
      for (const char* axis : {"x", "y", "z"}) schema.append(axis, array.type);
    else
      append_array(schema, array.name, array.type, array.components);
    if (schema.stride > kMostRecordBytes) fail("{}: a point takes more than {} bytes.", path, kMostRecordBytes);
  }
  return schema;
}

FileInfo info_of(const InputFile& file, const VtkLayout& layout) {
  FileInfo info;
  const std::string name = file.path().string();
  info.path = file.path();
  info.format = fmt::format("VTK legacy {} {}", layout.dataset, layout.text ? "ascii" : "binary");
  info.bytes = file.size();
  info.schema = schema_of(layout, name);
  info.count = layout.count;
  if (layout.cells != 0) info.warnings.push_back(fmt::format("{}: its {} cells are left out.", name, layout.cells));
  if (!layout.left_out.empty())
    info.warnings.push_back(fmt::format(
        "{}: {} of its points left out, since the type or the number of values is none that points can have.", name,
        fmt::join(layout.left_out, ", ")));
  return info;
}

class BinaryVtkReader final : public ColumnsReader {
 public:
  BinaryVtkReader(std::shared_ptr<const InputFile> file, const VtkLayout& layout) {
    info_ = info_of(*file, layout);
    std::vector<StoredColumn> columns;
    std::uint32_t offset = 0;
    for (const VtkArray& array : layout.arrays) {
      const std::uint32_t bytes = array.components * static_cast<std::uint32_t>(size_of(array.type));
      columns.push_back({array.begin, bytes, offset});
      offset += bytes;
    }
    has_columns(std::move(file), std::move(columns), info_.schema.fields);
  }
};

class TextVtkReader final : public Reader {
 public:
  TextVtkReader(std::shared_ptr<const InputFile> file, VtkLayout layout)
      : file_(std::move(file)), layout_(std::move(layout)) {
    info_ = info_of(*file_, layout_);
    constexpr std::uint64_t kWindowBytes = 16 << 10;
    info_.decoder_bytes = layout_.arrays.size() * kWindowBytes;
  }

  Chunk chunk_of(std::uint64_t row) const override {
    const std::uint64_t first = row / VtkLayout::kRowsPerPlace * VtkLayout::kRowsPerPlace;
    return {.first_row = first, .rows = std::min(VtkLayout::kRowsPerPlace, info_.count - first), .bounds = {}};
  }
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields&) const override { return std::make_unique<Decoder>(*this); }

 private:
  /// The values of one array, row after row.
  struct Stream {
    const VtkArray* array;
    std::uint32_t offset;  ///< offset in the record
    VtkScanner text;
    std::uint64_t next;  ///< row of the next value
  };

  class Decoder final : public RowDecoder {
   public:
    explicit Decoder(const TextVtkReader& reader) : reader_(reader) {
      std::uint32_t offset = 0;
      for (const VtkArray& array : reader.layout_.arrays) {
        streams_.push_back({&array, offset, VtkScanner(*reader.file_), reader.info_.count});
        offset += array.components * static_cast<std::uint32_t>(size_of(array.type));
      }
    }

    std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
      const std::size_t rows = reader_.rows_for(row, records), stride = reader_.info_.schema.stride;
      if (rows == 0) return 0;
      for (Stream& stream : streams_) {
        go_to(stream, row);
        for (std::size_t i = 0; i < rows; ++i) decode(stream, records.data() + i * stride + stream.offset);
        stream.next = row + rows;
      }
      return rows;
    }

   private:
    void go_to(Stream& stream, std::uint64_t row) {
      const std::uint64_t place = row / VtkLayout::kRowsPerPlace, first = place * VtkLayout::kRowsPerPlace;
      if (row < stream.next || first > stream.next) {
        stream.text.jump(stream.array->places[static_cast<std::size_t>(place)]);
        stream.next = first;
      }
      stream.text.skip_words((row - stream.next) * stream.array->components);
    }

    void decode(Stream& stream, std::byte* to) {
      const VtkArray& array = *stream.array;
      with_type(array.type, [&]<class T>() {
        for (std::uint32_t c = 0; c < array.components; ++c, to += sizeof(T)) {
          const T value = array.shares ? static_cast<T>(share_of_255(word(stream), stream)) : number<T>(stream);
          std::memcpy(to, &value, sizeof value);
        }
      });
    }

    std::string_view word(Stream& stream) {
      const auto word = stream.text.word();
      if (!word)
        fail("{}: has become shorter since it was opened; run again while no program writes to it.",
             reader_.info_.path.string());
      return *word;
    }
    template <class T>
    T number(Stream& stream) {
      const std::string_view text = word(stream);
      T value{};
      if (!parse_number(text, value)) complain(text, stream);
      return value;
    }
    double share_of_255(std::string_view text, const Stream& stream) const {
      double value = 0;
      if (!parse_number(text, value) || std::isnan(value)) complain(text, stream);
      return std::round(std::clamp(value, 0.0, 1.0) * 255);
    }
    [[noreturn]] void complain(std::string_view text, const Stream& stream) const {
      fail("{}: before byte {}: '{}' in '{}' is no {}; correct it.", reader_.info_.path.string(), stream.text.offset(),
           text.substr(0, 40), stream.array->name, name_of(stream.array->type));
    }

    const TextVtkReader& reader_;
    std::vector<Stream> streams_;
  };

  std::shared_ptr<const InputFile> file_;
  VtkLayout layout_;
};

constexpr std::string_view kVtkExtensions[] = {".vtk"};

/// Opens a file. Points have all their attributes: scalars, vectors, normals (nx ny nz), colours (red green blue
/// alpha), texture coordinates, tensors and arrays of fields, in the types of the file; a warning names those whose
/// type or number of values no attribute can have. Cells and their attributes are left out; a warning counts the cells,
/// except vertices. Opening a text file reads it once. Throws Error for a damaged or truncated file.
std::unique_ptr<Reader> open_vtk(const std::filesystem::path& path) {
  auto file = std::make_shared<const InputFile>(path);
  VtkLayout layout = read_vtk_layout(*file);
  if (!layout.text) return std::make_unique<BinaryVtkReader>(std::move(file), layout);
  return std::make_unique<TextVtkReader>(std::move(file), std::move(layout));
}

}  // namespace

const Format kVtkFormat = {.name = "VTK",
                           .title = "VTK legacy",
                           .details = "#vtk",
                           .reads = "points of POLYDATA, UNSTRUCTURED_GRID, STRUCTURED_GRID; ascii, binary",
                           .writes = "no",
                           .extensions = kVtkExtensions,
                           .is = starts_as_vtk,
                           .open = open_vtk};

}  // namespace pointsweep
