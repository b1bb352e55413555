// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/number_from.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {
namespace {

constexpr double kMostColor = 255;

/// The meaning of the numbers of a line, in order. Coordinates, normals and texture coordinates are read as float64;
/// colours as uint8, from the range [0, 1] if no colour in the file is larger than 1, else from [0, 255].
struct VertexColumns {
  bool normal = false;
  std::size_t color = 0;  ///< components: 0, 3 or 4
  bool texture = false;
  std::size_t ignored = 0;  ///< further numbers at the end of the line
};

/// Reads the vertices of a mesh file, one line each. The constructor of a subclass calls set_columns().
class VertexLineReader : public Reader {
 public:
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;
  /// Stores the values of the lines of `rows` rows, `stride` bytes apart; all rows must exist.
  void fill(std::uint64_t row, std::size_t rows, std::byte* to, std::size_t stride);

 protected:
  /// The rows are the lines for which `is_row` is true, from the position of `lines` on, at most `most`. `has_keyword`:
  /// each line has a word before its numbers.
  VertexLineReader(std::unique_ptr<InputFile> file, const LineReader& lines, RowLines::IsRow is_row, std::uint64_t most,
                   bool has_keyword);

  const InputFile& file() const { return *file_; }
  std::string_view first_line() { return cursor_.at(0); }  ///< must be called only if there is a row
  /// Returns the numbers in a line, after its keyword and before a comment; valid until the next call.
  const std::vector<double>& numbers(std::string_view line);
  /// Makes the fields. Reads colours until one is larger than 1, to find their range.
  void set_columns(const VertexColumns& columns);
  std::uint64_t rows() const { return rows_.count(); }

