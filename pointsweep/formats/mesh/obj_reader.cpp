// SPDX-License-Identifier: MIT
#include "pointsweep/formats/mesh/obj_reader.h"

#include <fmt/format.h>

#include <limits>
#include <string>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/mesh/vertex_lines.h"

namespace pointsweep {
namespace {

bool has_keyword(std::string_view line, std::string_view word) {
  const std::size_t at = line.find_first_not_of(" \t");
  if (at == line.npos || !line.substr(at).starts_with(word)) return false;
  line.remove_prefix(at + word.size());
  return !line.empty() && (line[0] == ' ' || line[0] == '\t');
}

bool is_vertex(std::string_view line) { return has_keyword(line, "v"); }
bool is_normal(std::string_view line) { return has_keyword(line, "vn"); }

/// Normals, as a reader that gives them in place of coordinates.
class NormalLines final : public VertexLineReader {
 public:
  explicit NormalLines(const std::filesystem::path& path, std::unique_ptr<InputFile> file, const LineReader& lines)
      : VertexLineReader(std::move(file), lines, is_normal, std::numeric_limits<std::uint64_t>::max(), true) {
    info_.path = path;
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
    auto normals = std::make_unique<NormalLines>(info_.path, std::move(file), lines);
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

}  // namespace

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

std::unique_ptr<Reader> open_obj(const std::filesystem::path& path) {
  auto file = std::make_unique<InputFile>(path);
  const LineReader lines(*file);
  return std::make_unique<ObjReader>(std::move(file), lines);
}

}  // namespace pointsweep
