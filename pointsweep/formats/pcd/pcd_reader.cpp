// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/pcd/lzf_stream.h"
#include "pointsweep/formats/pcd/pcd_format.h"
#include "pointsweep/formats/records/record_readers.h"
#include "pointsweep/points/with_type.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {
namespace {

std::string_view name_of_data(PcdData data) {
  return data == PcdData::ascii ? "ascii" : data == PcdData::binary ? "binary" : "binary_compressed";
}

/// Returns whether "VIEWPOINT tx ty tz qw qx qy qz" is the identity. Numbers that the line lacks count as those of the
/// identity.
bool is_identity(std::string_view viewpoint) {
  take_word(viewpoint);
  for (const double expected : {0, 0, 0, 1, 0, 0, 0}) {
    const std::string_view word = take_word(viewpoint);
    double value = 0;
    if (word.empty()) return true;
    if (!parse_number(word, value) || value != expected) return false;
  }
  return true;
}

/// Returns whether a line VIEWPOINT has all of its seven numbers, so that an output can repeat the line.
bool is_whole(std::string_view viewpoint) {
  take_word(viewpoint);
  double value = 0;
  for (int i = 0; i < 7; ++i)
    if (!parse_number(take_word(viewpoint), value)) return false;
  return is_blank(viewpoint);
}

[[noreturn]] void fail_truncated(const InputFile& file, const PcdHeader& header, std::uint64_t found) {
  fail("{}: the header says {} points, but the file ends after {}; get the whole file or correct the line POINTS.",
       file.path().string(), header.points, found);
}

/// Returns the facts in the header of a file of any encoding.
FileInfo info_of(const InputFile& file, const PcdHeader& header) {
  FileInfo info;
  const std::string name = file.path().string();
  info.path = file.path();
  info.format = fmt::format("PCD {}", name_of_data(header.data));
  info.bytes = file.size();
  info.schema = header.schema();
  info.count = header.points;
  info.provenance = header.provenance;
  auto extras = std::make_shared<PcdExtras>();
  if (is_whole(header.viewpoint)) extras->viewpoint = header.viewpoint;
  info.extras = std::move(extras);
  position_fields(info.schema, name);
  if (!is_identity(header.viewpoint))
    info.warnings.push_back(fmt::format("{}: its line '{}' is not applied to the points.", name, header.viewpoint));
  if (header.height > 1)
    info.warnings.push_back(fmt::format("{}: that its points are {} rows of {} is not kept in an output.", name,
                                        header.height, header.width));
  return info;
}

/// Reads uncompressed files. A file may be longer than its points: PCL pads it to a page.
class BinaryPcdReader final : public ColumnsReader {
 public:
  BinaryPcdReader(std::shared_ptr<const InputFile> file, const PcdHeader& header) {
    info_ = info_of(*file, header);
    const std::uint64_t found = (file->size() - header.body_offset) / header.stride;
    if (found < header.points) fail_truncated(*file, header, found);
    has_records(std::move(file), header.body_offset);
  }
};

class PcdLineParser final : public LineParser {
 public:
  PcdLineParser(const std::filesystem::path& path, const PcdHeader& header) : path_(path), header_(header) {}

  static bool is_row(std::string_view line) { return !is_blank(line); }

  void parse(std::string_view line, std::uint64_t number, std::byte* record) override {
    for (const PcdField& field : header_.fields) {
      for (std::uint32_t c = 0; c < field.count; ++c) {
        const std::string_view word = take_word(line);
        if (word.empty()) complain(number, "has fewer values than the header has fields");
        if (!store(field, word, record + field.offset + c * size_of(field.type)))
          complain(number, fmt::format("'{}' is no {} for the field '{}'", word.substr(0, 40), name_of(field.type),
                                       field.name));
      }
    }
    if (!is_blank(line)) complain(number, "has more values than the header has fields");
  }

 private:
  static bool store(const PcdField& field, std::string_view word, std::byte* to) {
    return with_type(field.type, [&]<class T>() {
      T value{};
      if (!parse_number(word, value)) return false;
      std::memcpy(to, &value, sizeof value);
      return true;
    });
  }

  [[noreturn]] void complain(std::uint64_t number, std::string_view what) const {
    fail("{}: line {} {}; correct the line or the header.", path_.string(), number, what);
  }

  const std::filesystem::path& path_;
  const PcdHeader& header_;
};

class AsciiPcdReader final : public RowTextReader {
 public:
  AsciiPcdReader(std::unique_ptr<const InputFile> file, PcdHeader header) : header_(std::move(header)) {
    file_ = std::move(file);
    info_ = info_of(*file_, header_);
    LineReader lines(*file_);
    lines.jump(header_.body_offset, header_.body_line);
    rows_.emplace(lines, PcdLineParser::is_row, header_.points);
    if (rows_->count() < header_.points) fail_truncated(*file_, header_, rows_->count());
  }

 private:
  std::unique_ptr<LineParser> parser() const override { return std::make_unique<PcdLineParser>(info_.path, header_); }

