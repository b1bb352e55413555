// SPDX-License-Identifier: MIT
#include "pointsweep/formats/qsplat/qsplat_walk.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr int kGrid = 13;
constexpr unsigned kPlaces = 52;

/// Coordinate of place i on a face of the cube: tan((2 i + 1 - 52) / 52 · π/4), rounded as in QSplat. Places are denser
/// in the middle of a face.
constexpr std::array<float, kPlaces> kUnwarped = {
    -0.97023958f,  -0.913248599f, -0.859318495f,  -0.808118105f,  -0.759358764f,  -0.712786794f, -0.668178618f,
    -0.625336111f, -0.584082663f, -0.544260144f,  -0.505726278f,  -0.468352348f,  -0.432021499f, -0.396627009f,
    -0.362070829f, -0.328262657f, -0.295118511f,  -0.262560338f,  -0.23051466f,   -0.198912367f, -0.16768764f,
    -0.136777759f, -0.106122367f, -0.0756629109f, -0.0453424528f, -0.0151049234f, 0.0151050175f, 0.0453424528f,
    0.0756629556f, 0.106122419f,  0.136777848f,   0.167687744f,   0.198912367f,   0.230514705f,  0.262560397f,
    0.29511863f,   0.328262746f,  0.362070888f,   0.396627069f,   0.432021618f,   0.468352467f,  0.505726278f,
    0.544260204f,  0.584082782f,  0.62533623f,    0.668178797f,   0.712786794f,   0.759358823f,  0.808118284f,
    0.859318614f,  0.913248599f,  0.970239699f};

/// Returns the spheres of all codes, in the order of the codes, inside a parent with centre 0 and radius 1.
std::vector<QsplatSphere> relative_spheres() {
  std::vector<QsplatSphere> spheres;
  const float step = 1.0f / static_cast<float>(kGrid), sqrt3 = std::sqrt(3.0f);
  for (int size = 1; size <= kGrid; ++size) {
    const float radius = static_cast<float>(size) * step;
    const float reach = 1.0f + sqrt3 * radius;
    const auto center = [&](int place) { return static_cast<float>(size + 2 * place) * step - 1.0f; };
    for (int x = 0; x <= kGrid - size; ++x) {
      for (int y = 0; y <= kGrid - size; ++y) {
        for (int z = 0; z <= kGrid - size; ++z) {
          const QsplatSphere sphere{center(x), center(y), center(z), radius};
          if (sphere.x * sphere.x + sphere.y * sphere.y + sphere.z * sphere.z > reach * reach) continue;
          spheres.push_back(sphere);
        }
      }
    }
  }
  return spheres;
}

constexpr std::size_t kReadAheadBytes = 64 * 1024;
constexpr std::size_t kDeepest = 256;
constexpr std::uint64_t kCommentHeader = 20;

unsigned byte_at(const std::byte* bytes, std::size_t i) { return static_cast<unsigned>(bytes[i]); }

/// All numbers of the format are big-endian.
std::uint32_t number_at(const std::byte* b) {
  return byte_at(b, 0) << 24 | byte_at(b, 1) << 16 | byte_at(b, 2) << 8 | byte_at(b, 3);
}
float float_at(const std::byte* b) { return std::bit_cast<float>(number_at(b)); }

std::size_t node_bytes(const QsplatFragment& fragment) { return fragment.has_color ? 6 : 4; }

[[noreturn]] void fail_in(const InputFile& file, std::uint64_t offset, std::string_view what) {
  fail("{}: byte {}: {}; the QSplat file is damaged or was not copied completely, so get it again.",
       file.path().string(), offset, what);
}

void check_signature(const InputFile& file, std::uint64_t begin, const std::byte* header) {
  char mark[9] = {};
  std::memcpy(mark, header, 8);
  const std::string_view text(mark, 8);
  if (!text.starts_with("QSplat")) fail_in(file, begin, "a QSplat header has to begin with 'QSplat'");
  if (text != "QSplat11") {
    fail("{}: byte {}: is of another version of QSplat than 11, the one that is read; make it again from its mesh.",
         file.path().string(), begin);
  }
}

}  // namespace

std::optional<QsplatSphere> qsplat_sphere(unsigned code, const QsplatSphere& parent) {
  static const std::vector<QsplatSphere> spheres = relative_spheres();
  if (code >= spheres.size()) return std::nullopt;
  const QsplatSphere& s = spheres[code];
  return QsplatSphere{parent.x + parent.radius * s.x, parent.y + parent.radius * s.y, parent.z + parent.radius * s.z,
                      parent.radius * s.radius};
}

std::array<float, 3> qsplat_normal(unsigned code) {
  const unsigned face = code / (kPlaces * kPlaces);
  if (face >= 6) return {0, 0, 1};
  const float u = kUnwarped[code / kPlaces % kPlaces], v = kUnwarped[code % kPlaces];
  const float rest = 1.0f - u * u - v * v;
  if (!(rest >= 0)) return {0, 0, 0};
  const float out = face % 2 == 0 ? std::sqrt(rest) : -std::sqrt(rest);
  const unsigned axis = face / 2;  // u and v are the components on the next two axes, cyclically
  std::array<float, 3> normal{};
  normal[axis] = out;
  normal[(axis + 1) % 3] = u;
  normal[(axis + 2) % 3] = v;
  return normal;
}

std::array<std::uint8_t, 3> qsplat_color(unsigned code) {
  const unsigned r = code >> 11 & 31, g = code >> 5 & 63, b = code & 31;
  const auto byte = [](unsigned value) { return static_cast<std::uint8_t>(value); };
  return {byte(r << 3 | r >> 2), byte(g << 2 | g >> 4), byte(b << 3 | b >> 2)};
}