 private:
  std::unique_ptr<InputFile> file_;
  RowLines rows_;
  RowCursor cursor_{rows_};
  bool has_keyword_;
  VertexColumns columns_;
  std::size_t width_ = 3;  ///< numbers in a line
  double color_scale_ = 1;
  std::vector<double> numbers_;
};

VertexLineReader::VertexLineReader(std::unique_ptr<InputFile> file, const LineReader& lines, RowLines::IsRow is_row,
                                   std::uint64_t most, bool has_keyword)
    : file_(std::move(file)), rows_(lines, is_row, most), has_keyword_(has_keyword) {
  info_.path = file_->path();
  info_.bytes = file_->size();
  info_.count = rows_.count();
}

const std::vector<double>& VertexLineReader::numbers(std::string_view line) {
  numbers_.clear();
  if (has_keyword_) take_word(line);
  for (std::string_view word = take_word(line); !word.empty() && word[0] != '#'; word = take_word(line)) {
    double value = 0;
    if (!parse_number(word, value))
      fail("{}: line {}: '{}' is no number; correct it.", file_->path().string(), cursor_.line(), word.substr(0, 40));
    numbers_.push_back(value);
  }
  return numbers_;
}

void VertexLineReader::set_columns(const VertexColumns& columns) {
  columns_ = columns;
  for (const char* axis : {"x", "y", "z"}) info_.schema.append(axis, Type::f64);
  if (columns.normal)
    for (const char* axis : {"nx", "ny", "nz"}) info_.schema.append(axis, Type::f64);
  if (columns.texture)
    for (const char* axis : {"texture_u", "texture_v"}) info_.schema.append(axis, Type::f64);
  const char* const colors[] = {"red", "green", "blue", "alpha"};
  for (std::size_t c = 0; c < columns.color; ++c) info_.schema.append(colors[c], Type::u8);
  width_ = 3 + (columns.normal ? 3 : 0) + columns.color + (columns.texture ? 2 : 0) + columns.ignored;
  if (columns.color == 0) return;
  const std::size_t first = columns.normal ? 6 : 3;
  bool fractions = true;
  for (std::uint64_t row = 0; row < rows_.count() && fractions; ++row) {
    if (row % 65536 == 0) stop_if_cancelled();
    const std::vector<double>& values = numbers(cursor_.at(row));
    for (std::size_t c = first; c < std::min(first + columns.color, values.size()); ++c)
      fractions = fractions && values[c] <= 1;
  }
  color_scale_ = fractions ? kMostColor : 1;
  cursor_.rest();
}

std::size_t VertexLineReader::read(std::uint64_t row, std::span<std::byte> records) {
  const std::size_t rows = rows_for(row, records);
  fill(row, rows, records.data(), info_.schema.stride);
  return rows;
}

/// Lines have x y z, then the normal, the colour and the texture coordinates, if the file has them. In a record, the
/// colour stands after the texture coordinates.
void VertexLineReader::fill(std::uint64_t row, std::size_t rows, std::byte* records, std::size_t stride) {
  const std::size_t lengths = 3 + (columns_.normal ? 3 : 0);
  for (std::size_t i = 0; i < rows; ++i, records += stride) {
    const std::vector<double>& values = numbers(cursor_.at(row + i));
    if (values.size() != width_)
      fail("{}: line {} has {} numbers where the first vertex has {}; correct the line.", file_->path().string(),
           cursor_.line(), values.size(), width_);
    std::byte* to = records;
    std::memcpy(to, values.data(), lengths * sizeof(double));
    to += lengths * sizeof(double);
    if (columns_.texture) {
      std::memcpy(to, values.data() + lengths + columns_.color, 2 * sizeof(double));
      to += 2 * sizeof(double);
    }
    for (std::size_t c = 0; c < columns_.color; ++c)
      *to++ = static_cast<std::byte>(std::lround(std::clamp(values[lengths + c] * color_scale_, 0.0, kMostColor)));
  }
  if (rows != 0 && row + rows == info_.count) cursor_.rest();
}

bool is_vertex_line(std::string_view line) {
  const std::size_t at = line.find_first_not_of(" \t");
  return at != line.npos && line[at] != '#';
}

struct OffHeader {
  bool texture = false, normal = false;  ///< true if the keyword has the letters ST, or N
  std::uint64_t vertices = 0, faces = 0;
};

/// Removes the keyword, letters that end with OFF, from the beginning of `line` and returns its meaning. Returns
/// nothing if there is no keyword.
std::optional<OffHeader> take_keyword(std::string_view& line) {
  OffHeader header;
  const auto take = [&](std::string_view word) {
    if (!line.starts_with(word)) return false;
    line.remove_prefix(word.size());
    return true;
  };
  header.texture = take("ST");
  take("C");  // the first vertex tells whether there are colours
  header.normal = take("N");
  if (!take("OFF") || (!line.empty() && line[0] != ' ' && line[0] != '\t' && line[0] != '\r' && line[0] != '\n'))
    return std::nullopt;
  return header;
}

std::optional<std::uint64_t> take_count(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  return take_number<std::uint64_t>(line);
}

/// Reads the header, after which `lines` stands before the first vertex.
OffHeader read_header(LineReader& lines) {
  const std::string path = lines.file().path().string();
  std::string_view line = lines.next().value_or("");
  std::optional<OffHeader> header = take_keyword(line);
  if (!header) fail("{}: is no OFF file, since it does not begin with OFF, COFF, NOFF or the like.", path);
  if (line.find("BINARY") != line.npos)
    fail("{}: is a binary OFF file, which pointsweep does not read; export its points as PLY.", path);
  while (!is_vertex_line(line)) {
    const auto next = lines.next();
    if (!next) fail("{}: ends before the numbers of vertices and faces; get the whole file.", path);
    line = *next;
  }
  const auto vertices = take_count(line), faces = take_count(line);
  if (!vertices || !faces)
    fail("{}: line {} should hold the numbers of vertices, faces and edges; correct it.", path, lines.line());
  header->vertices = *vertices;
  header->faces = *faces;
  return *header;
}

class OffReader final : public VertexLineReader {
 public:
  OffReader(std::unique_ptr<InputFile> file, const LineReader& lines, const OffHeader& header)
      : VertexLineReader(std::move(file), lines, is_vertex_line, header.vertices, false) {
    const std::string path = info_.path.string();
    info_.format = "OFF";
    if (rows() < header.vertices)
      fail("{}: the header says {} vertices, but the file ends after {}; get the whole file.", path, header.vertices,
           rows());
    VertexColumns columns{.normal = header.normal, .color = 0, .texture = header.texture, .ignored = 0};
    const std::size_t known = 3 + (header.normal ? 3 : 0) + (header.texture ? 2 : 0);
    const std::size_t found = rows() == 0 ? known : numbers(first_line()).size();
    const std::size_t more = found < known ? 0 : found - known;
    if (found < known || more > 4 || more == 1 || more == 2)
      fail("{}: its first vertex has {} numbers, which cannot be coordinates{}{} and a colour; correct it.", path,
           found, header.normal ? ", a normal" : "", header.texture ? ", texture coordinates" : "");
    columns.color = more;
    set_columns(columns);
    if (header.faces != 0) info_.warnings.push_back(fmt::format("{}: its {} faces are left out.", path, header.faces));
  }
};

/// Returns whether a file begins with OFF, or with ST, C and N (texture coordinates, colours, normals) before OFF.
bool starts_as_off(std::string_view head) { return take_keyword(head).has_value(); }

/// Opens an OFF file. Reads normals of NOFF, texture coordinates of STOFF, and colours, with or without C in the
/// keyword; ignores faces with a warning. Throws Error for a binary file, a file of four dimensions, and a file with
/// fewer vertices than its header states.
std::unique_ptr<Reader> open_off(const std::filesystem::path& path) {
  auto file = std::make_unique<InputFile>(path);
  LineReader lines(*file);
  const OffHeader header = read_header(lines);
  return std::make_unique<OffReader>(std::move(file), lines, header);
}

bool has_keyword(std::string_view line, std::string_view word) {
  return take_word(line) == word && !line.empty() && (line[0] == ' ' || line[0] == '\t');
}

bool is_vertex(std::string_view line) { return has_keyword(line, "v"); }
bool is_normal(std::string_view line) { return has_keyword(line, "vn"); }

/// Reads the normals of an OBJ file as a cloud: their fields are called x, y and z.
class NormalLines final : public VertexLineReader {
 public:
  NormalLines(std::unique_ptr<InputFile> file, const LineReader& lines)
      : VertexLineReader(std::move(file), lines, is_normal, std::numeric_limits<std::uint64_t>::max(), true) {
    set_columns({});
  }
};

class ObjReader final : public VertexLineReader {
 public:
  ObjReader(std::unique_ptr<InputFile> file, const LineReader& lines)
      : VertexLineReader(std::move(file), lines, is_vertex, std::numeric_limits<std::uint64_t>::max(), true) {
    info_.format = "OBJ";
    const std::size_t found = rows() == 0 ? 3 : numbers(first_line()).size();
    if (found != 3 && found != 4 && found != 6 && found != 7)
      fail("{}: its first vertex has {} numbers instead of x y z, perhaps with a weight or a colour; correct it.",
           info_.path.string(), found);
    VertexColumns columns;
    columns.color = found >= 6 ? found - 3 : 0;
    columns.ignored = found == 4 ? 1 : 0;
    set_columns(columns);
    add_normals();
    warn();
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = VertexLineReader::read(row, records);
    const std::size_t stride = info_.schema.stride;
    if (normals_) normals_->fill(row, rows, records.data() + stride - kNormalBytes, stride);
    return rows;
  }

