// SPDX-License-Identifier: MIT
#include "pointsweep/formats/cloud/input_cloud.h"

#include <algorithm>

#include "pointsweep/fail.h"
#include "pointsweep/files.h"
#include "pointsweep/formats/cloud/reader_adapters.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/points/input_row.h"
#include "pointsweep/storage/remote/remote_object.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

constexpr std::size_t kScratchBytes = 1 << 20;

/// The largest number of rows in a chunk for which threads decode chunks side by side. With longer chunks, other
/// threads would wait for the decoding thread; instead the threads take turns at reading, and work on the rows they
/// have read.
constexpr std::uint64_t kLongestChunk = 1 << 18;

bool decodes_side_by_side(const std::shared_ptr<Reader>& reader) {
  if (!reader->has_decoders()) return false;
  return reader->info().count == 0 || reader->decodes_any_range() || reader->chunk_of(0).rows <= kLongestChunk;
}

/// Calls work(i) for each input i. Makes many calls at once if `is_remote`, since each call then waits for the network.
void for_each_input(std::size_t count, bool is_remote, const std::function<void(std::size_t i)>& work) {
  if (is_remote) return for_each_waiting(count, work);
  for (std::size_t i = 0; i < count; ++i) work(i);
}

/// Throws UsageError if columns of text are named and no input is text.
void require_text_for_columns(const std::vector<std::shared_ptr<Reader>>& readers, std::string_view format) {
  if (format.starts_with("text:") && !readers.empty() &&
      std::ranges::none_of(readers, [&](const auto& reader) { return reader->info().asked_for_as == format; }))
    fail_usage("--columns: no input is text ({} is {}); leave it out.", readers.front()->info().path.string(),
               readers.front()->info().format);
}

using Extras = std::shared_ptr<const FormatExtras>;

bool are_alike(const Extras& a, const Extras& b) {
  if (a == nullptr || b == nullptr) return a == b;
  return a->format() == b->format() && a->is_like(*b);
}

std::vector<FileState> states_of(const std::vector<std::shared_ptr<Reader>>& readers) {
  std::vector<FileState> states;
  for (const auto& reader : readers) states.emplace_back(reader->info().path);
  return states;
}

}  // namespace

InputCloud::InputCloud(const std::vector<std::filesystem::path>& paths, CloudOptions options) {
  std::vector<std::filesystem::path> places;
  for (const std::filesystem::path& path : paths) places.push_back(known_place(path));
  std::vector<std::optional<FileState>> states(places.size());
  readers_.resize(places.size());
  const bool is_remote = std::ranges::any_of(places, [](const auto& place) { return is_url(place); });
  for_each_input(places.size(), is_remote, [&](std::size_t i) {
    states[i].emplace(places[i]);
    readers_[i] = open_reader(places[i], options.format);
    require_unnumbered(*readers_[i]);
  });
  require_text_for_columns(readers_, options.format);
  std::vector<FileState> known;
  for (std::optional<FileState>& state : states) known.push_back(std::move(*state));
  states_ = std::make_shared<const std::vector<FileState>>(std::move(known));
  begin(options);
}

InputCloud::InputCloud(std::vector<std::unique_ptr<Reader>> readers, CloudOptions options)
    : InputCloud(std::vector<std::shared_ptr<Reader>>(std::make_move_iterator(readers.begin()),
                                                      std::make_move_iterator(readers.end())),
                 options) {}

InputCloud::InputCloud(std::vector<std::shared_ptr<Reader>> readers, CloudOptions options)
    : states_(std::make_shared<const std::vector<FileState>>(states_of(readers))), readers_(std::move(readers)) {
  begin(options);
}

void InputCloud::begin(CloudOptions options) {
  if (readers_.empty()) fail_usage("no input was given; name at least one point file.");
  ignores_crs_ = options.ignore_crs;
  stated_crs_ = options.crs;
  CommonCrs crs = stated_crs_ ? pointsweep::stated_crs(readers_, *stated_crs_) : common_crs(readers_, ignores_crs_);
  replaces_crs_ = crs.replaces;
  crs_ = std::move(crs.crs);
  warnings_ = std::move(crs.warnings);
  std::optional<LasOrigin> las = common_las_origin(readers_, warnings_);
  take_common_schema();
  warnings_.insert(warnings_.end(), missing_attributes_.begin(), missing_attributes_.end());
  const PositionFields p = position_fields(schema_, readers_.front()->info().path.string());
  if (las && p.x.type == Type::i32)  // the common grid of the inputs may have another offset
    las->grid = grid_of(p);
  if (las) las_ = std::make_shared<const LasOrigin>(*las);
  count_rows();
}

