// SPDX-License-Identifier: MIT
#include "pointsweep/levels/curve_records.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMostPieceBytes = 16 << 20, kMostStretchBytes = 16 << 20, kFewBytes = 1 << 20,
                        kLeastBytes = 64 << 10;
/// Number of stretches, unless a stretch would be too small, or too large for the memory. Each piece stores one number
/// per stretch.
constexpr std::uint64_t kManyStretches = 4096;
/// Number of records to which the sample is reduced whenever it has twice as many.
constexpr std::uint64_t kSampleRecords = 64 << 10;
constexpr std::size_t kRowsAtOnce = 8192;

}  // namespace

// Half of the memory is for pieces in memory, or for a piece and its sorted copy on each thread. The other half is for
// stretches: on each thread the parts of a stretch, their order and two sorted copies.
CurveRecords::CurveRecords(std::size_t record_bytes, std::uint64_t memory_bytes, MakeScratch files)
    : record_bytes_(record_bytes), memory_(memory_bytes), files_(std::move(files)) {
  const std::uint64_t share = memory_bytes / thread_count();
  const auto rows = [&](std::uint64_t bytes, std::uint64_t most) {
    return static_cast<std::size_t>(std::max<std::uint64_t>(1, std::clamp(bytes, kLeastBytes, most) / record_bytes_));
  };
  piece_rows_ = rows(share / 8, kMostPieceBytes);
  most_stretch_rows_ = rows(share / 10, kMostStretchBytes);
  bounds_.lo.fill(std::numeric_limits<std::int32_t>::max());
  bounds_.hi.fill(std::numeric_limits<std::int32_t>::min());
}

void CurveRecords::add(std::span<const std::byte> records) {
  while (!records.empty()) {
    if (pieces_.empty() || pieces_.back().rows == piece_rows_) begin_piece();
    Piece& piece = pieces_.back();
    const std::size_t n = std::min(records.size() / record_bytes_, piece_rows_ - piece.rows);
    const std::span<const std::byte> some = records.first(n * record_bytes_);
    piece.held.insert(piece.held.end(), some.begin(), some.end());
    piece.rows += n;
    for (std::size_t i = 0; i < n; ++i) {
      bounds_.include(point_of(&some[i * record_bytes_]));
      if ((count_ + i) % sample_step_ == 0) sample(&some[i * record_bytes_]);
    }
    count_ += n;
    records = records.subspan(some.size());
  }
}

void CurveRecords::sample(const std::byte* record) {
  sample_.insert(sample_.end(), record, record + record_bytes_);
  if (sample_.size() < 2 * kSampleRecords * record_bytes_) return;
  for (std::size_t i = 0; i < kSampleRecords; ++i)
    std::memmove(&sample_[i * record_bytes_], &sample_[2 * i * record_bytes_], record_bytes_);
  sample_.resize(kSampleRecords * record_bytes_);
  sample_step_ *= 2;
}

void CurveRecords::begin_piece() {
  stop_if_cancelled();
  if (files_ && scratch_) put_aside(pieces_.back());
  if (files_ && !scratch_ && puts_aside((count_ + piece_rows_) * record_bytes_, memory_)) {
    scratch_ = files_();
    for (Piece& piece : pieces_) put_aside(piece);
  }
  pieces_.emplace_back().held.reserve(piece_rows_ * record_bytes_);
}

void CurveRecords::put_aside(Piece& piece) {
  if (piece.held.empty()) return;
  piece.offset = static_cast<std::uint64_t>(&piece - pieces_.data()) * piece_rows_ * record_bytes_;
  scratch_->append(piece.held);
  free_memory_of(piece.held);
}

void CurveRecords::sort(const LevelGrid& grid) {
  grid_ = grid;
  if (scratch_ && !pieces_.empty()) put_aside(pieces_.back());
  choose_ends(grid);
  parallel_for(pieces_.size(), [&](std::size_t i, unsigned) {
    stop_if_cancelled();
    sort_piece(pieces_[i], grid);
  });
}

void CurveRecords::choose_ends(const LevelGrid& grid) {
  const std::vector<std::byte> all = sorted(std::exchange(sample_, {}), grid).records;
  const std::uint64_t rows = all.size() / record_bytes_;
  const std::uint64_t few = kFewBytes / record_bytes_;
  const std::uint64_t stretch = std::min<std::uint64_t>(most_stretch_rows_, std::max(few, count_ / kManyStretches));
  const std::uint64_t each = std::max<std::uint64_t>(1, stretch / sample_step_);
  for (std::uint64_t at = each; at < rows; at += each) {
    const std::byte* record = &all[at * record_bytes_];
    End end{grid.key(point_of(record)), {record, record + record_bytes_}, false};
    if (ends_.empty() || ends_.back().record != end.record) {
      ends_.push_back(std::move(end));
    } else if (!ends_.back().is_behind) {
      end.is_behind = true;
      ends_.push_back(std::move(end));
    }
  }
}

