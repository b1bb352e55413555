// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/memory/run_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <thread>

#include "pointsweep/fail.h"
#include "pointsweep/order/slabs_on_demand.h"
#include "pointsweep/pipeline/available_memory.h"
#include "pointsweep/pipeline/memory/sample_estimates.h"
#include "pointsweep/pipeline/output/divided_writer.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/rows/other_cloud.h"
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/storage/remote/remote_object.h"
#include "pointsweep/storage/remote/url.h"
#include "pointsweep/sweep/stage_runner.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMovedPositionBytes = 3 * sizeof(double);

bool in_memory(const MemoryPlan& plan) { return !plan.spill_stream && !plan.spill_results; }

MemoryDemand demand(std::uint64_t record_bytes, std::uint64_t result_bytes, std::uint64_t points, const Survey& survey,
                    const EngineOptions& options, std::uint64_t codec_bytes) {
  const std::uint64_t row_bytes = points >> 32 ? 8 : 4;
  return {
      .points = points,
      .working_record_bytes = record_bytes + row_bytes,
      .result_record_bytes = result_bytes,
      .slab_points = options.slab_points != 0 ? options.slab_points : recommended_slab_points(points, survey.dimension),
      .slabs_per_turn = options.slab_points != 0 ? std::max(1u, options.slabs_per_turn) : options.slabs_per_turn,
      .threads = threads_asked_for(options),
      .cell_points = options.cell_points,
      .codec_bytes = codec_bytes};
}

/// Adds the memory that a radius without a limit k needs. Returns the effort of the search and the operators, for a
/// sentence to the user. With a limit k, adds nothing and returns no effort.
Effort add_radius(MemoryDemand& demand, const SweepPlan& plan, Estimates& estimates) {
  const Neighborhood& n = plan.neighborhood;
  if (n.k != Neighborhood::kUnlimited) return {};
  const double width = n.radius * static_cast<double>(plan.step_count() + 1);
  const RadiusEstimate estimate = estimates.radius(n.radius);
  demand.slice_points = estimates.slice(width);
  demand.most_neighbors = static_cast<std::uint64_t>(estimate.most_neighbors);
  const double all = estimate.neighbors * static_cast<double>(demand.points);
  return {neighbor_seconds(plan, all) / demand.threads, "The radius", neighbors_text(estimate.neighbors),
          "a smaller one, or k beside it, takes less"};
}

/// Adds the points that stay in the window because their cells wait for one another, in plans of several steps with a
/// limit k. Adds none if half of the budget has room for a window that holds all points.
void add_steps(MemoryDemand& demand, const SweepPlan& plan, std::uint64_t budget, Estimates& estimates) {
  const Neighborhood& n = plan.neighborhood;
  if (n.k == Neighborhood::kUnlimited || plan.step_count() < 2) return;
  if (whole_window_bytes(plan, demand.points) <= budget / 2) return;
  const double dimension = std::clamp(estimates.survey().dimension, 1.0, 3.0);
  demand.waiting_for_steps = estimates.open_points(window_neighbors(plan, demand.cell_points, dimension));
}

/// Returns the axis along which an in-order operator with Places::in_plane takes the points: the stated axis x or y, or
/// else the longer of these two axes in the survey's bounds.
int axis_of_places(const Survey& survey, const EngineOptions& options) {
  if (options.axis && *options.axis < 2) return *options.axis;
  const Vec3 extent = survey.bounds.extent();
  return extent.x >= extent.y ? 0 : 1;
}

/// Adds the least memory of the in-order operator of a pass, and sets its effort.
void add_in_order(MemoryDemand& demand, const PlannedPass& pass, Estimates& estimates, const EngineOptions& options,
                  Effort& effort) {
  const InOrderOperator* op = pass.in_order();
  if (op == nullptr) return;
  const Survey& survey = estimates.survey();
  const auto slice_points = [&](double thickness) { return estimates.slice(thickness); };
  const CloudEstimate cloud{.points = demand.points,
                            .sample = survey.sample,
                            .axis = axis_of_places(survey, options),
                            .threads = demand.threads,
                            .slice_points = slice_points};
  const InOrderEffort alone = op->effort(cloud);
  effort = {alone.seconds / demand.threads, alone.cause, alone.text, alone.remedy};
  demand.in_order_bytes = op->least_bytes(cloud);
  if (!op->other_cloud().empty())
    demand.in_order_bytes += OtherCloud::working_bytes(demand.threads, bytes_of(op->other_reads()));
}

