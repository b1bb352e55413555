// SPDX-License-Identifier: MIT
#include "pointsweep/formats/chosen_chunks.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/number_from.h"

namespace pointsweep {
namespace {

constexpr std::string_view kDepth = "depth:", kSpacing = "spacing:";
constexpr int kDeepest = 31;

/// Returns the greatest depth that the word chooses. `root_spacing`: the spacing of points at the root.
int depth_of(std::string_view word, double root_spacing) {
  if (word.starts_with(kDepth))
    return static_cast<int>(std::min<double>(*number_from<double>(word.substr(kDepth.size())), kDeepest));
  return depth_of_spacing(root_spacing, *number_from<double>(word.substr(kSpacing.size())));
}

}  // namespace

int depth_of_spacing(double root, double spacing) {
  int depth = 0;
  while (depth < kDeepest && std::ldexp(root, -depth) > spacing) ++depth;
  return depth;
}

ChosenChunks::ChosenChunks(std::shared_ptr<Reader> all, const Choice& is_chosen, std::string_view word)
    : Reader(*all), all_(std::move(all)) {
  if (!word.empty()) {
    info_.asked_for_as = word;
    info_.bounds.reset();  // the bounds of the file include all points
    info_.claims.reset();
  }
  const std::uint64_t rows = info_.count;
  info_.count = 0;
  for (std::uint64_t row = 0; row < rows;) {
    const Chunk chunk = all_->chunk_of(row);
    row = chunk.end_row();
    if (!is_chosen(chunk)) continue;
    chosen_.push_back({info_.count, chunk});
    info_.count += chunk.rows;
  }
  info_.left_out += rows - info_.count;
}

const ChosenChunks::Chosen& ChosenChunks::chosen_at(std::uint64_t row) const {
  return *std::prev(std::ranges::upper_bound(chosen_, row, {}, &Chosen::first_row));
}

Chunk ChosenChunks::chunk_of(std::uint64_t row) const {
  const Chosen& chosen = chosen_at(row);
  Chunk chunk = chosen.chunk;
  chunk.first_row = chosen.first_row;
  return chunk;
}

std::uint64_t ChosenChunks::input_row(std::uint64_t row) const {
  const Chosen& chosen = chosen_at(row);
  return chosen.chunk.first_row + (row - chosen.first_row);
}

void ChosenChunks::rest() {
  Reader::rest();
  all_->rest();
}

class ChosenChunks::Decoder final : public RowDecoder {
 public:
  Decoder(const ChosenChunks& chunks, std::unique_ptr<RowDecoder> all) : chunks_(chunks), all_(std::move(all)) {}

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t stride = chunks_.info_.schema.stride, wanted = chunks_.rows_for(row, records);
    std::size_t done = 0;
    while (done < wanted) {
      const Chosen& chosen = chunks_.chosen_at(row + done);
      const std::uint64_t before = row + done - chosen.first_row;
      const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(wanted - done, chosen.chunk.rows - before));
      const std::span<std::byte> to = records.subspan(done * stride, rows * stride);
      const std::size_t read = all_->read(chosen.chunk.first_row + before, to);
      if (read == 0) break;
      done += read;
    }
    return done;
  }

 private:
  const ChosenChunks& chunks_;
  std::unique_ptr<RowDecoder> all_;
};

std::unique_ptr<RowDecoder> ChosenChunks::decoder(const WantedFields& wanted) const {
  return std::make_unique<Decoder>(*this, all_->decoder(wanted));
}

bool chooses_levels(std::string_view word) {
  for (const std::string_view begin : {kDepth, kSpacing}) {
    if (!word.starts_with(begin)) continue;
    const std::string_view rest = word.substr(begin.size());
    const std::optional<double> number = number_from<double>(rest);
    if (begin == kDepth && (!number || *number < 0 || std::floor(*number) != *number))
      fail_usage("--depth: '{}' is no depth; the coarsest is 0.", rest);
    if (begin == kSpacing && (!number || !(*number > 0)))
      fail_usage("--resolution: '{}' is no distance above 0.", rest);
    return true;
  }
  return false;
}

std::unique_ptr<Reader> with_chosen_levels(std::unique_ptr<Reader> all, std::string_view word) {
  const std::optional<double> spacing = all->info().root_spacing;
  if (!spacing)
    fail(
        "{}: has no levels of detail, as COPC files have; leave {} out, or write a COPC file first: pointsweep convert "
        "IN OUT.copc.laz.",
        all->info().path.string(), word.starts_with(kDepth) ? "--depth" : "--resolution");
  const int depth = depth_of(word, *spacing);
  return std::make_unique<ChosenChunks>(
      std::move(all), [&](const Chunk& chunk) { return chunk.depth <= depth; }, word);
}

}  // namespace pointsweep
