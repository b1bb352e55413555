// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/context.h"

#include <fmt/format.h>

#include <atomic>
#include <memory>
#include <utility>

#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {
namespace {

class SpilledScratch final : public Scratch {
 public:
  explicit SpilledScratch(const TempFolder& folder) : file_(&folder) {}
  void append(std::span<const std::byte> bytes) override { file_.write(file_.reserve(bytes.size()), bytes); }
  void read(std::uint64_t offset, std::span<std::byte> bytes) const override { file_.read(offset, bytes); }
  void replace(std::uint64_t offset, std::span<const std::byte> bytes) override { file_.write(offset, bytes); }

 private:
  SpillFile file_;
};

}  // namespace

RunPlaces::RunPlaces(const EngineOptions& options, const std::optional<std::string>& identity)
    : temp_folder_(options.resources.temp_folder) {
  if (identity) checkpoints_.emplace(options, *identity);
}

SpillPlace RunPlaces::place(const char* kind, std::size_t number, bool spills) {
  if (checkpoints_) return checkpoints_->place(kind, number);
  return spills ? &folder() : nullptr;
}

const TempFolder& RunPlaces::folder() {
  const std::scoped_lock lock(making_);
  if (!folder_) folder_.emplace(temp_parent(temp_folder_));
  return *folder_;
}

MakeScratch RunPlaces::scratch() {
  return [this]() -> std::unique_ptr<Scratch> { return std::make_unique<SpilledScratch>(folder()); };
}

void RunReport::warn(const std::string& sentence) const {
  if (sentence.empty()) return;
  statistics.warnings.push_back(sentence);
  if (observer != nullptr) observer->on_warning(sentence);
}

void RunReport::note(const std::string& sentence) const {
  statistics.warnings.push_back(sentence);
  if (observer != nullptr) observer->on_note(sentence);
}

Context Context::over(InputCloud& left) const {
  return {left, outputs, options, plan, names, dropped, places, report, input_bytes, copies_rows, part};
}

bool Context::makes_output(std::size_t p) const {
  return leaves_in_order(plan, options) && p + 1 == plan.passes.size();
}

std::uint64_t Context::codec_bytes(std::uint64_t record_bytes, unsigned threads) const {
  return input_bytes + (copies_rows ? once_decoder_bytes(cloud, threads) : 0) +
         pointsweep::codec_bytes(cloud, outputs, options, record_bytes, threads);
}

PointSource Context::cloud_source() const {
  return source_of(cloud, [&read = statistics().bytes_read, stride = cloud.schema().stride](std::size_t n) {
    std::atomic_ref(read) += n * stride;
  });
}

void Context::progress(const char* phase, std::uint64_t done, std::uint64_t active) const {
  if (report.observer != nullptr) report.observer->on_progress({phase, done, cloud.count(), active});
}

std::function<void(std::uint64_t)> Context::progress_of(const char* phase) const {
  return [observer = report.observer, points = cloud.count(), phase](std::uint64_t done) {
    if (observer != nullptr) observer->on_progress({phase, done, points, 0});
  };
}

std::vector<std::uint64_t> Context::rows_of_cloud(std::vector<std::uint64_t> of_rows) const {
  if (cloud.selection() == nullptr) return of_rows;
  SelectionCursor kept(*cloud.selection());
  for (std::uint64_t& row : of_rows) row = kept.row_of(row);
  return of_rows;
}

RowError Context::located(const RowError& error) const {
  const auto [input, row] = cloud.place_of_row(rows_of_cloud({error.row()}).front());
  if (cloud.readers().size() == 1) return error.numbered(row);
  return error.named(fmt::format("{} of {}", row, cloud.readers()[input]->info().path.string()));
}

void Context::number_degenerate_rows(std::size_t first) const {
  auto& results = statistics().degenerate_results;
  for (std::size_t r = first; r < results.size(); ++r) results[r].rows = rows_of_cloud(std::move(results[r].rows));
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace pointsweep
