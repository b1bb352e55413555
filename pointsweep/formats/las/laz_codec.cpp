// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/laz_codec.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/threads.h"

#if POINTSWEEP_CODECS
#include <pointsweep_codecs.h>
#endif

namespace pointsweep {

#if POINTSWEEP_CODECS

namespace {

constexpr std::uint64_t kMostTableEntry = 16;    ///< most bytes of one entry of the compressed chunk table
constexpr std::uint64_t kTableOverhead = 64;     ///< bytes of the table's header, and read-ahead of the entropy coder
constexpr std::size_t kDecodedAtOnce = 1 << 12;  ///< records between two checks for cancellation

std::uint64_t u64_at(const InputFile& file, std::uint64_t offset) {
  std::array<std::byte, 8> bytes;
  file.read_at(offset, bytes);
  std::uint64_t number;
  std::memcpy(&number, bytes.data(), sizeof number);
  return number;
}

std::shared_ptr<const psc_laz> owned(psc_laz* codec) { return {codec, psc_laz_free}; }

const std::uint8_t* plain(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

/// Copies bytes that the codec has allocated, and frees them.
std::vector<std::byte> taken(std::uint8_t* bytes, std::size_t size) {
  const auto* first = reinterpret_cast<const std::byte*>(bytes);
  std::vector<std::byte> copy(first, first + size);
  psc_free_bytes(bytes, size);
  return copy;
}

}  // namespace

void LazLayout::fail_with(const char* reason) const {
  fail("{}: cannot be decompressed: {}; copy or export it again.", path_, reason);
}

LazLayout LazLayout::parse(std::span<const std::byte> vlr, const std::string& path) {
  psc_laz* codec = nullptr;
  psc_error error;
  if (psc_laz_parse(plain(vlr), vlr.size(), &codec, &error) != 0)
    fail("{}: cannot be decompressed: {} (LASzip VLR); copy or export it again.", path, error.text);
  return {owned(codec), path};
}

LazLayout LazLayout::for_format(std::uint8_t point_format, std::uint16_t extra_bytes, std::uint32_t chunk_points,
                                const std::string& path) {
  psc_laz* codec = nullptr;
  psc_error error;
  if (psc_laz_for_format(point_format, extra_bytes, chunk_points, &codec, &error) != 0)
    fail("{}: cannot be compressed: {}.", path, error.text);
  return {owned(codec), path};
}

std::uint32_t LazLayout::chunk_points() const { return psc_laz_chunk_points(codec()); }
std::uint32_t LazLayout::record_bytes() const { return psc_laz_record_bytes(codec()); }

std::vector<std::byte> LazLayout::vlr() const {
  std::vector<std::byte> bytes(psc_laz_vlr(codec(), nullptr, 0));
  psc_laz_vlr(codec(), reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size());
  return bytes;
}

std::vector<LazLayout::ChunkSize> LazLayout::read_chunk_table(std::span<const std::byte> table,
                                                              std::size_t count) const {
  std::vector<std::uint64_t> points(count), sizes(count);
  psc_error error;
  if (psc_laz_read_chunk_table(codec(), plain(table), table.size(), count, points.data(), sizes.data(), &error) != 0)
    fail_with(error.text);
  std::vector<ChunkSize> chunks(count);
  for (std::size_t i = 0; i < count; ++i) chunks[i] = {points[i], sizes[i]};
  return chunks;
}

std::vector<std::byte> LazLayout::write_chunk_table(std::span<const ChunkSize> chunks) const {
  std::vector<std::uint64_t> points, sizes;
  for (const ChunkSize& chunk : chunks) {
    points.push_back(chunk.points);
    sizes.push_back(chunk.bytes);
  }
  std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
  psc_error error;
  if (psc_laz_write_chunk_table(codec(), points.data(), sizes.data(), chunks.size(), &bytes, &size, &error) != 0)
    fail("{}: cannot be compressed: {}.", path_, error.text);
  return taken(bytes, size);
}

std::vector<std::byte> LazLayout::compress(std::span<const std::byte> records) const {
  std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
  psc_error error;
  if (psc_laz_encode(codec(), plain(records), records.size(), &bytes, &size, &error) != 0)
    fail("{}: cannot be compressed: {}.", path_, error.text);
  return taken(bytes, size);
}

/// A decoder in the middle of one chunk.
class LazPoints::Decoder {
 public:
  Decoder(const LazPoints& points, std::size_t chunk) : points_(points), chunk_(chunk) {
    const auto read = [](void* context, std::uint64_t offset, std::uint8_t* into, std::size_t bytes) -> std::ptrdiff_t {
      try {
        const std::span<std::byte> to(reinterpret_cast<std::byte*>(into), bytes);
        return static_cast<std::ptrdiff_t>(static_cast<Decoder*>(context)->points_.file_->read_some(offset, to));
      } catch (...) {
        static_cast<Decoder*>(context)->failure_ = std::current_exception();
        return -1;
      }
    };
    points.file_->will_read(points.first_byte_[chunk], points.first_byte_[chunk + 1]);
    psc_error error;
    if (psc_laz_decoder_open(points.layout_.codec(), read, this, points.first_byte_[chunk],
                             points.first_byte_[chunk + 1], &codec_, &error) != 0)
      fail_at(error);
  }
  ~Decoder() { psc_laz_decoder_free(codec_); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  std::size_t chunk() const { return chunk_; }
  std::uint64_t next() const { return next_; }  ///< row in the chunk that is decoded next

  void skip_to(std::uint64_t row) {
    if (row == next_) return;
    std::vector<std::byte> skipped(std::min<std::uint64_t>(kDecodedAtOnce, row - next_) * points_.record_bytes_);
    while (next_ < row) {
      const std::uint64_t n = std::min<std::uint64_t>(kDecodedAtOnce, row - next_);
      decode(skipped.data(), n);
    }
  }

  void decode(std::byte* records, std::uint64_t rows) {
    while (rows > 0) {
      stop_if_cancelled();
      const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(kDecodedAtOnce, rows));
      const std::size_t bytes = n * points_.record_bytes_;
      psc_error error;
      if (psc_laz_decode(codec_, reinterpret_cast<std::uint8_t*>(records), bytes, &error) != 0) fail_at(error);
      records += bytes;
      next_ += n;
      rows -= n;
    }
  }