 private:
  static constexpr std::size_t kNormalBytes = 3 * sizeof(double);

  void add_normals() {
    auto file = std::make_unique<InputFile>(info_.path);
    const LineReader lines(*file);
    auto normals = std::make_unique<NormalLines>(std::move(file), lines);
    normal_count_ = normals->info().count;
    if (normal_count_ == 0 || normal_count_ != info_.count) return;
    for (const char* axis : {"nx", "ny", "nz"}) info_.schema.append(axis, Type::f64);
    normals_ = std::move(normals);
  }

  void warn() {
    if (normal_count_ != 0 && !normals_)
      info_.warnings.push_back(fmt::format("{}: its {} normals are left out, since they are not one for each vertex.",
                                           info_.path.string(), normal_count_));
    LineReader lines(file());
    std::uint64_t faces = 0;
    while (const auto line = lines.next()) faces += has_keyword(*line, "f") ? 1 : 0;
    if (faces != 0) info_.warnings.push_back(fmt::format("{}: its {} faces are left out.", info_.path.string(), faces));
  }

  std::unique_ptr<NormalLines> normals_;
  std::uint64_t normal_count_ = 0;
};

/// Returns whether the first line after comments is a line of an OBJ file: v, vn, vt, mtllib, o, g, s or usemtl.
bool starts_as_obj(std::string_view head) {
  while (!head.empty()) {
    const std::size_t end = std::min(head.find('\n'), head.size());
    const std::string_view line = head.substr(0, end);
    const std::size_t at = line.find_first_not_of(" \t\r");
    if (at != line.npos && line[at] != '#') {
      for (const char* word : {"v", "vn", "vt", "mtllib", "o", "g", "s", "usemtl"})
        if (has_keyword(line, word)) return true;
      return false;
    }
    head.remove_prefix(std::min(end + 1, head.size()));
  }
  return false;
}

/// Opens an OBJ file: lines "v x y z", followed by a weight, which is ignored, or a colour. Normals ("vn") are read if
/// there are as many as vertices; the n-th normal belongs to the n-th vertex. Other normals, which only faces assign to
/// vertices, are left out with a warning, and so are faces. Other elements are ignored.
std::unique_ptr<Reader> open_obj(const std::filesystem::path& path) {
  auto file = std::make_unique<InputFile>(path);
  const LineReader lines(*file);
  return std::make_unique<ObjReader>(std::move(file), lines);
}

constexpr std::string_view kOffExtensions[] = {".off"}, kObjExtensions[] = {".obj"};

}  // namespace

const Format kOffFormat = {.name = "OFF",
                           .title = "OFF",
                           .details = "#off-and-obj",
                           .reads = "vertices of text files, with normals and colours",
                           .writes = "no",
                           .extensions = kOffExtensions,
                           .is = starts_as_off,
                           .open = open_off};

const Format kObjFormat = {.name = "OBJ",
                           .title = "OBJ",
                           .details = "#off-and-obj",
                           .reads = "vertices, with normals and colours",
                           .writes = "no",
                           .extensions = kObjExtensions,
                           .is = starts_as_obj,
                           .open = open_obj};

}  // namespace pointsweep
