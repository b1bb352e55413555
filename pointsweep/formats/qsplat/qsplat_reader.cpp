// SPDX-License-Identifier: MIT
/// A reader of QSplat models (`.qs`, version 11): the leaves of their trees become points.
#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "pointsweep/formats/format.h"
#include "pointsweep/formats/qsplat/qsplat_walk.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kBetweenPlaces = 32768;

Box box_of(const QsplatSphere& s) {
  Box box;
  const double r = s.radius;
  box.include(Vec3{s.x - r, s.y - r, s.z - r});
  box.include(Vec3{s.x + r, s.y + r, s.z + r});
  return box;
}

class QsplatReader final : public Reader {
 public:
  explicit QsplatReader(const std::filesystem::path& path) : file_(path) {
    info_.path = path;
    info_.format = "QSplat 11";
    info_.bytes = file_.size();
    const bool has_color = look_at_fragments();
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "radius"}) info_.schema.append(name, Type::f32);
    if (has_color) {
      for (const char* name : {"red", "green", "blue"}) info_.schema.append(name, Type::u8);
    }
    count_leaves();
  }

  /// Returns the leaves between two stored positions. The chunk has no range of bytes, since the nodes above the leaves
  /// are spread over the whole file.
  Chunk chunk_of(std::uint64_t row) const override {
    const std::uint64_t first = row / kBetweenPlaces * kBetweenPlaces;
    return {.first_row = first, .rows = std::min(kBetweenPlaces, info_.count - first), .bounds = {}};
  }
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields&) const override { return std::make_unique<Decoder>(*this); }

 private:
  /// Returns whether any part of the file has colours. Sets info_.bounds to the box of the root spheres of all trees,
  /// if there is a finite one.
  bool look_at_fragments() {
    bool has_color = false;
    Box bounds;
    for (std::uint64_t begin = 0; begin < file_.size();) {
      const QsplatFragment fragment = read_qsplat_fragment(file_, begin);
      begin = fragment.end;
      if (fragment.is_comment) continue;
      has_color = has_color || fragment.has_color;
      const Box box = box_of(fragment.root);
      if (is_finite(box.lo) && is_finite(box.hi)) bounds.include(box);
    }
    if (is_finite(bounds.lo) && is_finite(bounds.hi)) info_.bounds = bounds;
    return has_color;
  }

  void count_leaves() {
    QsplatWalk walk(file_);
    QsplatLeaf leaf;
    for (places_.push_back(walk.place()); walk.next(leaf);) {
      if (++info_.count % kBetweenPlaces == 0) places_.push_back(walk.place());
    }
  }

  void encode(const QsplatLeaf& leaf, std::byte* record) const {
    const auto normal = leaf.has_normal ? qsplat_normal(leaf.normal) : std::array<float, 3>{};
    const QsplatSphere& s = leaf.sphere;
    const std::array<float, 7> values = {s.x, s.y, s.z, normal[0], normal[1], normal[2], s.radius};
    std::memcpy(record, values.data(), sizeof values);
    if (info_.schema.stride == sizeof values) return;
    const auto color = leaf.has_color ? qsplat_color(leaf.color) : std::array<std::uint8_t, 3>{};
    std::memcpy(record + sizeof values, color.data(), color.size());
  }

  class Decoder final : public RowDecoder {
   public:
    explicit Decoder(const QsplatReader& reader) : reader_(reader), walk_(reader.file_) {}

    std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
      const std::size_t rows = reader_.rows_for(row, records), stride = reader_.info().schema.stride;
      if (rows == 0) return 0;
      go_to(row);
      QsplatLeaf leaf;
      for (std::size_t i = 0; i < rows; ++i) {
        if (!next(leaf)) return i;
        reader_.encode(leaf, records.data() + i * stride);
      }
      return rows;
    }

   private:
    void go_to(std::uint64_t row) {
      const std::uint64_t place = row / kBetweenPlaces;
      if (row < row_ || row_ / kBetweenPlaces < place) {
        walk_.go_to(reader_.places_[place]);
        row_ = place * kBetweenPlaces;
      }
      for (QsplatLeaf leaf; row_ < row && next(leaf);) continue;
    }

    bool next(QsplatLeaf& leaf) {
      const bool there_is = walk_.next(leaf);
      row_ += there_is ? 1 : 0;
      return there_is;
    }

    const QsplatReader& reader_;
    QsplatWalk walk_;
    std::uint64_t row_ = 0;  ///< row of the next leaf of the walk
  };

  InputFile file_;
  std::vector<QsplatWalk::Place> places_;  ///< positions before rows 0, kBetweenPlaces, ...
};

constexpr std::string_view kQsplatExtensions[] = {".qs"};

bool is_qsplat(std::string_view head) { return head.starts_with("QSplat"); }

/// Opens a file with fields x y z nx ny nz radius (f32), and red green blue (u8) if a part of the file has colours.
/// Rows are in depth-first order, one part of the file after another. Opening walks through all trees once to count the
/// leaves (about 20 ns per leaf), and stores a position for every 32,768 leaves; a jump to a row walks from the last
/// stored position before the row. Throws Error for a damaged or truncated file.
std::unique_ptr<Reader> open_qsplat(const std::filesystem::path& path) { return std::make_unique<QsplatReader>(path); }

}  // namespace

const Format kQsplatFormat = {.name = "QSplat",
                              .title = "QSplat",
                              .details = "#qsplat",
                              .reads = "version 11, leaves as points",
                              .writes = "no",
                              .extensions = kQsplatExtensions,
                              .is = is_qsplat,
                              .open = open_qsplat,
                              .states_bounds = true};

}  // namespace pointsweep
