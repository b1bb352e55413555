// SPDX-License-Identifier: MIT
#include "python/binding/requests.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <utility>

#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/program/pipeline.h"
#include "pointsweep/program/run_options.h"
#include "pointsweep/url.h"
#include "python/binding/columns_of_arrays.h"
#include "python/binding/crs_values.h"
#include "python/binding/python_threads.h"

namespace nb = nanobind;

namespace pointsweep {
namespace {

template <class T>
T option(const nb::dict& options, const char* name) {
  return nb::cast<T>(options[name]);
}

bool is_path(nb::handle item) { return nb::isinstance<nb::str>(item); }

}  // namespace

Cloud open_cloud(const nb::list& source, bool with_rows, const nb::dict& options) {
  CloudOptions how{.ignore_crs = option<bool>(options, "ignore_crs"), .format = option<std::string>(options, "format")};
  if (is_path(source[0])) {
    const nb::object crs = options["crs"];
    if (!crs.is_none()) {
      const bool is_none = nb::isinstance<nb::str>(crs);
      how.crs = StatedCrs{is_none ? std::nullopt : crs_from(crs), option<bool>(options, "replace_crs")};
    }
    const auto files = nb::cast<std::vector<std::filesystem::path>>(source);
    const Detached others_go_on;  // a server may answer slowly
    return Cloud(files, how);
  }
  std::vector<ArrayColumn> columns;
  for (const nb::handle pair : source)
    columns.push_back(borrow_array(pair[1], nb::cast<std::vector<std::string>>(pair[0])));
  return Cloud(std::make_unique<ColumnsOfArrays>(std::move(columns), with_rows, crs_from(options["crs"])), how);
}

PythonChain chain_of(const nb::list& pipeline, const Facts& facts) {
  PythonChain chain;
  bool may_begin = true;  // knn must precede all stages that read neighbours
  for (const nb::handle item : pipeline) {
    if (!nb::isinstance<nb::str>(item)) {
      chain.stages.push_back(python_operator(item, chain.functions));
      may_begin = may_begin && !nb::cast<bool>(item.attr("sees_neighbors"));
      continue;
    }
    const std::vector<StageText> stages = parse_pipeline(with_known_places(nb::cast<std::string>(item)));
    if (may_begin) {
      const Chain rest = build_chain(stages, facts);
      chain.neighborhood = rest.neighborhood;
      chain.stages.insert(chain.stages.end(), rest.stages.begin(), rest.stages.end());
    } else {
      append_to(chain, stages, facts);
    }
    may_begin = false;
  }
  return chain;
}

PythonChain chain_to_run(const nb::list& pipeline, const Facts& facts) {
  PythonChain chain = chain_of(pipeline, facts);
  if (pipeline.size() > 0) require_operators(chain);
  return chain;
}

bool changes_rows(const Chain& chain, const RunOptions& options) {
  if (options.order != Order::input || options.nonfinite == Nonfinite::drop) return true;
  return std::ranges::any_of(chain.stages, [](const ChainStage& stage) { return drops_rows(stage); });
}

bool moves_points(const Chain& chain) {
  return std::ranges::any_of(chain.stages, [](const ChainStage& stage) {
    // An assignment to x, y or z becomes an assignment to a part of the position when it is bound to a cloud. Until
    // then its attribute is a coordinate.
    const auto is_coordinate = [](const std::string& field) { return field == "x" || field == "y" || field == "z"; };
    return std::ranges::any_of(contract_of(stage).makes,
                               [&](const Attribute& made) { return std::ranges::any_of(made.fields, is_coordinate); });
  });
}

RunOptions run_options(const nb::dict& given) {
  RunOptions options;
  for (const RunOption& declared : run_options()) {
    const char* const name = declared.name.c_str();
    // A path instead of a text, since paths may contain bytes that are not UTF-8.
    const std::string text = given.contains(name) ? option<std::filesystem::path>(given, name).string() : "";
    if (!text.empty()) declared.set(options, text, declared.name);
  }
  return options;
}

}  // namespace pointsweep
