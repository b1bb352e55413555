// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/set.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/program/declaration.h"
#include "pointsweep/program/pipeline.h"
#include "pointsweep/program/run_options.h"
#include "python/binding/bindings.h"
#include "python/binding/columns_of_arrays.h"
#include "python/binding/neighbor_arrays.h"
#include "python/binding/place_search.h"
#include "python/binding/python_operator.h"
#include "python/binding/python_threads.h"
#include "python/binding/radius_lists.h"
#include "python/binding/requests.h"
#include "python/binding/result_arrays.h"
#include "python/binding/watched_run.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace pointsweep {
namespace {

/// Runs the chain; returns the statistics as JSON.
std::string run_watched(Cloud& cloud, const PythonChain& chain, const Outputs& outputs, RunOptions options,
                        const Callbacks& callbacks) {
  std::string statistics;
  try {
    watch(callbacks, [&](Observer& observer) {
      PythonThreads threads;
      call_python_on(threads, chain.functions);
      options.observer = &observer;
      statistics = to_json(run(cloud, chain, outputs, options));
    });
  } catch (const Error&) {
    rethrow_python_exception(chain.functions);
    throw;
  }
  return statistics;
}

std::string run_into(ResultArrays& results, Cloud& cloud, const PythonChain& chain, const RunOptions& options,
                     const Callbacks& callbacks) {
  const Outputs outputs{.writer = [&](const OutputPlan& plan) { return results.writer(plan); }};
  return run_watched(cloud, chain, outputs, options, callbacks);
}

/// Returns the arrays that `chain.keep` names; if it is empty, the made attributes, or all attributes if
/// changes_rows(). Changes `chain.keep` to the fields that the run must write for these arrays; it stays empty if all
/// are needed.
WantedArrays wanted_arrays(Chain& chain, const RunOptions& options, std::vector<FieldGroup> groups) {
  WantedArrays wanted{std::move(groups), {chain.keep.begin(), chain.keep.end()}, false};
  if (!wanted.names.empty()) {
    std::erase(chain.keep, "xyz");  // positions always are in the records
    for (const auto& [name, fields] : wanted.groups)
      if (std::erase(chain.keep, name) > 0) chain.keep.insert(chain.keep.end(), fields.begin(), fields.end());
  } else if (changes_rows(chain, options)) {
    return wanted;
  } else {
    wanted.made_only = true;
    if (moves_points(chain)) return wanted;  // "x" would then mean the made position, and exclude other made attributes
  }
  chain.keep.push_back("x");  // excludes all attributes of the input that are not named
  return wanted;
}

nb::tuple run_pipeline(const nb::list& source, const nb::list& pipeline, const std::vector<std::string>& keep,
                       const nb::dict& given, const std::vector<FieldGroup>& groups, const nb::object& to,
                       const nb::dict& into, const nb::object& progress, const nb::object& warn) {
  const Callbacks callbacks{progress, warn};
  const RunOptions options = run_options(given);
  Cloud cloud = open_cloud(source, to.is_none(), given);
  PythonChain chain = chain_to_run(pipeline, facts_of(cloud.inputs()));
  chain.keep = keep;
  if (to.is_none()) {
    WantedArrays wanted = wanted_arrays(chain, options, groups);
    for (const auto [name, array] : into) {
      const auto known = nb::cast<std::string>(name);
      wanted.into[known] = borrow_writable(array, known);
    }
    ResultArrays results(std::move(wanted));
    const std::string statistics = run_into(results, cloud, chain, options, callbacks);
    return nb::make_tuple(results.arrays(), statistics);
  }
  Outputs outputs;
  if (nb::isinstance<nb::list>(to))
    outputs.tiles = nb::cast<std::vector<std::filesystem::path>>(to);
  else
    outputs.points = nb::cast<std::filesystem::path>(to);
  return nb::make_tuple(nb::none(), run_watched(cloud, chain, outputs, options, callbacks));
}

/// Returns a description of a run for people, without running it.
std::string plan(const nb::list& source, const nb::list& pipeline, const std::vector<std::string>& keep,
                 const nb::dict& given, const std::vector<FieldGroup>& groups, const std::filesystem::path& to) {
  const RunOptions options = run_options(given);
  Cloud cloud = open_cloud(source, to.empty(), given);
  PythonChain chain = chain_to_run(pipeline, facts_of(cloud.inputs()));
  chain.keep = keep;
  if (to.empty()) wanted_arrays(chain, options, groups);
  return plan_text(cloud, chain, {.points = to}, options);
}

/// Returns a text of each stage. Equal pipelines have equal texts.
std::vector<std::string> canonical(const nb::list& pipeline) {
  return canonical_stages(chain_of(pipeline, Facts{}), Presets::left_out);
}

/// Adds a stage at the beginning that drops points with NaN or infinite coordinates. Unlike Nonfinite::drop, it keeps
/// the numbers that the rows have in the input.
void leave_finite_points(Chain& chain) {
  const Chain finite = build_chain(parse_pipeline("where(x - x == 0 && y - y == 0 && z - z == 0)"), Facts{});
  chain.stages.insert(chain.stages.begin(), finite.stages.begin(), finite.stages.end());
}

/// Runs like run_pipeline(), with results in a temporary file. Returns (SpilledArrays, whether they include kRowField
/// because changes_rows(), statistics). `numbers`: for points in files, an operator of Python that makes kRowField;
/// else None.
nb::tuple run_to_blocks(const nb::list& source, const nb::list& pipeline, const std::vector<std::string>& keep,
                        const nb::dict& given, const std::vector<FieldGroup>& groups, const nb::object& numbers,
                        const nb::object& progress, const nb::object& warn) {
  RunOptions options = run_options(given);
  Cloud cloud = open_cloud(source, true, given);
  PythonChain chain = chain_to_run(pipeline, facts_of(cloud.inputs()));
  const bool changed = changes_rows(chain, options);
  chain.keep = keep;
  if (changed && !keep.empty()) chain.keep.emplace_back(kRowField);
  if (changed && !numbers.is_none()) {
    if (options.nonfinite == Nonfinite::drop) {
      leave_finite_points(chain);
      options.nonfinite = Nonfinite::keep;
    }
    chain.stages.insert(chain.stages.begin(), python_operator(numbers, chain.functions));
  }
  auto results = std::make_unique<ResultArrays>(wanted_arrays(chain, options, groups), options.resources.temp_folder);
  const std::string statistics = run_into(*results, cloud, chain, options, {progress, warn});
  return nb::make_tuple(nb::cast(std::move(results)), changed, statistics);
}

/// Writer that discards the records of a run, whose results an operator has stored.
class NoRecords final : public Writer {
 public:
  void write(std::span<const std::byte>) override {}
  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t, std::span<const std::byte>) override {}
  void finish() override {}
};