/// Adds the memory of a spanning forest: for the points of a bucket (a range along the axis, kBucketPoints), for the
/// points that have neighbours in later buckets, and for the edges that a thread uses at a time.
void add_forest(MemoryDemand& demand, const PlannedPass& pass, Estimates& estimates) {
  const Stage* stage = pass.connecting_stage();
  if (stage == nullptr) return;
  const std::size_t k = pass.plan.neighborhood.k;
  const std::uint64_t open = k == Neighborhood::kUnlimited ? demand.slice_points : estimates.open_points(k);
  const bool weighted = stage->connects()->weighted();
  const std::uint64_t votes = stage->connects()->votes() != nullptr ? stage->connects()->votes()->bytes() : 0;
  demand.connect_bytes = (open + std::min(demand.points, kBucketPoints)) * (votes + (weighted ? 450 : 150));
  demand.listed_edge_bytes = EdgeEmitter::bytes_per_neighbor(weighted);
}

MemoryPlan plan(std::uint64_t budget, const SweepPlan& sweep, const MemoryDemand& demand,
                const EngineOptions& options) {
  MemoryPlan memory = plan_memory(budget, sweep, demand);
  if (options.ordering == Ordering::on_demand && demand.waiting_points) {
    memory.on_demand = true;
    memory.spill_stream = false;
    memory.spill_results |= options.spill;
    memory.result_buffer_bytes = std::max<std::uint64_t>(memory.result_buffer_bytes, 1 << 20);
    memory.most_waiting = std::numeric_limits<std::uint64_t>::max();
    return memory;
  }
  if (options.spill || !options.resume_folder.empty()) {
    memory.spill_stream = memory.spill_results = true;
    memory.result_buffer_bytes = std::max<std::uint64_t>(memory.result_buffer_bytes, 1 << 20);
  }
  return memory;
}

/// Returns the number of points that would wait in memory for their slabs, according to the boxes of the inputs; none
/// if slabs on demand are impossible.
std::optional<std::uint64_t> waiting_points(const OnDemandOrder& order, const Survey& survey,
                                            const MemoryDemand& demand) {
  if (!order.why_not.empty()) return {};
  return estimate_waiting(order.boxes, survey.axis, survey.sample, demand.points, demand.slab_points, demand.threads);
}

/// Describes how the points of the first pass that orders points are put in order, and why.
std::string order_text(const MemoryPlan& memory, const OnDemandOrder& order, const MemoryDemand& demand) {
  if (!memory.on_demand && !memory.spill_stream) return "by distribution, in memory";
  if (!memory.on_demand && !order.why_not.empty()) return "by distribution: " + order.why_not;
  const std::string waiting = fmt::format("about {} points ({:.1f} MB)", demand.waiting_points.value_or(0),
                                          megabytes(demand.waiting_points.value_or(0) * demand.working_record_bytes));
  if (memory.on_demand)
    return fmt::format("by the boxes of the inputs: at most {} wait in memory; nothing is spilled for it", waiting);
  return fmt::format("by distribution: by the boxes of the inputs {} would have to wait in memory", waiting);
}

/// Returns the plan of a sweep without stages, for points that are only put in order.
SweepPlan unswept(std::uint32_t result_bytes) {
  SweepPlan none;
  none.steps = {0, 0};
  none.result_bytes = result_bytes;
  return none;
}

