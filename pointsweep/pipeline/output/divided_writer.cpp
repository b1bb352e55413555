// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/divided_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/files/folders.h"
#include "pointsweep/order/source.h"
#include "pointsweep/program/formats.h"
#include "pointsweep/row_error.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "pointsweep/threads.h"
#include "pointsweep/url.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMostWaitingBytes = 256 << 20;
constexpr std::size_t kPieceBytes = 1 << 20;
constexpr std::size_t kLeastRunBytes = 4096;

/// A header in a run, before each piece of the records of a group.
struct GroupHead {
  std::uint32_t group, count;
};

/// Returns the indices of the records sorted by group, ascending within a group.
std::vector<std::uint32_t> order_by_group(const std::vector<std::uint32_t>& group_of) {
  const std::uint32_t last = group_of.empty() ? 0 : *std::ranges::max_element(group_of);
  std::vector<std::uint32_t> next(std::size_t{last} + 2), order(group_of.size());
  for (const std::uint32_t group : group_of) ++next[group + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::uint32_t i = 0; i < group_of.size(); ++i) order[next[group_of[i]]++] = i;
  return order;
}

}  // namespace

/// A run, the bytes [begin, end) of the scratch, whose records are read back in sequence.
class GroupedRecords::Run {
 public:
  Run(const Scratch& scratch, std::uint64_t begin, std::uint64_t end, std::size_t record_bytes, std::size_t room)
      : scratch_(&scratch), next_(begin), end_(end), record_bytes_(record_bytes), held_(room) {
    read_head();
  }

  bool has_more() const { return head_.has_value(); }
  /// Passes the records of `group` to `use`, if the run has any. Groups ascend from call to call.
  void give(std::uint32_t group, const Use& use) {
    while (head_ && head_->group == group) give_part(use);
  }

 private:
  /// Passes the records after the header to `use`, in pieces of at most the room in memory, then reads the next header.
  void give_part(const Use& use) {
    for (std::size_t left = head_->count; left > 0;) {
      require(record_bytes_);
      const std::size_t n = std::min(left, (filled_ - at_) / record_bytes_);
      use(head_->group, std::span(held_).subspan(at_, n * record_bytes_));
      at_ += n * record_bytes_;
      left -= n;
    }
    read_head();
  }

  /// Reads more of the run unless `bytes` bytes that are not used yet are in memory.
  void require(std::size_t bytes) {
    if (filled_ - at_ >= bytes) return;
    std::copy(held_.begin() + static_cast<std::ptrdiff_t>(at_), held_.begin() + static_cast<std::ptrdiff_t>(filled_),
              held_.begin());
    filled_ -= std::exchange(at_, 0);
    const std::size_t n = std::min<std::uint64_t>(held_.size() - filled_, end_ - next_);
    scratch_->read(next_, std::span(held_).subspan(filled_, n));
    next_ += n;
    filled_ += n;
  }

  void read_head() {
    head_.reset();
    if (at_ == filled_ && next_ == end_) return;
    require(sizeof(GroupHead));
    std::memcpy(&head_.emplace(), held_.data() + at_, sizeof(GroupHead));
    at_ += sizeof(GroupHead);
  }

  const Scratch* scratch_;
  std::uint64_t next_, end_;  ///< bytes [next_, end_) of the scratch are not read yet
  std::size_t record_bytes_;
  std::vector<std::byte> held_;
  std::size_t at_ = 0, filled_ = 0;  ///< bytes [at_, filled_) of held_ are not used yet
  std::optional<GroupHead> head_;    ///< header of the next records; none at the end
};

GroupedRecords::GroupedRecords(std::size_t record_bytes, std::uint64_t expected, std::uint64_t memory_bytes,
                               MakeScratch make_scratch)
    : record_bytes_(record_bytes),
      expected_(std::max<std::uint64_t>(1, expected)),
      capacity_(std::clamp<std::uint64_t>(memory_bytes / (record_bytes + 2 * sizeof(std::uint32_t)), 1, 1u << 31)),
      memory_bytes_(memory_bytes),
      make_scratch_(std::move(make_scratch)) {}

std::byte* GroupedRecords::add(std::uint32_t group) {
  if (held() == capacity_) put_run_aside();
  if (held() == group_of_.capacity()) {  // doubling the capacity would exceed the budget for a while
    const std::size_t room = group_of_.empty() ? std::min<std::uint64_t>(capacity_, expected_) : capacity_;
    group_of_.reserve(room);
    records_.reserve(room * record_bytes_);
  }
  group_of_.push_back(group);
  records_.resize(records_.size() + record_bytes_);
  return records_.data() + records_.size() - record_bytes_;
}

