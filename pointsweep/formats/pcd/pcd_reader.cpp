// SPDX-License-Identifier: MIT
#include "pointsweep/formats/pcd/pcd_reader.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"
#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/files/row_lines.h"
#include "pointsweep/formats/pcd/lzf_stream.h"
#include "pointsweep/formats/pcd/pcd_header.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

std::string_view name_of_data(PcdData data) {
  return data == PcdData::ascii ? "ascii" : data == PcdData::binary ? "binary" : "binary_compressed";
}

/// Whether "VIEWPOINT tx ty tz qw qx qy qz" is the identity.
bool is_identity(std::string_view viewpoint) {
  constexpr double kIdentity[] = {0, 0, 0, 1, 0, 0, 0};
  std::size_t at = viewpoint.find(' ');
  for (const double expected : kIdentity) {
    at = viewpoint.find_first_not_of(" \t", at);
    if (at == viewpoint.npos) return true;  // incomplete: it says nothing
    const std::size_t end = std::min(viewpoint.find_first_of(" \t", at), viewpoint.size());
    double value = 0;
    if (!parse_number(viewpoint.substr(at, end - at), value) || value != expected) return false;
    at = end;
  }
  return true;
}

class PcdReader : public Reader {
 protected:
  PcdReader(std::unique_ptr<InputFile> file, PcdHeader header) : file_(std::move(file)), header_(std::move(header)) {
    info_.path = file_->path();
    info_.format = fmt::format("PCD {}", name_of_data(header_.data));
    info_.bytes = file_->size();
    info_.schema = header_.schema();
    info_.count = header_.points;
    position_fields(info_.schema, name());
    if (!is_identity(header_.viewpoint))
      info_.warnings.push_back(
          fmt::format("{}: its line '{}' is not applied to the points.", name(), header_.viewpoint));
    if (header_.height > 1)
      info_.warnings.push_back(fmt::format("{}: that its points are {} rows of {} is not kept in an output.", name(),
                                           header_.height, header_.width));
  }

  std::string name() const { return file_->path().string(); }
  [[noreturn]] void fail_truncated(std::uint64_t found) const {
    fail("{}: the header says {} points, but the file ends after {}; get the whole file or correct the line POINTS.",
         name(), header_.points, found);
  }

  std::unique_ptr<InputFile> file_;
  PcdHeader header_;
};

/// The file may be longer than its points: PCL fills it up to a page.
class BinaryPcdReader final : public PcdReader {
 public:
  BinaryPcdReader(std::unique_ptr<InputFile> file, PcdHeader header) : PcdReader(std::move(file), std::move(header)) {
    const std::uint64_t found = (file_->size() - header_.body_offset) / header_.stride;
    if (found < header_.points) fail_truncated(found);
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = rows_for(row, records);
    file_->read_at(header_.body_offset + row * header_.stride, records.first(rows * header_.stride));
    return rows;
  }
};

class AsciiPcdReader final : public PcdReader {
 public:
  AsciiPcdReader(std::unique_ptr<InputFile> file, PcdHeader header)
      : PcdReader(std::move(file), std::move(header)), rows_(find_rows(*file_, header_)) {
    if (rows_.count() < header_.points) fail_truncated(rows_.count());
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = rows_for(row, records);
    for (std::size_t i = 0; i < rows; ++i) parse(rows_.at(row + i), records.data() + i * header_.stride);
    if (rows != 0 && row + rows == info_.count) rows_.rest();
    return rows;
  }

 private:
  static bool is_row(std::string_view line) { return line.find_first_not_of(" \t\r") != line.npos; }
  static RowLines find_rows(const InputFile& file, const PcdHeader& header) {
    LineReader lines(file);
    lines.jump(header.body_offset, header.body_line);
    return RowLines(lines, is_row, header.points);
  }