  PcdHeader header_;
};

/// Reads files that store all values of the first field, then all of the second, and so on, compressed as one block.
/// Chunks are the rows between places at which decompression of every field can begin.
class CompressedPcdReader final : public Reader {
 public:
  CompressedPcdReader(std::unique_ptr<const InputFile> file, const PcdHeader& header)
      : file_(std::move(file)), stride_(header.stride) {
    info_ = info_of(*file_, header);
    const std::string name = file_->path().string();
    std::uint32_t sizes[2] = {};  // bytes of the compressed and of the decompressed data
    if (file_->size() < header.body_offset + sizeof sizes) fail_truncated(*file_, header, 0);
    file_->read_at(header.body_offset, std::as_writable_bytes(std::span(sizes)));
    const std::uint64_t begin = header.body_offset + sizeof sizes;
    if (file_->size() - begin < sizes[0])
      fail("{}: its compressed data should be {} bytes long, but the file ends after {}; get the whole file.", name,
           sizes[0], file_->size() - begin);
    if (sizes[1] / header.stride != header.points || sizes[1] % header.stride != 0)
      fail("{}: its compressed data hold {} bytes, but {} points take {}; correct the header or write the file again.",
           name, sizes[1], header.points, header.points * header.stride);
    find_places(LzfStream(*file_, begin, sizes[0]), header);
  }

  Chunk chunk_of(std::uint64_t row) const override {
    const std::uint64_t first = row / chunk_rows_ * chunk_rows_;
    return {.first_row = first, .rows = std::min(chunk_rows_, info_.count - first), .bounds = {}};
  }
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted) const override {
    return std::make_unique<Decoder>(*this, wanted);
  }

 private:
  /// A field, whose values are one piece of the decompressed block.
  struct Column {
    std::uint32_t offset, bytes;
    std::uint64_t begin;                   ///< begin in the decompressed block
    std::vector<LzfStream::State> places;  ///< states at rows 0, chunk_rows_, ...
  };

  class Decoder final : public RowDecoder {
   public:
    Decoder(const CompressedPcdReader& reader, const WantedFields& wanted) : reader_(reader) {
      for (const Column& column : reader.columns_)
        if (wanted.empty() || std::ranges::any_of(wanted, [&](std::size_t f) { return holds(column, f); }))
          streams_.push_back({&column, *reader.begin_});
    }

    std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
      const std::size_t rows = reader_.rows_for(row, records);
      if (rows == 0) return 0;
      for (auto& [column, stream] : streams_) {
        go_to(*column, stream, row);
        values_.resize(rows * column->bytes);
        stream.read(values_);
        for (std::size_t i = 0; i < rows; ++i)
          std::memcpy(records.data() + i * reader_.stride_ + column->offset, values_.data() + i * column->bytes,
                      column->bytes);
      }
      return rows;
    }

   private:
    /// Returns whether a field, which may be one of several colours in a column, is in the column.
    bool holds(const Column& column, std::size_t field) const {
      const std::uint32_t offset = reader_.info().schema.fields[field].offset;
      return offset >= column.offset && offset < column.offset + column.bytes;
    }

    void go_to(const Column& column, LzfStream& stream, std::uint64_t row) const {
      const LzfStream::State& place = column.places[row / reader_.chunk_rows_];
      const std::uint64_t wanted = column.begin + row * column.bytes, at = stream.state().out;
      if (at > wanted || at < place.out) stream.go_to(place);
      stream.skip(wanted - stream.state().out);
    }

    const CompressedPcdReader& reader_;
    std::vector<std::pair<const Column*, LzfStream>> streams_;
    std::vector<std::byte> values_;
  };

  void find_places(LzfStream stream, const PcdHeader& header) {
    constexpr std::uint64_t kBetweenPlaces = 16 << 20;  // a stored place every 16 MiB of the widest field
    std::uint32_t widest = 1;
    for (const PcdField& field : header.fields) widest = std::max(widest, field.bytes());
    chunk_rows_ = std::max<std::uint64_t>(kBetweenPlaces / widest, 1);
    begin_.emplace(stream);
    for (const PcdField& field : header.fields) {
      if (field.bytes() == 0) continue;
      Column column{field.offset, field.bytes(), stream.state().out, {}};
      for (std::uint64_t row = 0; row < header.points; row += chunk_rows_) {
        stop_if_cancelled();
        column.places.push_back(stream.state());
        stream.skip(std::min(chunk_rows_, header.points - row) * field.bytes());
      }
      columns_.push_back(std::move(column));
    }
  }

  std::unique_ptr<const InputFile> file_;
  std::uint32_t stride_;
  std::uint64_t chunk_rows_ = 1;
  std::vector<Column> columns_;
  std::optional<LzfStream> begin_;  ///< stream at the beginning of the block
};

}  // namespace

bool starts_as_pcd(std::string_view head) {
  if (head.starts_with("# .PCD") || head.starts_with("VERSION .") || head.starts_with("VERSION 0.")) return true;
  return head.starts_with("FIELDS ") && head.find("\nDATA ") != head.npos;
}

std::unique_ptr<Reader> open_pcd(const std::filesystem::path& path) {
  auto file = std::make_unique<InputFile>(path);
  PcdHeader header = read_pcd_header(*file);
  if (header.data == PcdData::ascii) return std::make_unique<AsciiPcdReader>(std::move(file), std::move(header));
  if (header.data == PcdData::binary) return std::make_unique<BinaryPcdReader>(std::move(file), std::move(header));
  return std::make_unique<CompressedPcdReader>(std::move(file), std::move(header));
}

}  // namespace pointsweep