/// Returns the memory plan of a pass that reads rows in their order, some at a time (ParallelRows in order/source.h).
MemoryPlan plan_rows(std::uint64_t budget, std::uint64_t codec_bytes) {
  MemoryPlan memory;
  memory.expected_bytes = kFixedBytes + codec_bytes;
  if (memory.expected_bytes > budget) memory.needed_bytes = memory.expected_bytes;
  return memory;
}

/// Returns the bytes of two masks of rows (RowMask): the mask of the previous select, and the mask that is being made.
/// 0 if no stage drops rows.
std::uint64_t mask_bytes(const ChainPlan& planned, std::uint64_t points) {
  return planned.selects() ? 2 * RowMask::bytes(points) : 0;
}

/// Plans like plan_run_memory(), for exactly the threads of the options. Does not throw for a budget that is too small:
/// see RunMemory::needed_bytes.
RunMemory plan_on_threads(std::uint64_t budget, const ChainPlan& planned, std::uint64_t points, Estimates& estimates,
                          const EngineOptions& options, std::uint64_t output_bytes, std::uint64_t codec_bytes,
                          const OnDemandOrder& on_demand) {
  const Survey& survey = estimates.survey();
  RunMemory memory;
  memory.threads = threads_asked_for(options);
  memory.ordered_pass = first_ordered_pass(planned);
  for (const PlannedPass& pass : planned.passes) {
    if (pass.kind == PassKind::rows) {
      memory.efforts.emplace_back();
      memory.record_bytes.push_back(pass.input.stride);
      memory.passes.push_back(plan_rows(budget, codec_bytes));
      memory.expected_bytes = std::max(memory.expected_bytes, memory.passes.back().expected_bytes);
      continue;
    }
    SweepPlan stages = pass.plan;
    if (pass.kind == PassKind::order) stages = unswept(pass.plan.result_bytes);
    const bool whole = leaves_in_order(planned, options) && &pass == &planned.passes.back();
    MemoryDemand needs = demand(whole ? pass.input.stride : pass.travelling_bytes(),
                                whole ? output_bytes : stages.result_bytes, points, survey, options, codec_bytes);
    memory.efforts.push_back(add_radius(needs, stages, estimates));
    add_steps(needs, stages, budget, estimates);
    add_in_order(needs, pass, estimates, options, memory.efforts.back());
    add_forest(needs, pass, estimates);
    memory.record_bytes.push_back(needs.working_record_bytes);
    if (memory.passes.size() == memory.ordered_pass) {
      needs.waiting_points = waiting_points(on_demand, survey, needs);
      memory.passes.push_back(plan(budget, stages, needs, options));
      memory.order_text = order_text(memory.passes.back(), on_demand, needs);
      needs.waiting_points = {};
      if (memory.passes.back().on_demand) memory.by_distribution = plan(budget, stages, needs, options);
    } else {
      memory.passes.push_back(plan(budget, stages, needs, options));
    }
    memory.expected_bytes = std::max(memory.expected_bytes, memory.passes.back().expected_bytes);
  }
  if (planned.reorders) {
    const std::uint64_t position_bytes = planned.passes.empty() ? 0 : kMovedPositionBytes;
    const MemoryDemand needs = demand(output_bytes + position_bytes, 0, points, survey, options, codec_bytes);
    memory.reordering = plan(budget, unswept(0), needs, options);
    memory.expected_bytes = std::max(memory.expected_bytes, memory.reordering.expected_bytes);
  }
  memory.needed_bytes = memory.reordering.needed_bytes;
  for (const MemoryPlan& pass : memory.passes) memory.needed_bytes = std::max(memory.needed_bytes, pass.needed_bytes);
  memory.row_bytes = points * planned.most_carried_bytes() + mask_bytes(planned, points);
  memory.spill_rows = memory.row_bytes > 0 && (memory.spills() || memory.expected_bytes + memory.row_bytes > budget);
  if (memory.spill_rows) return memory;
  memory.expected_bytes += memory.row_bytes;
  for (MemoryPlan& pass : memory.passes) pass.in_order_bytes -= std::min(pass.in_order_bytes, memory.row_bytes);
  return memory;
}