void GroupedRecords::for_each_held(const Use& use) const {
  const std::vector<std::uint32_t> order = order_by_group(group_of_);
  const std::size_t most = std::max<std::size_t>(1, kPieceBytes / record_bytes_);
  std::vector<std::byte> piece;
  for (std::size_t i = 0; i < order.size();) {
    stop_if_cancelled();
    const std::uint32_t group = group_of_[order[i]];
    piece.clear();
    for (std::size_t n = 0; n < most && i < order.size() && group_of_[order[i]] == group; ++n, ++i) {
      const std::byte* const record = records_.data() + std::size_t{order[i]} * record_bytes_;
      piece.insert(piece.end(), record, record + record_bytes_);
    }
    use(group, piece);
  }
}

void GroupedRecords::put_run_aside() {
  if (!scratch_) scratch_ = make_scratch_();
  std::uint64_t end = run_ends_.empty() ? 0 : run_ends_.back();
  std::vector<std::byte> bytes;
  const auto append = [&] {
    scratch_->append(bytes);
    end += bytes.size();
    bytes.clear();
  };
  for_each_held([&](std::uint32_t group, std::span<const std::byte> records) {
    const GroupHead head{group, static_cast<std::uint32_t>(records.size() / record_bytes_)};
    const auto* const first = reinterpret_cast<const std::byte*>(&head);
    bytes.insert(bytes.end(), first, first + sizeof head);
    bytes.insert(bytes.end(), records.begin(), records.end());
    if (bytes.size() >= kPieceBytes) append();
  });
  append();
  run_ends_.push_back(end);
  records_.clear();
  group_of_.clear();
}

void GroupedRecords::for_each(const Use& use) {
  if (!scratch_) return for_each_held(use);
  if (held() != 0) put_run_aside();
  records_ = {};
  group_of_ = {};
  const std::size_t room =
      std::max({kLeastRunBytes, record_bytes_, std::min<std::size_t>(kPieceBytes, memory_bytes_ / run_ends_.size())});
  std::vector<Run> runs;
  std::uint64_t begin = 0;
  for (const std::uint64_t end : run_ends_)
    runs.emplace_back(*scratch_, std::exchange(begin, end), end, record_bytes_, room);
  std::uint64_t left = runs.size();
  for (std::uint32_t group = 0; left > 0; ++group) {
    stop_if_cancelled();
    left = 0;
    for (Run& run : runs) {
      run.give(group, use);
      left += run.has_more();
    }
  }
}

void require_files_possible(const Divider& divider, std::span<const DividedFile> files) {
  for (const DividedFile& file : files)
    if (file.own > 0) OutputFile::require_possible(divider.path_of(file.key), divider.plan().overwrite);
}

DividedFiles::DividedFiles(const Divider& divider, const std::vector<DividedFile>& files, std::uint64_t memory_bytes,
                           std::function<void(double share)> progress)
    : divider_(divider),
      files_(files),
      most_waiting_(std::min(kMostWaitingBytes, memory_bytes / 4)),
      progress_(std::move(progress)),
      outputs_(files.size(), [&](std::size_t file) { return divider.path_of(files[file].key); }) {
  for (const DividedFile& file : files_) all_ += file.all;
}

void DividedFiles::take(std::uint32_t file, std::span<const std::byte> records) {
  taken_ += records.size() / divider_.plan().schema.stride;
  if (progress_) progress_(static_cast<double>(taken_) / static_cast<double>(all_));
  if (files_[file].own > 0) extending_errors([&] { put(file, records); }, [&] { return state(); });
}

void DividedFiles::put(std::uint32_t number, std::span<const std::byte> records) {
  if (left_ == 0) begin(number);
  left_ -= records.size() / divider_.plan().schema.stride;
  if (!large_)
    return void(waiting_.back().records.insert(waiting_.back().records.end(), records.begin(), records.end()));
  with_rows_of_output([&] { large_->write(records); });
  if (left_ == 0) complete_large(number);
}

void DividedFiles::begin(std::uint32_t number) {
  left_ = files_[number].all;
  const std::uint64_t bytes = left_ * divider_.plan().schema.stride;
  if (bytes > most_waiting_) {
    large_ = create_writer(divider_.plan_of(files_[number]));
    return;
  }
  if (waiting_bytes_ + bytes > most_waiting_) write_together();
  waiting_.push_back({number, {}});
  waiting_.back().records.reserve(bytes);
  waiting_bytes_ += bytes;
}

void DividedFiles::complete_large(std::uint32_t number) {
  const std::unique_ptr<Writer> writer = std::exchange(large_, nullptr);
  with_rows_of_output([&] { writer->finish(); });
  ++complete_;
  bytes_written_ += writer->bytes_written();
  warnings_.add(writer->warnings(), divider_.path_of(files_[number].key));
}