void InputCloud::take_common_schema() {
  CommonSchema common = common_schema(readers_);
  schema_ = std::move(common.schema);
  mappings_ = std::make_shared<const std::vector<InputMapping>>(std::move(common.mappings));
  ranges_ = std::move(common.ranges);
  missing_attributes_ = std::move(common.warnings);
}

InputCloud InputCloud::numbered(std::uint64_t first) const {
  InputCloud cloud = *this;
  if (has_input_row(schema_)) return cloud;
  for (std::size_t i = 0; i < readers_.size(); ++i)
    cloud.readers_[i] = std::make_shared<NumberedRows>(readers_[i], first + first_row_[i]);
  cloud.take_common_schema();
  return cloud;
}

InputCloud InputCloud::with_chunks(const std::function<bool(const Chunk&)>& is_chosen) const {
  InputCloud cloud = *this;
  cloud.chosen_.assign(readers_.size(), nullptr);
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    if (!readers_[i]->has_decoders() || readers_[i]->decodes_any_range()) continue;
    const auto chosen = std::make_shared<ChosenChunks>(readers_[i], is_chosen);
    cloud.chosen_[i] = chosen;
    cloud.readers_[i] = chosen;
  }
  cloud.count_rows();
  if (cloud.count_ > 0 || count_ == 0) return cloud;
  return with_chunks([first = true](const Chunk&) mutable { return std::exchange(first, false); });
}

void InputCloud::count_rows() {
  count_ = 0;
  first_row_.clear();
  for (const auto& reader : readers_) {
    first_row_.push_back(count_);
    count_ += reader->info().count;
  }
}

std::pair<InputCloud, NonfiniteRows> InputCloud::finite(const std::function<void(std::uint64_t)>& progress) const {
  std::pair<InputCloud, NonfiniteRows> result{*this, {}};
  auto& [cloud, found] = result;
  cloud.finite_.assign(readers_.size(), nullptr);
  bool all_bounded = true;
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    const FileInfo& info = readers_[i]->info();
    if (!can_be_nonfinite(info.schema, info.path)) {
      all_bounded &= info.count == 0;
      continue;
    }
    FiniteRowIndex index(*readers_[i], first_row_[i], found, [&](std::uint64_t rows) {
      if (progress) progress(first_row_[i] + rows);
    });
    if (index.has_all()) continue;
    const auto finite = std::make_shared<FiniteRows>(readers_[i], std::move(index));
    cloud.finite_[i] = finite;
    cloud.readers_[i] = finite;
  }
  if (!all_bounded) found.bounds = {};
  cloud.count_rows();
  return result;
}

InputCloud InputCloud::read_by(std::vector<std::shared_ptr<Reader>> readers) const {
  InputCloud cloud = *this;
  cloud.readers_ = std::move(readers);
  return cloud;
}

InputCloud InputCloud::with_unused_attributes() const {
  InputCloud cloud = *this;
  cloud.attributes_are_unused_ = true;
  return cloud;
}

InputCloud InputCloud::selected(RowSelection selection) const {
  InputCloud cloud = *this;
  cloud.selection_ = std::make_shared<const RowSelection>(std::move(selection));
  return cloud;
}

std::pair<std::size_t, std::uint64_t> InputCloud::place_of_row(std::uint64_t row) {
  const std::size_t input = input_of(row);
  const std::uint64_t in_file = row - first_row_[input];
  const bool has_dropped = !finite_.empty() && finite_[input] != nullptr;
  const std::uint64_t read = has_dropped ? finite_[input]->input_row(in_file) : in_file;
  return {input, chosen_row(input, read)};
}

std::uint64_t InputCloud::row_in_file(std::size_t input, std::uint64_t row) const {
  const bool has_dropped = !finite_.empty() && finite_[input] != nullptr;
  return chosen_row(input, has_dropped ? finite_[input]->row_of_all(row) : row);
}

std::uint64_t InputCloud::chosen_row(std::size_t input, std::uint64_t row) const {
  const bool is_chosen = !chosen_.empty() && chosen_[input] != nullptr;
  return is_chosen ? chosen_[input]->input_row(row) : row;
}

std::vector<std::uint64_t> InputCloud::first_rows() const {
  std::vector<std::uint64_t> rows = first_row_;
  rows.push_back(count_);
  if (!selection_) return rows;
  SelectionCursor cursor(*selection_);
  for (std::uint64_t& row : rows) row = cursor.kept_before(row);
  return rows;
}

