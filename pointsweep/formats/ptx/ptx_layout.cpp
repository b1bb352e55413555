// SPDX-License-Identifier: MIT
#include "pointsweep/formats/ptx/ptx_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMostScans = 65536;
constexpr std::uint64_t kMostCellsAlong = std::uint64_t{1} << 31;  ///< rows times columns must fit in 64 bits
constexpr std::size_t kHeaderLines = 10;

/// Numbers in the lines of a header: columns, rows, position and axes of the scanner, transformation.
constexpr std::array<std::size_t, kHeaderLines> kHeaderNumbers{1, 1, 3, 3, 3, 3, 4, 4, 4, 4};

/// Returns all numbers of a line; nothing if a word is not a number or there are more than `most` words.
std::optional<std::vector<double>> ptx_numbers(std::string_view line, std::size_t most) {
  std::vector<double> numbers;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    double value = 0;
    if (numbers.size() == most || !parse_number(word, value)) return std::nullopt;
    numbers.push_back(value);
  }
  return numbers;
}

/// Returns whether a word is the number 0, by its characters: all digits before an exponent are 0.
bool is_zero(std::string_view word) {
  bool any = false;
  for (const char c : word) {
    if (c == 'e' || c == 'E') break;
    if (c != '0' && c != '.' && c != '-' && c != '+') return false;
    any = any || c == '0';
  }
  return any;
}

bool is_empty_cell(std::string_view line) {
  return is_zero(take_word(line)) && is_zero(take_word(line)) && is_zero(take_word(line));
}

class PtxFinder {
 public:
  explicit PtxFinder(const InputFile& file) : file_(file), lines_(file) {}

  PtxLayout run() {
    while (std::optional<std::string_view> line = next_line()) {
      if (layout_.scans.size() == kMostScans) fail("{}: has more than {} scans.", name(), kMostScans);
      take_header(*line);
      walk_cells();
    }
    return std::move(layout_);
  }

 private:
  std::string name() const { return file_.path().string(); }

  /// Returns the next line that is not blank.
  std::optional<std::string_view> next_line() {
    for (;;) {
      const auto line = lines_.next();
      if (!line || !is_blank(*line)) return line;
    }
  }

  void take_header(std::string_view line) {
    PtxScan scan;
    for (std::size_t i = 0; i < kHeaderLines; ++i) {
      if (i > 0) {
        const auto next = next_line();
        if (!next) fail("{}: ends inside the header of scan {}; get the whole file.", name(), layout_.scans.size() + 1);
        line = *next;
      }
      const auto numbers = ptx_numbers(line, kHeaderNumbers[i]);
      if (!numbers || numbers->size() != kHeaderNumbers[i])
        fail("{}: line {}, in the header of scan {}, should hold {}; correct it or export the file again.", name(),
             lines_.line(), layout_.scans.size() + 1,
             kHeaderNumbers[i] == 1 ? "one number" : fmt::format("{} numbers", kHeaderNumbers[i]));
      if (i < 2) (i == 0 ? scan.columns : scan.rows) = cells_along(line);
      if (i >= 6) std::ranges::copy(*numbers, scan.matrix.begin() + static_cast<std::ptrdiff_t>(4 * (i - 6)));
    }
    const auto& m = scan.matrix;
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      fail("{}: the transformation above line {} should end with 0 0 0 1 in its last column; correct it.", name(),
           lines_.next_line());
    layout_.scans.push_back(scan);
  }

  std::uint64_t cells_along(std::string_view line) const {
    std::uint64_t count = 0;
    if (!parse_number(take_word(line), count) || count >= kMostCellsAlong)
      fail("{}: line {} should hold a number of columns or rows; correct it.", name(), lines_.line());
    return count;
  }

  void walk_cells() {
    PtxScan& scan = layout_.scans.back();
    for (std::uint64_t cell = 0; cell < scan.cells(); ++cell) {
      const PtxPlace place{lines_.offset(), lines_.next_line(), layout_.scans.size() - 1, cell};
      const auto line = next_line();
      if (!line)
        fail("{}: scan {} should have {} × {} cells, but the file ends after {}; get the whole file.", name(),
             layout_.scans.size(), scan.columns, scan.rows, cell);
      if (cell == 0) scan.width = width_of(*line);
      if (is_empty_cell(*line)) {
        ++layout_.empty;
        continue;
      }
      if (layout_.points % PtxLayout::kPointsPerPlace == 0) layout_.places.push_back(place);
      ++layout_.points;
      layout_.end = lines_.offset();
    }
  }

  std::size_t width_of(std::string_view line) const {
    const auto numbers = ptx_numbers(line, 7);
    const std::size_t width = numbers ? numbers->size() : 0;
    if (width != 3 && width != 4 && width != 7)
      fail("{}: line {}, the first of scan {}, is not x y z, perhaps with an intensity and red green blue; correct it.",
           name(), lines_.line(), layout_.scans.size());
    return width;
  }

  const InputFile& file_;
  LineReader lines_;
  PtxLayout layout_;
};

}  // namespace

PtxLayout find_ptx_layout(const InputFile& file) { return PtxFinder(file).run(); }

bool starts_as_ptx(std::string_view head) {
  for (const std::size_t expected : kHeaderNumbers) {
    const std::size_t end = head.find('\n');
    if (end == head.npos) return false;
    const auto numbers = ptx_numbers(head.substr(0, end), expected);
    if (!numbers || numbers->size() != expected) return false;
    head.remove_prefix(end + 1);
  }
  return true;
}

PtxCursor::PtxCursor(const InputFile& file, const PtxLayout& layout)
    : layout_(&layout), lines_(file), next_(layout.points) {}

std::string_view PtxCursor::at(std::uint64_t point) {
  const std::uint64_t number = point / PtxLayout::kPointsPerPlace;
  if (point < next_ || number > next_ / PtxLayout::kPointsPerPlace) {
    const PtxPlace& place = layout_->places[static_cast<std::size_t>(number)];
    lines_.jump(place.offset, place.line);
    scan_ = place.scan;
    cell_ = place.cell;
    next_ = number * PtxLayout::kPointsPerPlace;
  }
  for (; next_ < point; ++next_) advance();
  ++next_;
  return advance();
}

std::string_view PtxCursor::advance() {
  for (;;) {
    while (cell_ == layout_->scans[static_cast<std::size_t>(scan_)].cells()) {
      if (++scan_ == layout_->scans.size())
        fail("{}: has fewer points than when it was opened; run again while no program writes to it.",
             lines_.file().path().string());
      for (std::size_t i = 0; i < kHeaderLines; ++i) next_line();
      cell_ = 0;
    }
    const std::string_view line = next_line();
    ++cell_;
    if (!is_empty_cell(line)) return line;
  }
}

std::string_view PtxCursor::next_line() {
  while (const auto line = lines_.next())
    if (!is_blank(*line)) return *line;
  fail("{}: has become shorter since it was opened; run again while no program writes to it.",
       lines_.file().path().string());
}

}  // namespace pointsweep
