// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/checkpoint/checkpoints.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "pointsweep/fail.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/program/run_options.h"
#include "pointsweep/storage/local/place.h"

namespace pointsweep {
namespace {

/// Number of the checkpoint format. Every change of the content of checkpoints, or of how points are cut into slabs and
/// cells, must increase it.
constexpr int kCheckpointFormat = 10;

std::string inputs_text(const InputCloud& cloud) {
  std::string text;
  for (std::size_t i = 0; i < cloud.readers().size(); ++i) {
    const FileInfo& info = cloud.readers()[i]->info();
    const FileState& state = cloud.states()[i];
    if (!state.is_known())
      fail("Only files can be gone on with, and '{}' is none: leave out --resume.", info.path.string());
    text += fmt::format("input '{}' with {} points, {}{}\n", whole_name(info.path), info.count, state.text(),
                        info.asked_for_as.empty() ? "" : ", read as " + info.asked_for_as);
  }
  return text;
}

std::string outputs_text(const Outputs& outputs) {
  std::string text;
  if (!outputs.points.empty()) text += fmt::format("output '{}'\n", whole_name(outputs.points));
  for (const auto& tile : outputs.tiles) text += fmt::format("output '{}' of an input\n", whole_name(tile));
  for (const auto& [name, path] : outputs.arrays) text += fmt::format("output '{}' of {}\n", whole_name(path), name);
  return text;
}

std::string kept_text(const KeptFields& kept, const Schema& input) {
  std::vector<std::string> parts;
  if (kept.input) {
    std::string& part = parts.emplace_back("kept fields of the input:");
    for (const std::size_t f : *kept.input) part += " " + input.fields[f].name;
  }
  if (!kept.left_out.empty()) parts.push_back(fmt::format("made fields left out: {}", fmt::join(kept.left_out, " ")));
  if (!kept.order.empty()) parts.push_back(fmt::format("order of the fields: {}", fmt::join(kept.order, " ")));
  return parts.empty() ? "" : fmt::format("{}\n", fmt::join(parts, "; "));
}

std::string pass_text(const PlannedPass& pass) {
  const SweepPlan& plan = pass.plan;
  std::string text = "pass of";
  for (const Stage& stage : plan.stages) text += " " + name_of(stage.op);
  text += ", making";
  for (const Attribute& a : pass.made) text += " " + a.name;
  return text + "\n";
}

using Clock = std::chrono::steady_clock;

constexpr Encoding kCheckpointEncoding{"checkpoint", 2};
constexpr std::array kCounts = {&Statistics::sweeps,     &Statistics::certified, &Statistics::recalled,
                                &Statistics::degenerate, &Statistics::nonfinite, &Statistics::peak_points};

/// Largest share of the time between two checkpoints that saving one may take. A slow save lengthens the interval,
/// unless the user sets it to 0.
constexpr double kShare = 0.01;

}  // namespace

std::string run_identity(const InputCloud& cloud, const ChainPlan& plan, const Outputs& outputs,
                         const EngineOptions& options) {
  std::string text = fmt::format("version {}, checkpoints {}\n", POINTSWEEP_VERSION, kCheckpointFormat);
  text += inputs_text(cloud) + outputs_text(outputs);
  text += fmt::format("cells of {} points\n{}", options.cell_points, identity_text(options));
  if (const std::optional<StatedCrs>& stated = cloud.stated_crs())
    text += fmt::format("crs {} {}\n", stated->crs ? short_text(*stated->crs) : "none",
                        stated->crs ? stated->crs->wkt : "");
  text += fmt::format("pipeline {}\n", fmt::join(canonical_stages(plan, Presets::spelled_out), " | "));
  for (const PlannedPass& pass : plan.passes) text += pass_text(pass);
  text += kept_text(plan.kept, cloud.schema());
  return text;
}

void require_same_run(const std::string& checkpoint, const std::string& now, const std::filesystem::path& folder) {
  if (checkpoint == now) return;
  std::istringstream there(checkpoint), here(now);
  std::string was, is;
  bool more = true;
  while (was == is && more) {
    more = static_cast<bool>(std::getline(there, was));
    if (!more) was = "complete";
    if (!std::getline(here, is)) is = "complete";
  }
  fail("'{}' holds another run: there it is {}, here {}; give the command that was interrupted, or remove the folder.",
       folder.string(), was, is);
}

void take_counts(Statistics& to, const Statistics& from) {
  for (const auto count : kCounts) to.*count = from.*count;
  to.degenerate_results = from.degenerate_results;
}

void Checkpoint::encode(Encoder& out) const {
  out.begin(kCheckpointEncoding);
  out.put<std::uint64_t>(memory_bytes);
  survey.encode(out);
  out.put_bool(ordered.has_value());
  if (ordered) ordered->encode(out);
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
  if (in.get_bool()) c.ordered = Survey::decode(in);
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
    // Runs with equal identities have the same checkpoint format, so the rest can be decoded.
    require_same_run(in.get_text(), identity, folder_.path());
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

void Checkpoints::in_order(const Stream& stream, std::uint64_t slab_points, const Survey& survey,
                           const std::vector<Vec3>& bucket_places) {
  if (last_.is_in_order()) return;
  const auto begun = Clock::now();
  last_.slab_points = slab_points;
  last_.stream = encoded(stream);
  last_.ordered = survey;
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
