// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>

#include "pointsweep/fail.h"
#include "pointsweep/formats/e57/e57_format.h"

#if POINTSWEEP_CODECS
#include <pointsweep_codecs.h>
#endif

namespace pointsweep {

double E57Attribute::value(std::uint64_t stored) const {
  if (!is_stored_as_integer()) return std::bit_cast<double>(stored);
  return static_cast<double>(static_cast<std::int64_t>(stored)) * scale + offset;
}

#if POINTSWEEP_CODECS

namespace {

constexpr std::uint64_t kMostScans = 1 << 20;

std::ptrdiff_t read_input(void* file, std::uint64_t offset, std::uint8_t* into, std::size_t bytes) {
  try {
    const std::span<std::byte> to(reinterpret_cast<std::byte*>(into), bytes);
    return static_cast<std::ptrdiff_t>(static_cast<const InputFile*>(file)->read_some(offset, to));
  } catch (const Error&) {
    return -1;
  }
}

void* context_of(const InputFile& file) { return const_cast<InputFile*>(&file); }

[[noreturn]] void fail_damaged(const InputFile& file, const psc_error& error) {
  fail("{}: cannot be read: {}; copy or export it again.", file.path().string(), error.text);
}

E57Attribute attribute_of(const psc_e57* codec, std::size_t scan, std::size_t number) {
  psc_e57_attribute info;
  psc_e57_attribute_info(codec, scan, number, &info);
  return {.name = info.name,
          .kind = static_cast<E57Attribute::Kind>(info.kind),
          .least = info.least,
          .most = info.most,
          .scale = info.scale,
          .offset = info.offset};
}

std::string description_of(const psc_e57* codec, std::size_t scan) {
  std::string text(psc_e57_description(codec, scan, nullptr, 0), '\0');
  psc_e57_description(codec, scan, reinterpret_cast<std::uint8_t*>(text.data()), text.size());
  return text;
}

E57Scan scan_of(const psc_e57* codec, std::size_t number) {
  psc_e57_scan info;
  psc_e57_scan_info(codec, number, &info);
  E57Scan scan{.points = info.points, .attributes = {}, .has_pose = info.has_pose != 0};
  std::ranges::copy(info.rotation, scan.rotation.begin());
  std::ranges::copy(info.translation, scan.translation.begin());
  scan.description = description_of(codec, number);
  for (std::size_t a = 0; a < info.attributes; ++a) scan.attributes.push_back(attribute_of(codec, number, a));
  return scan;
}

/// Returns a lower bound of the bits that the values of one point take.
double bits_of(const E57Scan& scan) {
  double bits = 0;
  for (const E57Attribute& a : scan.attributes) {
    if (a.kind == E57Attribute::Kind::single) bits += 32;
    if (a.kind == E57Attribute::Kind::real) bits += 64;
    if (a.is_stored_as_integer())
      bits +=
          static_cast<double>(std::bit_width(static_cast<std::uint64_t>(a.most) - static_cast<std::uint64_t>(a.least)));
  }
  return bits;
}

}  // namespace

E57File::E57File(const std::filesystem::path& path) : file_(std::make_unique<const InputFile>(path)) {
  psc_error error;
  psc_e57* codec = nullptr;
  if (psc_e57_open(read_input, context_of(*file_), file_->size(), &codec, &error) != 0) fail_damaged(*file_, error);
  codec_ = {codec, psc_e57_free};
  images_ = psc_e57_images(codec);
  coordinate_system_.resize(psc_e57_coordinate_system(codec, nullptr, 0));
  psc_e57_coordinate_system(codec, reinterpret_cast<std::uint8_t*>(coordinate_system_.data()),
                            coordinate_system_.size());
  const std::size_t count = psc_e57_scans(codec);
  if (count > kMostScans) fail("{}: has {} scans; at most {} can be read.", path.string(), count, kMostScans);
  for (std::size_t s = 0; s < count; ++s) {
    scans_.push_back(scan_of(codec, s));
    const E57Scan& scan = scans_.back();
    if (static_cast<double>(scan.points) * bits_of(scan) > 8 * static_cast<double>(file_->size()))
      fail("{}: is truncated; scan {} should have {} points, more than fit into the file; copy or export it again.",
           path.string(), s + 1, scan.points);
  }
}

E57File::Points::Points(const E57File& file, std::size_t scan) : file_(file), scan_(scan) {
  psc_error error;
  if (psc_e57_reader_open(file.codec_.get(), scan, read_input, context_of(file.file()), file.file().size(), &reader_,
                          &error) != 0)
    fail_damaged(file.file(), error);
}

E57File::Points::~Points() { psc_e57_reader_free(reader_); }

void E57File::Points::read(std::span<std::uint64_t> values) {
  psc_error error;
  if (psc_e57_read(reader_, values.data(), values.size(), &error) != 0)
    fail("{}: cannot be read: {} (scan {} of {}, after its point {}); copy or export it again.",
         file_.file().path().string(), error.text, scan_ + 1, file_.scans().size(), next_);
  next_ += values.size() / file_.scans()[scan_].attributes.size();
}

#else

E57File::E57File(const std::filesystem::path& path) {
  fail(
      "{}: is an E57 file, and this pointsweep was built without its codecs (POINTSWEEP_CODECS); convert it to LAS "
      "first, e.g. with 'pdal translate IN OUT.las', or install cargo and build again.",
      path.string());
}
E57File::Points::Points(const E57File& file, std::size_t scan) : file_(file), scan_(scan) {}
E57File::Points::~Points() = default;
void E57File::Points::read(std::span<std::uint64_t>) {}

#endif

}  // namespace pointsweep
