// SPDX-License-Identifier: MIT
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/pipeline/available_memory.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/run/part_run.h"
#include "pointsweep/program/process.h"
#include "pointsweep/storage/local/folder_storage.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "python/binding/bindings.h"
#include "python/binding/python_threads.h"
#include "python/binding/requests.h"
#include "python/binding/watched_run.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace pointsweep {
namespace {

const std::array<std::string, 10> kRoundNames{"look",  "other", "order", "sweep", "forest",
                                              "label", "rows",  "write", "cut",   "gather"};
const std::array<std::string, 6> kJoinNames{"", "tiles", "borders", "components", "values", "pieces"};

/// The arguments that all tasks of a run share. `shared`: (source, pipeline, keep, options, outputs, facts), of which
/// the first four are those of run_pipeline() in runs.cpp. The outputs are a path for each input, or one pattern for
/// the names of the files among which the output is divided. The facts of the whole cloud are (points, metres per
/// unit), or None where they are those of `source`.
struct PartRequest {
  explicit PartRequest(const nb::tuple& shared)
      : options(run_options(nb::cast<nb::dict>(shared[3]))),
        cloud(open_cloud(nb::cast<nb::list>(shared[0]), false, nb::cast<nb::dict>(shared[3]))),
        facts(facts_of(cloud.inputs())) {
    if (const nb::object known = shared[5]; !known.is_none()) {
      facts.points = nb::cast<std::uint64_t>(known[0]);
      facts.metres_per_unit = nb::cast<double>(known[1]);
    }
    chain = chain_to_run(nb::cast<nb::list>(shared[1]), facts);
    chain.keep = nb::cast<std::vector<std::string>>(shared[2]);
    auto to = nb::cast<std::vector<std::filesystem::path>>(shared[4]);
    if (options.division.divides())
      outputs.points = to.front();
    else
      outputs.tiles = std::move(to);
  }

  SharedRequest shared() { return {cloud.inputs(), chain, outputs, options}; }