CurveRecords::Sorted CurveRecords::sorted(std::vector<std::byte> records, const LevelGrid& grid) const {
  const std::size_t rows = records.size() / record_bytes_;
  std::vector<Entry> entries(rows);
  for (std::size_t i = 0; i < rows; ++i)
    entries[i] = {grid.key(point_of(&records[i * record_bytes_])), static_cast<std::uint32_t>(i)};
  std::sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
    if (a.key != b.key) return a.key < b.key;
    return std::memcmp(&records[a.row * record_bytes_], &records[b.row * record_bytes_], record_bytes_) < 0;
  });
  Sorted to{std::vector<std::byte>(records.size()), std::vector<CurveKey>(rows)};
  for (std::size_t i = 0; i < rows; ++i) {
    std::memcpy(&to.records[i * record_bytes_], &records[entries[i].row * record_bytes_], record_bytes_);
    to.keys[i] = entries[i].key;
  }
  return to;
}

bool CurveRecords::is_before(const CurveKey& key, const std::byte* record, const End& end) const {
  if (key != end.key) return key < end.key;
  const int order = std::memcmp(record, end.record.data(), record_bytes_);
  return end.is_behind ? order <= 0 : order < 0;
}

void CurveRecords::sort_piece(Piece& piece, const LevelGrid& grid) {
  const bool is_held = !piece.held.empty();
  std::vector<std::byte> records = std::move(piece.held);
  if (!is_held) {
    records.resize(piece.rows * record_bytes_);
    scratch_->read(piece.offset, records);
  }
  Sorted in_order = sorted(std::move(records), grid);
  std::size_t row = 0;
  for (const End& end : ends_) {
    std::size_t behind = piece.rows;
    while (row < behind) {
      const std::size_t middle = row + (behind - row) / 2;
      if (is_before(in_order.keys[middle], &in_order.records[middle * record_bytes_], end))
        row = middle + 1;
      else
        behind = middle;
    }
    piece.ends.push_back(static_cast<std::uint32_t>(row));
  }
  piece.ends.push_back(static_cast<std::uint32_t>(piece.rows));
  if (is_held)
    piece.held = std::move(in_order.records);
  else
    scratch_->replace(piece.offset, in_order.records);
}

std::uint64_t CurveRecords::rows_of(std::size_t stretch) const {
  std::uint64_t rows = 0;
  for (const Piece& piece : pieces_) rows += piece.ends[stretch] - (stretch == 0 ? 0 : piece.ends[stretch - 1]);
  return rows;
}

std::vector<std::byte> CurveRecords::records_of(std::size_t stretch) const {
  std::vector<std::byte> records(static_cast<std::size_t>(rows_of(stretch)) * record_bytes_);
  std::span<std::byte> rest = records;
  for (const Piece& piece : pieces_) {
    const std::size_t first = stretch == 0 ? 0 : piece.ends[stretch - 1];
    const std::span<std::byte> to = rest.first((piece.ends[stretch] - first) * record_bytes_);
    if (to.empty()) continue;
    if (piece.held.empty())
      scratch_->read(piece.offset + first * record_bytes_, to);
    else
      std::memcpy(to.data(), &piece.held[first * record_bytes_], to.size());
    rest = rest.subspan(to.size());
  }
  return records;
}

void CurveRecords::for_each(const Use& use) const {
  const std::size_t stretches = ends_.size() + 1;
  std::vector<Sorted> now(thread_count()), next(now.size());
  const auto load = [&](std::size_t first, std::vector<Sorted>& to) {
    parallel_for(std::min(to.size(), stretches - first), [&](std::size_t i, unsigned) {
      if (!is_of_one_record(first + i)) to[i] = sorted(records_of(first + i), *grid_);
    });
  };
  load(0, now);
  for (std::size_t first = 0; first < stretches; first += now.size()) {
    stop_if_cancelled();
    const std::size_t behind = first + now.size();
    std::optional<BackgroundTask> loading;
    if (behind < stretches) loading.emplace([&, behind] { load(behind, next); });
    for (std::size_t i = 0; i < now.size() && first + i < stretches; ++i) {
      if (is_of_one_record(first + i))
        repeat(first + i, use);
      else if (!now[i].keys.empty())
        use(now[i].records, now[i].keys);
    }
    if (loading) loading->wait();
    std::swap(now, next);
  }
}

void CurveRecords::repeat(std::size_t stretch, const Use& use) const {
  const End& end = ends_[stretch];
  std::uint64_t rows = rows_of(stretch);
  const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(rows, kRowsAtOnce));
  std::vector<std::byte> records(most * record_bytes_);
  for (std::size_t i = 0; i < most; ++i) std::memcpy(&records[i * record_bytes_], end.record.data(), record_bytes_);
  const std::vector<CurveKey> keys(most, end.key);
  for (; rows > 0; rows -= std::min<std::uint64_t>(rows, most)) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(rows, most));
    use(std::span(records).first(n * record_bytes_), std::span(keys).first(n));
  }
}

}  // namespace pointsweep