/// Passes the neighbours of the places in `queries`, N×3, to `take`. The places need not be points of the cloud.
void search_places(Cloud& cloud, const ArrayColumn& queries, std::optional<std::size_t> k, double radius,
                   const nb::dict& given, const Callbacks& callbacks, PlaceSearch::Take take) {
  const PythonChain chain{{.stages = {std::make_shared<PlaceSearch>(queries, k, radius, std::move(take))},
                           .keep = {"neighbor_queries", "x"}},
                          {}};
  const Outputs outputs{.writer = [](const OutputPlan&) { return std::make_unique<NoRecords>(); }};
  run_watched(cloud, chain, outputs, run_options(given), callbacks);
}

/// Finds the k nearest neighbours within the radius of the places `queries`, an N×3 array; if it is None, of each
/// point.
nb::tuple neighbors(const nb::list& source, const nb::object& queries, std::size_t k, double radius,
                    const nb::dict& given, const nb::object& progress, const nb::object& warn) {
  Cloud cloud = open_cloud(source, false, given);
  if (queries.is_none()) {
    NeighborArrays made(k, cloud.count());
    const PythonChain chain{
        {.neighborhood = {.k = k, .radius = radius}, .stages = {made.op()}, .keep = {"neighbor_count", "x"}}, {}};
    const Outputs outputs{.writer = [&](const OutputPlan& plan) { return made.writer(plan); }};
    run_watched(cloud, chain, outputs, run_options(given), {progress, warn});
    return made.arrays();
  }
  const ArrayColumn places = borrow_array(queries, {"x", "y", "z"});
  NeighborArrays made = NeighborArrays::of_places(k, places.rows, cloud.count());
  search_places(cloud, places, k, radius, given, {progress, warn}, [&](const PlaceLists& lists) { made.put(lists); });
  if (k > cloud.count() && !warn.is_none())
    warn(fmt::format("k = {} is more than the {} points there are: the lists hold all of them.", k, cloud.count())
             .c_str());
  return made.arrays();
}

/// Finds all neighbours within the radius of the places `queries`, an N×3 array; if it is None, of each point.
nb::tuple radius_neighbors(const nb::list& source, const nb::object& queries, double radius, const nb::dict& given,
                           const nb::object& progress, const nb::object& warn) {
  Cloud cloud = open_cloud(source, false, given);
  RadiusLists lists;
  if (queries.is_none()) {
    const PythonChain chain{{.neighborhood = {.k = Neighborhood::kUnlimited, .radius = radius},
                             .stages = {lists.op()},
                             .keep = {"neighbor_count", "x"}},
                            {}};
    ResultArrays counts({{}, {"neighbor_count"}, false});
    run_into(counts, cloud, chain, run_options(given), {progress, warn});
    return lists.arrays(counts.rows(), counts.rows());
  }
  const ArrayColumn places = borrow_array(queries, {"x", "y", "z"});
  search_places(cloud, places, {}, radius, given, {progress, warn}, [&](const PlaceLists& found) { lists.put(found); });
  return lists.arrays(places.rows, cloud.count());
}

}  // namespace

void bind_runs(nb::module_& module) {
  module.attr("default_neighbors") = std::get<std::uint64_t>(neighbor_rows_declaration().options.front().preset);
  nb::dict options;
  for (const RunOption& option : run_options())
    options[option.name.c_str()] = nb::make_tuple(option.value, nb::cast(option.words), option.flag);
  module.attr("run_options") = options;
  module.def("run", &run_pipeline, "source"_a, "pipeline"_a, "keep"_a, "options"_a, "groups"_a, "to"_a.none(), "into"_a,
             "progress"_a.none(), "warn"_a.none());
  module.def("plan", &plan, "source"_a, "pipeline"_a, "keep"_a, "options"_a, "groups"_a, "to"_a);
  module.def("canonical_stages", &canonical, "pipeline"_a);
  nb::class_<ResultArrays>(module, "SpilledArrays")
      .def("__len__", &ResultArrays::rows)
      .def("read", &ResultArrays::read, "first"_a, "rows"_a);
  module.def("run_to_blocks", &run_to_blocks, "source"_a, "pipeline"_a, "keep"_a, "options"_a, "groups"_a,
             "numbers"_a.none(), "progress"_a.none(), "warn"_a.none());
  module.def("neighbors", &neighbors, "source"_a, "queries"_a.none(), "k"_a, "radius"_a, "options"_a,
             "progress"_a.none(), "warn"_a.none());
  module.def("radius_neighbors", &radius_neighbors, "source"_a, "queries"_a.none(), "radius"_a, "options"_a,
             "progress"_a.none(), "warn"_a.none());
}

}  // namespace pointsweep
