// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/checkpoint/checkpoints.h"

#include <algorithm>
#include <array>

#include "pointsweep/fail.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/pipeline/checkpoint/run_identity.h"

namespace pointsweep {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Encoding kCheckpointEncoding{"checkpoint", 1};
constexpr std::array kCounts = {&Statistics::sweeps,     &Statistics::certified, &Statistics::recalled,
                                &Statistics::degenerate, &Statistics::nonfinite, &Statistics::peak_points};

/// Largest share of the time between two checkpoints that saving a checkpoint takes.
constexpr double kShare = 0.01;

}  // namespace

void take_counts(Statistics& to, const Statistics& from) {
  for (const auto count : kCounts) to.*count = from.*count;
  to.degenerate_results = from.degenerate_results;
}

void Checkpoint::encode(Encoder& out) const {
  out.begin(kCheckpointEncoding);
  out.put<std::uint64_t>(memory_bytes);
  survey.encode(out);
  out.put<std::uint64_t>(sweep);
  out.put<std::uint64_t>(slab_points);
  for (const auto& part : {&stream, &results, &progress}) out.put_bytes(*part);
  out.put_list(bucket_places, [&](Vec3 p) { out.put_point(p); });
  out.put<std::uint64_t>(mask);
  out.put_list(values, [&](const std::vector<double>& value) { out.put_numbers<double>(value); });
  for (const auto count : kCounts) out.put<std::uint64_t>(counts.*count);
  out.put_list(counts.degenerate_results, [&](const DegenerateResults& results_of_stage) {
    out.put_text(results_of_stage.stage);
    out.put<std::uint64_t>(results_of_stage.count);
    out.put_numbers<std::uint64_t>(results_of_stage.rows);
  });
}

Checkpoint Checkpoint::decode(Decoder& in) {
  in.begin(kCheckpointEncoding);
  Checkpoint c;
  c.memory_bytes = in.get<std::uint64_t>();
  c.survey = Survey::decode(in);
  c.sweep = in.get<std::uint64_t>();
  c.slab_points = in.get<std::uint64_t>();
  for (auto* part : {&c.stream, &c.results, &c.progress}) *part = in.get_bytes();
  c.bucket_places = in.get_list<Vec3>([&] { return in.get_point(); });
  c.mask = in.get<std::uint64_t>();
  c.values = in.get_list<std::vector<double>>([&] { return in.get_numbers<double>(); });
  for (const auto count : kCounts) c.counts.*count = in.get<std::uint64_t>();
  c.counts.degenerate_results = in.get_list<DegenerateResults>([&] {
    return DegenerateResults{in.get_text(), in.get<std::uint64_t>(), in.get_numbers<std::uint64_t>()};
  });
  return c;
}

Checkpoints::Checkpoints(const EngineOptions& options, const std::string& identity)
    : folder_(options.resume_folder),
      identity_(identity),
      least_interval_(options.checkpoint_seconds),
      interval_(least_interval_) {
  found_ = !folder_.saved().empty();
  if (found_) {
    Decoder in(folder_.saved());
    require_same_run(in.get_text(), identity, folder_.path());  // the identity states the format of the rest
    last_ = Checkpoint::decode(in);
    in.finish();
  }
  folder_.keep_only(files());
}

SpillPlace Checkpoints::place(const char* kind, std::uint64_t sweep) const {
  return folder_.place(fmt::format("{}-{}", kind, sweep));
}

std::optional<SweepProgress> Checkpoints::progress() const {
  if (last_.progress.empty()) return std::nullopt;
  return decoded<SweepProgress>(last_.progress);
}

void Checkpoints::require_slabs_of(std::uint64_t slab_points) const {
  if (last_.slab_points > slab_points)
    fail(
        "'{}' was begun with more memory or fewer threads: give --memory and --threads as then, or remove the folder "
        "to start again.",
        folder_.path().string());
}

void Checkpoints::surveyed(const Survey& survey, std::uint64_t memory_bytes) {
  last_.survey = survey;
  last_.memory_bytes = memory_bytes;
}

void Checkpoints::in_order(const Stream& stream, std::uint64_t slab_points, const std::vector<Vec3>& bucket_places) {
  if (last_.is_in_order()) return;
  const auto begun = Clock::now();
  last_.slab_points = slab_points;
  last_.stream = encoded(stream);
  last_.bucket_places = bucket_places;
  save(begun);
}

bool Checkpoints::is_due() const {
  return Clock::now() - saved_at_ >= interval_ && (interval_.count() == 0 || !folder_.is_saving());
}

void Checkpoints::in_sweep(const SweepProgress& progress, RowStore& results) {
  const auto begun = Clock::now();
  last_.progress = encoded(progress);
  last_.results = encoded(results);
  save(begun);
}

void Checkpoints::swept(RowStore& results, const Statistics& counts) {
  const auto begun = Clock::now();
  last_.results = encoded(results);
  free_memory_of(last_.stream), free_memory_of(last_.progress), free_memory_of(last_.bucket_places);
  take_counts(last_.counts, counts);
  save(begun);
}

void Checkpoints::updated(bool selects, const CloudValues& values, const Statistics& counts) {
  const auto begun = Clock::now();
  free_memory_of(last_.results);
  ++last_.sweep;
  if (selects) last_.mask = last_.sweep;
  take_counts(last_.counts, counts);
  for (const auto& [number, value] : values) {
    if (last_.values.size() <= number) last_.values.resize(number + 1);
    last_.values[number] = value;
  }
  save(begun);
}

void Checkpoints::writing_tiles() {
  if (folder_.saved().empty() && !has_saved_) save(Clock::now());
}

void Checkpoints::save(Clock::time_point begun) {
  Encoder out;
  out.put_text(identity_);
  last_.encode(out);
  folder_.save(out.take(), files());
  has_saved_ = true;
  saved_at_ = Clock::now();
  const std::chrono::duration<double> took = saved_at_ - begun;
  if (least_interval_.count() > 0) interval_ = std::max(least_interval_, took / kShare);
}

/// Returns the names of the files that the last checkpoint refers to.
std::set<std::string> Checkpoints::files() const {
  std::set<std::string> names;
  if (last_.sweep > 0) names.insert(place("rows", last_.sweep).file().filename());
  if (last_.mask > 0) names.insert(place("mask", last_.mask).file().filename());
  if (last_.is_in_order()) names.insert(place("stream", last_.sweep).file().filename());
  if (!last_.results.empty()) names.insert(place("results", last_.sweep).file().filename());
  return names;
}

}  // namespace pointsweep