/// Number of threads that work if they fit into the budget at all. More threads work only if they leave enough memory
/// for the window and the recall.
constexpr unsigned kThreadsInAnyCase = 2;
/// More than kThreadsInAnyCase threads together may use one part in kThreadsShare of the budget beyond kFixedBytes, if
/// points may be recalled. With a larger share the window would be so small that many points are recalled in small
/// groups, which costs more than the threads gain.
constexpr std::uint64_t kThreadsShare = 4;

bool is_enough(std::uint64_t budget, const RunMemory& memory) {
  if (memory.needed_bytes != 0) return false;
  const std::uint64_t most = (budget - std::min(budget, kFixedBytes)) / kThreadsShare;
  return memory.threads <= kThreadsInAnyCase ||
         std::ranges::all_of(memory.passes, [&](const MemoryPlan& pass) { return pass.threads_bytes <= most; });
}

/// Returns the least number for which is_enough() holds, by bisection between `no`, which is too small, and `yes`,
/// which is enough.
template <class IsEnough>
std::uint64_t least(std::uint64_t no, std::uint64_t yes, const IsEnough& is_enough) {
  while (yes - no > 1) {
    const std::uint64_t middle = no + (yes - no) / 2;
    (is_enough(middle) ? yes : no) = middle;
  }
  return yes;
}

}  // namespace

bool RunMemory::spills() const {
  if (by_distribution && !in_memory(*by_distribution)) return true;
  return spill_rows || !in_memory(reordering) || !std::ranges::all_of(passes, in_memory);
}

RunMemory plan_run_memory(std::uint64_t budget, const ChainPlan& planned, std::uint64_t points, const Survey& survey,
                          const EngineOptions& options, std::uint64_t output_bytes, const CodecBytes& codecs,
                          const OnDemandOrder& on_demand) {
  Estimates estimates(survey, points);
  const auto plan_for = [&](std::uint64_t bytes, std::uint64_t threads) {
    EngineOptions fewer = options;
    fewer.resources.threads = static_cast<unsigned>(threads);
    return plan_on_threads(bytes, planned, points, estimates, fewer, output_bytes,
                           codecs ? codecs(fewer.resources.threads) : 0, on_demand);
  };
  const unsigned asked = threads_asked_for(options);
  RunMemory all = plan_for(budget, asked);
  if (is_enough(budget, all)) return all;
  const std::uint64_t too_many =
      least(0, asked, [&](std::uint64_t threads) { return !is_enough(budget, plan_for(budget, threads)); });
  if (too_many == 1) fail_budget(budget, asked == 1 ? all.needed_bytes : plan_for(budget, 1).needed_bytes);
  RunMemory fitting = plan_for(budget, too_many - 1);
  const auto has_room_for_all = [&](std::uint64_t mega) { return is_enough(mega << 20, plan_for(mega << 20, asked)); };
  std::uint64_t enough = 2 * (budget >> 20) + 1;
  while (!has_room_for_all(enough)) enough *= 2;
  fitting.threads_note = fmt::format(
      "{} of {} threads work: a memory budget of {} MB has no room for more; --memory {}M has room for all.",
      fitting.threads, asked, budget >> 20, least(budget >> 20, enough, has_room_for_all));
  return fitting;
}

std::uint64_t open_input_bytes(const InputCloud& cloud) {
  constexpr std::size_t kInFixedBytes = 100;  // open inputs for which kFixedBytes has room
  constexpr std::uint64_t kInput = 4000;      // bytes of an open input, measured: reader, copies of the path, mapping
  constexpr std::uint64_t kRemoteService = 16 << 20;  // measured: certificates, connections, unread answers
  constexpr std::uint64_t kFacts = 1300;              // bytes of FileInfo, without its vectors and texts
  std::uint64_t bytes = 0;
  if (std::ranges::any_of(cloud.readers(), [](const auto& reader) { return is_url(reader->info().path); }))
    bytes += kRemoteCacheBytes + kRemoteService;
  for (std::size_t i = kInFixedBytes; i < cloud.readers().size(); ++i) {
    const FileInfo& info = cloud.readers()[i]->info();
    std::uint64_t held = info.schema.fields.size() * sizeof(Field);
    for (const std::string& line : info.provenance) held += sizeof line + line.size();
    if (info.crs) held += 2 * info.crs->wkt.size();
    // An input that is decoded once gets a second reader, which reads the decoded records and has another FileInfo.
    bytes += kInput + held + (info.decode_once ? kFacts + held : 0);
  }
  return bytes;
}