 private:
  [[noreturn]] void fail_at(const psc_error& error) {
    if (failure_) std::rethrow_exception(failure_);
    fail("{}: cannot be decompressed: {} (chunk {} of {}, byte {}); copy or export it again.",
         points_.file_->path().string(), error.text, chunk_ + 1, points_.chunks(), points_.first_byte_[chunk_]);
  }

  const LazPoints& points_;
  std::size_t chunk_;
  std::uint64_t next_ = 0;
  std::exception_ptr failure_;
  psc_laz_decoder* codec_ = nullptr;
};

LazPoints::LazPoints(std::shared_ptr<const InputFile> file, std::span<const std::byte> vlr, std::uint64_t begin,
                     std::uint64_t count, std::uint32_t record_bytes)
    : file_(std::move(file)), layout_(LazLayout::parse(vlr, file_->path().string())), record_bytes_(record_bytes) {
  if (layout_.record_bytes() != record_bytes)
    fail("{}: its compressed records have {} bytes instead of {}; copy or export it again.", file_->path().string(),
         layout_.record_bytes(), record_bytes);
  if (count == 0) {
    first_row_ = {0};
  } else if (layout_.chunk_points() == LazLayout::kNoChunks) {
    first_row_ = {0, count};
    first_byte_ = {begin, file_->size()};
  } else {
    read_chunk_table(begin, count);
  }
}

LazPoints::Cursor::Cursor(const LazPoints& points) : points_(points) {}
LazPoints::Cursor::~Cursor() = default;

/// Reads the chunk table. A writer that could not seek back to the beginning of its data has stored the offset of the
/// table in the last bytes of the file.
void LazPoints::read_chunk_table(std::uint64_t begin, std::uint64_t count) {
  const std::uint64_t size = file_->size();
  const std::uint64_t data = begin + kLazOffsetBytes;
  if (size < data + kLazOffsetBytes) layout_.fail_with("it ends in front of the first chunk");
  std::uint64_t table = u64_at(*file_, begin);
  if (table <= begin || table > size) table = u64_at(*file_, size - kLazOffsetBytes);
  if (table < data || table + kLazOffsetBytes > size) layout_.fail_with("its chunk table is not in the file");
  const std::uint64_t chunks = u64_at(*file_, table) >> 32;
  // Every chunk begins with one uncompressed record, which limits the number of chunks.
  const std::uint32_t each = layout_.chunk_points();
  if (chunks == 0 || chunks > (table - data) / record_bytes_ || chunks > count ||
      (each != LazLayout::kVariable && chunks != (count - 1) / each + 1))
    layout_.fail_with("its chunk table has a wrong number of chunks");
  std::vector<std::byte> bytes(
      static_cast<std::size_t>(std::min(size - table, kTableOverhead + kMostTableEntry * chunks)));
  file_->read_at(table, bytes);
  std::uint64_t row = 0, byte = data;
  for (const auto& chunk : layout_.read_chunk_table(bytes, static_cast<std::size_t>(chunks))) {
    first_row_.push_back(row);
    first_byte_.push_back(byte);
    row += each == LazLayout::kVariable ? chunk.points : std::min<std::uint64_t>(each, count - row);
    byte += chunk.bytes;
    if (byte > table) layout_.fail_with("its chunks reach into the chunk table");
  }
  if (row != count) layout_.fail_with("its chunks hold another number of points than the header says");
  first_row_.push_back(row);
  first_byte_.push_back(byte);
}

std::size_t LazPoints::chunk_of(std::uint64_t row) const {
  return static_cast<std::size_t>(std::ranges::upper_bound(first_row_, row) - first_row_.begin()) - 1;
}

std::vector<LazPoints::Piece> LazPoints::pieces(std::uint64_t row, std::span<std::byte> records) const {
  std::vector<Piece> pieces;
  std::uint64_t left = records.size() / record_bytes_;
  std::size_t chunk = chunk_of(row);
  for (std::byte* to = records.data(); left > 0; ++chunk) {
    const std::uint64_t rows = std::min(left, first_row_[chunk + 1] - row);
    if (rows > 0) pieces.push_back({chunk, row - first_row_[chunk], rows, to});
    to += rows * record_bytes_;
    row += rows;
    left -= rows;
  }
  return pieces;
}

/// Reads the rows in pieces, one for each chunk. Only the first piece can begin in the middle of its chunk, and only
/// the last piece can end in the middle.
void LazPoints::Cursor::read(std::uint64_t row, std::span<std::byte> records) {
  const std::vector<Piece> all = points_.pieces(row, records);
  if (all.empty()) return;
  std::vector<std::unique_ptr<Decoder>> decoders(all.size());
  if (open_ && open_->chunk() == all[0].chunk && open_->next() <= all[0].first) decoders[0] = std::move(open_);
  open_.reset();
  parallel_for(all.size(), [&](std::size_t i, unsigned) {
    const Piece& piece = all[i];
    if (!decoders[i]) decoders[i] = std::make_unique<Decoder>(points_, piece.chunk);
    decoders[i]->skip_to(piece.first);
    decoders[i]->decode(piece.records, piece.rows);
    if (decoders[i]->next() == points_.first_row(piece.chunk + 1) - points_.first_row(piece.chunk)) decoders[i].reset();
  });
  open_ = std::move(decoders.back());
}

#else

namespace {

[[noreturn]] void fail_without_codecs(const std::string& path) {
  fail(
      "{}: is compressed (LAZ), and this pointsweep was built without its codecs (POINTSWEEP_CODECS); decompress it "
      "first, e.g. with 'laszip -i FILE', or install cargo and build again.",
      path);
}

}  // namespace

LazLayout LazLayout::parse(std::span<const std::byte>, const std::string& path) { fail_without_codecs(path); }
LazLayout LazLayout::for_format(std::uint8_t, std::uint16_t, std::uint32_t, const std::string& path) {
  fail("{}: this pointsweep was built without codecs (POINTSWEEP_CODECS) and cannot write LAZ; write .las.", path);
}
void LazLayout::fail_with(const char*) const { fail_without_codecs(path_); }
std::uint32_t LazLayout::chunk_points() const { fail_without_codecs(path_); }
std::uint32_t LazLayout::record_bytes() const { fail_without_codecs(path_); }
std::vector<std::byte> LazLayout::vlr() const { fail_without_codecs(path_); }
std::vector<LazLayout::ChunkSize> LazLayout::read_chunk_table(std::span<const std::byte>, std::size_t) const {
  fail_without_codecs(path_);
}
std::vector<std::byte> LazLayout::write_chunk_table(std::span<const ChunkSize>) const { fail_without_codecs(path_); }
std::vector<std::byte> LazLayout::compress(std::span<const std::byte>) const { fail_without_codecs(path_); }

class LazPoints::Decoder {};

LazPoints::LazPoints(std::shared_ptr<const InputFile> file, std::span<const std::byte> vlr, std::uint64_t,
                     std::uint64_t, std::uint32_t record_bytes)
    : file_(std::move(file)), layout_(LazLayout::parse(vlr, file_->path().string())), record_bytes_(record_bytes) {}
std::size_t LazPoints::chunk_of(std::uint64_t) const { return 0; }
LazPoints::Cursor::Cursor(const LazPoints& points) : points_(points) {}
LazPoints::Cursor::~Cursor() = default;
void LazPoints::Cursor::read(std::uint64_t, std::span<std::byte>) {}

#endif

}  // namespace pointsweep