std::uint64_t InputCloud::input_row(std::uint64_t row) {
  const auto [input, in_file] = place_of_row(row);
  std::uint64_t left_out = 0;
  for (std::size_t i = 0; i < input; ++i) left_out += readers_[i]->info().left_out;
  return first_row_[input] + left_out + in_file;
}

std::shared_ptr<const FormatExtras> InputCloud::extras() const { return readers_.front()->info().extras; }

std::vector<std::shared_ptr<const FormatExtras>> InputCloud::other_extras() const {
  constexpr std::ptrdiff_t kCompared = 16;  // number of kinds that are compared; a folder has few kinds of files
  std::vector<Extras> others;
  for (std::size_t i = 1; i < readers_.size(); ++i) {
    const Extras& extras = readers_[i]->info().extras;
    const auto compared = std::span(others).last(static_cast<std::size_t>(std::min(kCompared, std::ssize(others))));
    if (std::ranges::none_of(compared, [&](const auto& other) { return are_alike(extras, other); }))
      others.push_back(extras);
  }
  return others;
}

std::uint64_t InputCloud::bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& reader : readers_) bytes += reader->info().bytes;
  return bytes;
}

std::size_t InputCloud::read(std::uint64_t row, std::span<std::byte> records) {
  const auto read = [this](std::size_t input, std::uint64_t first, std::span<std::byte> bytes) {
    if (input != reading_.last_input) readers_[reading_.last_input]->rest();
    reading_.last_input = input;
    return checked(input, first, bytes, {}, readers_[input]->read(first, bytes));
  };
  return read_with(read, reading_, row, records);
}

std::size_t InputCloud::read_with(const ReadInput& read, Reading& reading, std::uint64_t row,
                                  std::span<std::byte> records) const {
  if (!selection_) return read_all_with(read, reading.scratch, row, records);
  if (!reading.cursor) reading.cursor.emplace(*selection_);
  return reading.cursor->read(row, schema_.stride, records, [&](std::uint64_t first, std::span<std::byte> all) {
    if (read_all_with(read, reading.scratch, first, all) * schema_.stride != all.size())
      fail("{}: ends before its last point; run again when it is complete.", readers_.back()->info().path.string());
  });
}

/// Reads rows like read_with(), but counts and reads all rows, including rows that are not selected.
std::size_t InputCloud::read_all_with(const ReadInput& read, std::vector<std::byte>& scratch, std::uint64_t row,
                                      std::span<std::byte> records) const {
  std::size_t done = 0;
  for (const std::size_t wanted = records.size() / schema_.stride; done < wanted && row + done < count_;) {
    const std::size_t input = input_of(row + done);
    done += read_input(read, scratch, input, row + done - first_row_[input], records.subspan(done * schema_.stride));
  }
  return done;
}

std::size_t InputCloud::input_of(std::uint64_t row) const {
  return static_cast<std::size_t>(std::ranges::upper_bound(first_row_, row) - first_row_.begin()) - 1;
}

std::uint64_t InputCloud::chunk_end(std::uint64_t row) const {
  std::optional<SelectionCursor> cursor;
  if (selection_) cursor.emplace(*selection_);
  const std::uint64_t of_all = cursor ? cursor->row_of(row) : row;
  const std::size_t input = input_of(of_all);
  const Reader& reader = *readers_[input];
  if (reader.decodes_any_range()) return row;
  const std::uint64_t end = first_row_[input] + reader.chunk_of(of_all - first_row_[input]).end_row();
  return cursor ? cursor->kept_before(end) : end;
}

/// A decoder of the cloud. It keeps the decoder of only one input, the input that it reads, since there may be
/// thousands of inputs.
class InputCloud::Decoder final : public RowDecoder {
 public:
  Decoder(const InputCloud& cloud, WantedFields wanted) : cloud_(cloud), wanted_(std::move(wanted)) {}

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const auto read_rows = [this](std::size_t input, std::uint64_t first, std::span<std::byte> bytes) {
      if (!decoder_ || input != input_) {
        // If records are converted, the field numbers of the input differ from the numbers in `wanted_`.
        const bool all = (*cloud_.mappings_)[input].conversion != nullptr;
        decoder_ = cloud_.readers_[input]->decoder(all ? WantedFields{} : wanted_);
        input_ = input;
      }
      return cloud_.checked(input, first, bytes, wanted_, decoder_->read(first, bytes));
    };
    return cloud_.read_with(read_rows, reading_, row, records);
  }

 private:
  const InputCloud& cloud_;
  WantedFields wanted_;
  std::unique_ptr<RowDecoder> decoder_;
  std::size_t input_ = 0;
  Reading reading_;
};