QsplatFragment read_qsplat_fragment(const InputFile& file, std::uint64_t begin) {
  std::array<std::byte, kQsplatHeader> header{};
  const std::size_t got = file.read_some(begin, header);
  if (got < kCommentHeader) fail_in(file, begin, "the file ends inside a header");
  check_signature(file, begin, header.data());
  const std::uint64_t length = number_at(&header[8]);
  const std::uint32_t options = number_at(&header[16]);
  QsplatFragment fragment;
  fragment.begin = begin;
  fragment.end = begin + length;
  fragment.is_comment = (options & 2) != 0;
  fragment.has_color = (options & 1) != 0;
  if (fragment.end > file.size()) {
    fail_in(file, begin,
            fmt::format("a part of {} bytes should begin here, but only {} follow", length, file.size() - begin));
  }
  if (length < (fragment.is_comment ? kCommentHeader : kQsplatHeader)) {
    fail_in(file, begin, fmt::format("a part says it has {} bytes, fewer than its header", length));
  }
  if (fragment.is_comment) return fragment;
  fragment.leaves = number_at(&header[12]);
  fragment.root = {float_at(&header[20]), float_at(&header[24]), float_at(&header[28]), float_at(&header[32])};
  fragment.root_children = number_at(&header[36]);
  return fragment;
}

bool QsplatWalk::next(QsplatLeaf& leaf) {
  while (true) {
    if (place_.levels.empty()) {
      check_end_of_fragment();
      bool is_leaf = false;
      if (!enter_next_fragment(leaf, is_leaf)) return false;
      if (is_leaf) return true;
      continue;
    }
    Level& level = place_.levels.back();
    if (level.left == 0) {
      place_.levels.pop_back();
      continue;
    }
    const std::size_t size = node_bytes(place_.fragment);
    const std::byte* node = bytes_at(place_.levels.size() - 1, level.next, size);
    const unsigned first = byte_at(node, 0) << 8 | byte_at(node, 1);
    const auto sphere = qsplat_sphere(first >> 3, level.parent);
    if (!sphere) complain(level.next, "the code of a sphere means nothing");
    const std::uint64_t children = (first & 3) == 0 ? 0 : (first & 3) + 1;
    level.next += size;
    --level.left;
    if (children == 0) {
      ++place_.given;
      const unsigned normal = (byte_at(node, 2) << 8 | byte_at(node, 3)) >> 2;
      const unsigned color = size == 6 ? byte_at(node, 4) << 8 | byte_at(node, 5) : 0;
      leaf = {*sphere, normal, color, size == 6, true};
      return true;
    }
    if (level.below == 0) complain(level.next - size, "a node has children, but nothing says where");
    const bool has_pointer = (first & 4) != 0;
    const std::uint64_t group = level.below;
    level.below += children * size + (has_pointer ? 4 : 0);
    enter_group(group, children, has_pointer, *sphere);
  }
}

/// Enters the next part that is not a comment. If its tree is only a root, sets `leaf` to the root and `is_leaf` to
/// true. Returns false at the end of the file.
bool QsplatWalk::enter_next_fragment(QsplatLeaf& leaf, bool& is_leaf) {
  do {
    if (place_.fragment.end >= file_.size()) return false;
    place_ = {read_qsplat_fragment(file_, place_.fragment.end), 0, 0, {}};
  } while (place_.fragment.is_comment);
  const QsplatFragment& f = place_.fragment;
  if (f.root_children == 0 && f.leaves == 1) {
    place_.given = 1;
    leaf = {f.root, 0, 0, false, false};
    is_leaf = true;
    return true;
  }
  if (f.root_children > f.leaves) complain(f.begin, "the root has more children than the tree has leaves");
  enter_group(f.begin + kQsplatHeader, f.root_children, f.root_children < f.leaves, f.root);
  return true;
}

void QsplatWalk::enter_group(std::uint64_t begin, std::uint64_t siblings, bool has_pointer,
                             const QsplatSphere& parent) {
  const QsplatFragment& fragment = place_.fragment;
  const std::uint64_t bytes = siblings * node_bytes(fragment) + (has_pointer ? 4 : 0);
  if (begin > fragment.end || bytes > fragment.end - begin) complain(begin, "nodes lie after the end of their part");
  place_.walked += bytes;
  // In a tree every group is entered once. This check ends the walk of a file with shared groups.
  if (place_.walked > fragment.end - fragment.begin) complain(begin, "nodes belong to more than one parent");
  if (place_.levels.size() == kDeepest) complain(begin, fmt::format("the tree is deeper than {} levels", kDeepest));
  Level level{begin, 0, siblings, parent};
  if (has_pointer) {
    level.below = begin + number_at(bytes_at(place_.levels.size(), begin, 4));
    level.next += 4;
  }
  place_.levels.push_back(level);
}

void QsplatWalk::check_end_of_fragment() const {
  const QsplatFragment& fragment = place_.fragment;
  if (place_.given == fragment.leaves) return;
  complain(fragment.begin,
           fmt::format("the header says {} leaves, but the tree has {}", fragment.leaves, place_.given));
}

const std::byte* QsplatWalk::bytes_at(std::size_t level, std::uint64_t offset, std::size_t size) {
  if (blocks_.size() <= level) blocks_.resize(level + 1);
  Block& block = blocks_[level];
  if (offset < block.begin || offset + size > block.begin + block.bytes.size()) {
    block.begin = offset;
    block.bytes.resize(kReadAheadBytes);
    block.bytes.resize(file_.read_some(offset, block.bytes));
    if (block.bytes.size() < size) complain(offset, "the file ends inside a node");
  }
  return block.bytes.data() + (offset - block.begin);
}

void QsplatWalk::complain(std::uint64_t offset, std::string_view what) const { fail_in(file_, offset, what); }

}  // namespace pointsweep