  EngineOptions options;
  Cloud cloud;
  Facts facts;
  PythonChain chain;
  Outputs outputs;
};

template <class Enum>
Enum named(const auto& names, const std::string& name) {
  return static_cast<Enum>(std::ranges::find(names, name) - names.begin());
}

PartRound round_of(const nb::tuple& given) {
  PartRound round;
  for (const nb::handle step : nb::cast<nb::list>(given[0]))
    round.steps.push_back(
        {named<PartRoundKind>(kRoundNames, nb::cast<std::string>(step[0])), nb::cast<std::size_t>(step[1])});
  round.join = named<PartJoin>(kJoinNames, nb::cast<std::string>(given[1]));
  return round;
}

nb::tuple tuple_of(const PartRound& round) {
  nb::list steps;
  for (const PartStep& step : round.steps)
    steps.append(nb::make_tuple(kRoundNames[static_cast<std::size_t>(step.kind)], step.pass));
  return nb::make_tuple(steps, kJoinNames[static_cast<std::size_t>(round.join)]);
}

/// Calls work() on another thread, so that other threads of Python run meanwhile and Ctrl-C is handled. Reports the
/// progress to the function `progress`, if it is not None.
void call_watched(PartRequest& request, const std::function<void()>& work, const nb::object& progress = nb::none()) {
  try {
    watch({progress, nb::none()}, [&](Observer& observer) {
      PythonThreads threads;
      call_python_on(threads, request.chain.functions);
      request.options.observer = &observer;
      work();
    });
  } catch (const Error&) {
    rethrow_python_exception(request.chain.functions);
    throw;
  }
}

/// Returns (rounds, number of rows of each tile or range, the option `nonfinite` for the tasks, notes, most bytes of a
/// point in the scratch, files of other clouds by pass, stages for the record, facts). A round: (steps, kind of the
/// join). A step: (kind, pass). Files: (paths, points of each).
nb::tuple planned_parts(const nb::tuple& shared) {
  PartRequest request(shared);
  PartPlan planned;
  call_watched(request, [&] { planned = plan_parts(request.shared()); });
  nb::list rounds;
  for (const PartRound& round : planned.rounds) rounds.append(tuple_of(round));
  nb::dict others;
  for (const OtherFiles& files : planned.others)
    others[nb::int_(files.pass)] = nb::make_tuple(files.paths, files.counts);
  constexpr std::array<const char*, 4> kRules{"", "keep", "drop", "refuse"};
  return nb::make_tuple(rounds, planned.rows, kRules[static_cast<std::size_t>(planned.nonfinite)], planned.notes,
                        planned.scratch_bytes, others, planned.record,
                        nb::make_tuple(request.facts.points, request.facts.metres_per_unit));
}

/// Performs a task. Returns the members of PartDone: (rows, own_points, swept_points, statistics as JSON).
nb::tuple perform(const std::filesystem::path& scratch, const nb::tuple& shared, const nb::dict& task,
                  const nb::object& progress) {
  PartRequest request(shared);
  const auto text = [&](const char* name) { return nb::cast<std::string>(task[name]); };
  const auto number = [&](const char* name) { return nb::cast<std::uint64_t>(task[name]); };
  const PartTask wanted{.round = round_of(nb::cast<nb::tuple>(task["round"])),
                        .tile = number("tile"),
                        .tiles = number("tiles"),
                        .first_row = number("first_row"),
                        .rows = number("rows"),
                        .dropped = number("dropped"),
                        .before = text("before"),
                        .catalogue = text("catalogue"),
                        .values = text("values"),
                        .borders = text("borders"),
                        .components = text("components"),
                        .pieces = text("pieces"),
                        .other_catalogue = text("other_catalogue"),
                        .other_file = text("other_file"),
                        .record = nb::cast<std::vector<std::string>>(task["record"]),
                        .after = text("after")};
  const std::unique_ptr<Storage> place = shared_storage(scratch);
  PartDone done;
  reuse_free_memory();
  call_watched(
      request, [&] { done = run_part(request.shared(), wanted, *place); }, progress);
  return nb::make_tuple(done.rows, done.own_points, done.swept_points, to_json(done.statistics));
}

void join_the_tiles(const std::filesystem::path& scratch, const std::vector<std::string>& left,
                    const std::vector<std::string>& paths, const std::string& key) {
  const std::unique_ptr<Storage> place = shared_storage(scratch);
  const Detached others_go_on;
  join_tiles(*place, left, paths, key);
}

void join_the_values(const std::filesystem::path& scratch, const nb::tuple& shared, const nb::tuple& round,
                     const std::string& before, const std::vector<std::string>& left, const std::string& key) {
  PartRequest request(shared);
  const std::unique_ptr<Storage> place = shared_storage(scratch);
  const PartRound of = round_of(round);
  call_watched(request, [&] { join_values(request.shared(), of, *place, before, left, key); });
}

void join_the_graph(const std::filesystem::path& scratch, const nb::tuple& shared, const nb::tuple& round,
                    const std::string& catalogue, const std::string& borders, const std::vector<std::string>& left,
                    const std::string& key) {
  PartRequest request(shared);
  const std::unique_ptr<Storage> place = shared_storage(scratch);
  const PartRound of = round_of(round);
  call_watched(request, [&] { join_graph(request.shared(), of, *place, {catalogue, borders}, left, key); });
}

void join_the_pieces(const std::filesystem::path& scratch, const nb::tuple& shared,
                     const std::vector<std::string>& left, const std::string& key) {
  PartRequest request(shared);
  const std::unique_ptr<Storage> place = shared_storage(scratch);
  call_watched(request, [&] { join_pieces(request.shared(), *place, left, key); });
}

/// Removes incomplete files of the outputs that killed workers have left. Lists each folder once.
void remove_abandoned(const std::vector<std::filesystem::path>& outputs) {
  const Detached others_go_on;
  const ManyOutputs listed(outputs.size(), [&](std::size_t i) { return outputs[i]; });
}

void forget_task(const std::filesystem::path& scratch, const std::string& left) {
  const std::unique_ptr<Storage> place = shared_storage(scratch);
  const Detached others_go_on;
  forget(*place, left);
}

}  // namespace

void bind_parts(nb::module_& module) {
  module.def("plan_parts", &planned_parts, "shared"_a);
  module.def("perform_part", &perform, "scratch"_a, "shared"_a, "task"_a, "progress"_a.none());
  module.def("join_tiles", &join_the_tiles, "scratch"_a, "left"_a, "paths"_a, "key"_a);
  module.def("join_values", &join_the_values, "scratch"_a, "shared"_a, "round"_a, "before"_a, "left"_a, "key"_a);
  module.def("join_graph", &join_the_graph, "scratch"_a, "shared"_a, "round"_a, "catalogue"_a, "borders"_a, "left"_a,
             "key"_a);
  module.def("join_pieces", &join_the_pieces, "scratch"_a, "shared"_a, "left"_a, "key"_a);
  module.def("with_absolute_files", &with_absolute_files, "pipeline"_a);
  nb::list left;
  for (const char* const end : kLeftByTasks) left.append(end);
  module.attr("left_by_tasks") = nb::tuple(left);
  module.def("remove_abandoned", &remove_abandoned, "outputs"_a);
  module.def("forget_part", &forget_task, "scratch"_a, "left"_a);
  module.def("available_memory", [] { return available_memory(); });
}

}  // namespace pointsweep