std::unique_ptr<RowDecoder> InputCloud::decoder(const WantedFields& wanted) const {
  if (!std::ranges::all_of(readers_, &decodes_side_by_side)) return nullptr;
  return std::make_unique<Decoder>(*this, wanted);
}

const Reader* InputCloud::stated_boxes(std::vector<RowBox>& boxes) const {
  const Reader* without = nullptr;
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    const Reader& reader = *readers_[i];
    const std::uint64_t rows = reader.info().count;
    const std::size_t before = boxes.size();
    for (std::uint64_t row = 0; row < rows && reader.has_decoders();) {
      const Chunk chunk = reader.chunk_of(row);
      if (!chunk.bounds) break;
      boxes.push_back({first_row_[i] + row, chunk.end_row() - row, *chunk.bounds});
      row = chunk.end_row();
    }
    const bool all = boxes.size() > before && boxes.back().first_row + boxes.back().rows == first_row_[i] + rows;
    if (all || rows == 0) continue;
    boxes.resize(before);
    const std::optional<Box>& box = reader.info().bounds;
    if (box)
      boxes.push_back({first_row_[i], rows, *box});
    else if (without == nullptr)
      without = &reader;
  }
  return without;
}

void InputCloud::require_unchanged() const {
  const bool is_remote = std::ranges::any_of(readers_, [](const auto& r) { return is_url(r->info().path); });
  for_each_input(readers_.size(), is_remote, [this](std::size_t i) { require_unchanged(i); });
}

void InputCloud::require_unchanged(std::size_t input) const {
  if ((*states_)[input].has_changed())
    fail("{}: was written to while it was read, so old and new points may be mixed; run again once it is complete.",
         readers_[input]->info().path.string());
}

/// Returns `rows`, the number of records that input `input` has read into `records` from its row `row` on. Throws Error
/// if the type of a `wanted` field in the cloud cannot hold one of its integers exactly, unless
/// with_unused_attributes() made the cloud.
std::size_t InputCloud::checked(std::size_t input, std::uint64_t row, std::span<const std::byte> records,
                                const WantedFields& wanted, std::size_t rows) const {
  if (attributes_are_unused_) return rows;
  const FileInfo& info = readers_[input]->info();
  const std::size_t stride = info.schema.stride;
  const auto loss = (*mappings_)[input].wide.first_loss(records.first(rows * stride), stride, wanted);
  if (!loss) return rows;
  fail(
      "{}: row {}: '{}' is {}, and the type that it has together with the other inputs, {}, cannot hold that value; "
      "write the inputs to a folder, or leave '{}' out of one of them first.",
      info.path.string(), row_in_file(input, row + loss->record), loss->name, loss->value, name_of(loss->type),
      loss->name);
}

/// Reads like read(), from one input. `row` counts from 0 in the input, which has at least one row from `row` on.
std::size_t InputCloud::read_input(const ReadInput& read, std::vector<std::byte>& scratch, std::size_t input,
                                   std::uint64_t row, std::span<std::byte> records) const {
  const Reader& reader = *readers_[input];
  const InputMapping& mapping = (*mappings_)[input];
  const std::size_t stride = reader.info().schema.stride;
  std::span<std::byte> target = records;
  if (mapping.conversion) {
    const std::size_t most = std::max<std::size_t>(1, kScratchBytes / stride);
    const std::size_t rows = std::min(records.size() / schema_.stride, most);
    scratch.resize(std::max(scratch.size(), rows * stride));
    target = std::span(scratch).first(rows * stride);
  }
  const std::size_t rows = read(input, row, target);
  if (rows == 0) fail("{}: ends before its last point; run again once it is complete.", reader.info().path.string());
  if (mapping.shift.is_needed()) mapping.shift.run(target.first(rows * stride), stride, reader.info().path);
  if (mapping.conversion) mapping.conversion->run(target.data(), records.data(), rows);
  if (mapping.missing.is_needed()) mapping.missing.run(records.first(rows * schema_.stride), schema_.stride);
  return rows;
}

std::unique_ptr<InputCloud> opened_cloud(const std::string& name, bool ignore_crs) {
  std::vector<std::filesystem::path> paths;
  for (const ListedFile& file : list_inputs({name}, false).files) paths.push_back(file.path);
  return std::make_unique<InputCloud>(paths, CloudOptions{.ignore_crs = ignore_crs});
}

}  // namespace pointsweep