void require_room_for_inputs(std::uint64_t budget, std::uint64_t open_bytes, const InputCloud& cloud) {
  constexpr std::uint64_t kMega = 1 << 20;
  const std::uint64_t needed = kFixedBytes + open_bytes;
  if (open_bytes == 0 || needed <= budget) return;
  fail(
      "A memory budget of {} MB is too small for {} inputs, which take {} MB while they are open: give --memory {}M or "
      "more.",
      budget / kMega, cloud.readers().size(), open_bytes / kMega, (needed + kMega - 1) / kMega);
}

std::uint64_t codec_bytes(const InputCloud& cloud, const Outputs& outputs, const RunOptions& options,
                          std::uint64_t record_bytes, unsigned threads) {
  std::uint64_t decoders = 0;  // the most of any input, since a thread reads one input at a time
  for (const auto& reader : cloud.readers())
    if (!reader->info().decode_once)  // inputs that are decoded once are closed before the passes
      decoders = std::max(decoders, reader->info().decoder_bytes * (reader->has_decoders() ? threads : 1));
  const std::uint64_t division = options.division.divides() ? kLeastDivisionBytes : 0;
  return decoders + encoder_bytes(outputs, record_bytes, threads) + division;
}

std::uint64_t once_decoder_bytes(const InputCloud& cloud, unsigned threads) {
  std::uint64_t bytes = 0;
  for (const auto& reader : cloud.readers())
    if (reader->info().decode_once) bytes = std::max(bytes, reader->info().decoder_bytes * threads);
  return bytes;
}

unsigned survey_threads(const InputCloud& cloud, const EngineOptions& options) {
  // Bytes of a thread: its stack, which is not freed, and a block of rows.
  constexpr std::uint64_t kThreadBytes = 512 << 10;
  std::uint64_t decoder = 0;
  for (const auto& reader : cloud.readers())
    if (reader->has_decoders() && !reader->info().decode_once)
      decoder = std::max(decoder, reader->info().decoder_bytes);
  const std::uint64_t budget = memory_budget(options.resources.memory_bytes);
  const std::uint64_t bytes = budget - std::min(budget, kFixedBytes);
  const std::uint64_t room = std::min(bytes / (kThreadBytes + decoder), bytes / kThreadsShare / kThreadBytes);
  return static_cast<unsigned>(std::clamp<std::uint64_t>(room, 1, threads_asked_for(options)));
}

std::uint64_t encoder_bytes(const Outputs& outputs, std::uint64_t record_bytes, unsigned threads) {
  std::uint64_t most = 0;
  for (const OutputFormat& output : output_formats(outputs))
    if (output.format->encoder_bytes != nullptr)
      most = std::max(most, output.format->encoder_bytes(record_bytes, threads));
  return most;
}

std::uint64_t aside_bytes(const Outputs& outputs, std::uint64_t count, std::uint64_t record_bytes, std::uint64_t memory,
                          unsigned threads) {
  std::uint64_t most = 0;
  for (const OutputFormat& output : output_formats(outputs))
    if (output.format->aside_bytes != nullptr)
      most = std::max(most, output.format->aside_bytes(count, record_bytes, memory, threads));
  return most;
}

unsigned threads_asked_for(const EngineOptions& options) {
  return options.resources.threads != 0 ? options.resources.threads : std::max(1u, std::thread::hardware_concurrency());
}

bool leaves_in_order(const ChainPlan& planned, const EngineOptions& options) {
  return options.order == Order::sweep && !planned.reorders;
}

}  // namespace pointsweep