void DividedFiles::write_together() {
  std::vector<std::uint64_t> bytes(waiting_.size());
  std::vector<std::vector<std::string>> warnings(waiting_.size());
  parallel_for(waiting_.size(), [&](std::size_t i, unsigned) {
    stop_if_cancelled();
    const std::unique_ptr<Writer> writer = create_writer(divider_.plan_of(files_[waiting_[i].file]));
    with_rows_of_output([&] {
      writer->write(std::exchange(waiting_[i].records, {}));
      writer->finish();
    });
    ++complete_;
    bytes[i] = writer->bytes_written();
    warnings[i] = writer->warnings();
  });
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    bytes_written_ += bytes[i];
    warnings_.add(warnings[i], divider_.path_of(files_[waiting_[i].file].key));
  }
  waiting_.clear();
  waiting_bytes_ = 0;
}

void DividedFiles::finish() {
  extending_errors([&] { write_together(); }, [&] { return state(); });
}

std::vector<std::string> DividedFiles::warnings() const {
  std::vector<std::string> sentences = warnings_.sentences();
  for (const DividedFile& file : files_)
    if (divider_.is_unplaced(file.key))
      sentences.push_back(fmt::format("{}: {} points have no finite x and y, and are in no tile.",
                                      divider_.path_of(file.key).string(), file.all));
  return sentences;
}

DividedRecords::DividedRecords(const Divider& divider, std::uint64_t expected, std::uint64_t memory_bytes,
                               MakeScratch make_scratch)
    : divider_(divider), records_(divider.plan().schema.stride, expected, memory_bytes, std::move(make_scratch)) {}

void DividedRecords::write(std::span<const std::byte> records) {
  const std::size_t bytes = divider_.record_bytes();
  keys_.resize(records.size() / bytes);
  for_each_task(keys_.size(), [&](std::size_t first, std::size_t n) {
    for (std::size_t i = first; i < first + n; ++i) keys_[i] = divider_.key_of(records.data() + i * bytes);
  });
  came_ += keys_.size();
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (i % kTaskRows == 0) stop_if_cancelled();
    const std::byte* const record = records.data() + i * bytes;
    put(keys_[i], record, true);
    if (divider_.has_buffers())
      divider_.for_each_buffer(record, keys_[i], [&](const FileKey& key) { put(key, record, false); });
  }
}

void DividedRecords::put(FileKey key, const std::byte* record, bool is_own) {
  const auto [known, is_new] = file_of_.try_emplace(key, static_cast<std::uint32_t>(files_.size()));
  if (is_new) files_.push_back({key});
  DividedFile& file = files_[known->second];
  ++file.all;
  if (is_own && file.own++ == 0) divider_.require_few(++with_points_);
  divider_.copy(record, is_own, records_.add(known->second));
}

DividedWriter::DividedWriter(OutputPlan plan, const OutputDivision& division, DivisionRoom room)
    : progress_(std::exchange(plan.progress, {})),
      divider_(std::move(plan), division),
      room_(std::move(room)),
      records_(divider_, divider_.plan().count, room_.bytes / 2, room_.scratch) {
  divider_.require_writable();
}

void DividedWriter::finish() {
  const OutputPlan& plan = divider_.plan();
  if (records_.came() != plan.count)
    fail("{}: {} points were announced, but {} came; nothing was written.", plan.path.string(), plan.count,
         records_.came());
  require_files_possible(divider_, records_.files());
  const auto progress = [&](double share) {
    progress_(static_cast<std::uint64_t>(share * static_cast<double>(records_.came())));
  };
  DividedFiles files(divider_, records_.files(), room_.bytes, progress_ ? progress : std::function<void(double)>());
  records_.for_each([&](std::uint32_t file, std::span<const std::byte> records) { files.take(file, records); });
  files.finish();
  complete_ = files.complete();
  bytes_written_ = files.bytes_written();
  for (const std::string& sentence : files.warnings()) add_warning(sentence);
  if (plan.overwrite && !is_url(plan.path)) warn_of_other_files();
}

/// Warns of point files in the folder that the run has not written, such as tiles of an earlier run.
void DividedWriter::warn_of_other_files() {
  const std::filesystem::path folder = folder_of(divider_.plan().path);
  std::set<std::filesystem::path> written;
  for (const DividedFile& file : records_.files())
    if (file.own > 0) written.insert(divider_.path_of(file.key).filename());
  std::set<std::string> others;
  try {
    for (const std::filesystem::directory_entry& entry : entries_of(folder))
      if (!is_hidden(entry.path()) && !written.contains(entry.path().filename()) && is_point_file(entry.path()))
        others.insert(entry.path().filename().string());
  } catch (const Error&) {
    return;  // the folder or a file in it may not be read; all files of the run are complete
  }
  if (others.empty()) return;
  add_warning(fmt::format(
      "{}: has point files that this run did not write ({}{}); a run over the folder reads them, too.", folder.string(),
      *others.begin(), others.size() > 1 ? fmt::format(" and {} more", others.size() - 1) : ""));
}

}  // namespace pointsweep
