// SPDX-License-Identifier: MIT
#include "pointsweep/formats/mesh/off_reader.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/mesh/vertex_lines.h"

namespace pointsweep {
namespace {

bool is_vertex_line(std::string_view line) {
  const std::size_t at = line.find_first_not_of(" \t");
  return at != line.npos && line[at] != '#';
}

struct OffHeader {
  bool texture = false, color = false, normal = false;
  std::uint64_t vertices = 0, faces = 0;
};

/// The keyword at the begin of `line`, which is taken off it: letters up to and including OFF. Nothing if it is none.
std::optional<OffHeader> take_keyword(std::string_view& line) {
  OffHeader header;
  const auto take = [&](std::string_view word) {
    if (!line.starts_with(word)) return false;
    line.remove_prefix(word.size());
    return true;
  };
  header.texture = take("ST");
  header.color = take("C");
  header.normal = take("N");
  if (!take("OFF") || (!line.empty() && line[0] != ' ' && line[0] != '\t' && line[0] != '\r' && line[0] != '\n'))
    return std::nullopt;
  return header;
}

std::optional<std::uint64_t> take_number(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error != std::errc()) return std::nullopt;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  return number;
}

/// Leaves `lines` in front of the first vertex.
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
  const auto vertices = take_number(line), faces = take_number(line);
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

}  // namespace

bool starts_as_off(std::string_view head) { return take_keyword(head).has_value(); }

std::unique_ptr<Reader> open_off(const std::filesystem::path& path) {
  auto file = std::make_unique<InputFile>(path);
  LineReader lines(*file);
  const OffHeader header = read_header(lines);
  return std::make_unique<OffReader>(std::move(file), lines, header);
}

}  // namespace pointsweep