  void parse(std::string_view line, std::byte* record) const {
    std::size_t at = 0;
    for (const PcdField& field : header_.fields) {
      for (std::uint32_t c = 0; c < field.count; ++c) {
        const std::size_t start = line.find_first_not_of(" \t\r", at);
        if (start == line.npos) complain("has fewer values than the header has fields");
        at = std::min(line.find_first_of(" \t\r", start), line.size());
        const std::string_view word = line.substr(start, at - start);
        if (!store(field, word, record + field.offset + c * size_of(field.type)))
          complain(
              fmt::format("'{}' is no {} for the field '{}'", word.substr(0, 40), name_of(field.type), field.name));
      }
    }
    if (line.find_first_not_of(" \t\r", at) != line.npos) complain("has more values than the header has fields");
  }

  static bool store(const PcdField& field, std::string_view word, std::byte* to) {
    return with_type(field.type, [&]<class T>() {
      T value{};
      if (!parse_number(word, value)) return false;
      std::memcpy(to, &value, sizeof value);
      return true;
    });
  }

  [[noreturn]] void complain(std::string_view what) const {
    fail("{}: line {} {}; correct the line or the header.", name(), rows_.line(), what);
  }

  RowLines rows_;
};

/// All values of the first field, then all of the second, and so on, compressed as one block.
class CompressedPcdReader final : public PcdReader {
 public:
  CompressedPcdReader(std::unique_ptr<InputFile> file, PcdHeader header)
      : PcdReader(std::move(file), std::move(header)) {
    std::uint32_t sizes[2] = {};  // compressed, decompressed
    if (file_->size() < header_.body_offset + sizeof sizes) fail_truncated(0);
    file_->read_at(header_.body_offset, std::as_writable_bytes(std::span(sizes)));
    const std::uint64_t begin = header_.body_offset + sizeof sizes;
    if (file_->size() - begin < sizes[0])
      fail("{}: its compressed data should be {} bytes long, but the file ends after {}; get the whole file.", name(),
           sizes[0], file_->size() - begin);
    if (sizes[1] / header_.stride != header_.points || sizes[1] % header_.stride != 0)
      fail("{}: its compressed data hold {} bytes, but {} points take {}; correct the header or write the file again.",
           name(), sizes[1], header_.points, header_.points * header_.stride);
    find_places(LzfStream(*file_, begin, sizes[0]));
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = rows_for(row, records);
    for (Column& column : columns_) {
      go_to(column, row);
      values_.resize(rows * column.bytes);
      column.stream.read(values_);
      for (std::size_t i = 0; i < rows; ++i)
        std::memcpy(records.data() + i * header_.stride + column.offset, values_.data() + i * column.bytes,
                    column.bytes);
    }
    return rows;
  }

 private:
  struct Place {
    std::uint64_t row;
    LzfStream::State state;
  };
  /// A field in the block, with the places at which its decompression can begin.
  struct Column {
    std::uint32_t offset, bytes;
    std::uint64_t begin;  ///< in the decompressed block
    LzfStream stream;
    std::vector<Place> places;
  };

  void find_places(LzfStream stream) {
    constexpr std::uint64_t kBetweenPlaces = 16 << 20;
    for (const PcdField& field : header_.fields) {
      if (field.bytes() == 0) continue;
      Column column{field.offset, field.bytes(), stream.state().out, stream, {}};
      const std::uint64_t step = std::max<std::uint64_t>(kBetweenPlaces / field.bytes(), 1);
      for (std::uint64_t row = 0; row < header_.points; row += step) {
        stop_if_cancelled();
        column.places.push_back({row, stream.state()});
        stream.skip(std::min(step, header_.points - row) * field.bytes());
      }
      columns_.push_back(std::move(column));
    }
  }

  static void go_to(Column& column, std::uint64_t row) {
    const auto behind = std::ranges::upper_bound(column.places, row, {}, &Place::row);
    if (behind == column.places.begin()) return;  // no rows
    const Place& place = *std::prev(behind);
    const std::uint64_t wanted = column.begin + row * column.bytes, at = column.stream.state().out;
    if (at > wanted || at < place.state.out) column.stream.go_to(place.state);
    column.stream.skip(wanted - column.stream.state().out);
  }

  std::vector<Column> columns_;
  std::vector<std::byte> values_;
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
