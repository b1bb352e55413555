// SPDX-License-Identifier: MIT
/// Converts requests of the Python layer to the types of the library.
#pragma once

#include <nanobind/nanobind.h>

#include "pointsweep/chain.h"
#include "pointsweep/cloud.h"
#include "pointsweep/program/declaration.h"
#include "pointsweep/run.h"
#include "python/binding/python_operator.h"

namespace pointsweep {

/// A chain, and the functions that its operators of Python call.
struct PythonChain : Chain {
  PythonFunctions functions = {};
};

/// Opens a cloud. `source`: a list of paths, or of pairs (names, N×m array). `with_rows`: clouds of arrays get the
/// field kRowField. `options` has the keys ignore_crs, format and crs, and, if crs is not None, replace_crs. Throws the
/// errors of Cloud and of borrow_array().
Cloud open_cloud(const nanobind::list& source, bool with_rows, const nanobind::dict& options);

/// Builds the chain for the cloud of `facts`. `pipeline`: a list of texts and of operators of Python. Throws the errors
/// of parse_chain().
PythonChain chain_of(const nanobind::list& pipeline, const Facts& facts);
/// Builds a chain that is run: throws UsageError for a pipeline with only knn. An empty pipeline copies the points.
PythonChain chain_to_run(const nanobind::list& pipeline, const Facts& facts);

/// Returns whether the rows of the output may differ from the rows of the input: rows may be left out, or the order may
/// differ.
bool changes_rows(const Chain& chain, const RunOptions& options);

/// Returns whether a stage makes positions.
bool moves_points(const Chain& chain);

/// Converts the options of a run, whose values in `options` are texts. An absent option or an empty text means the
/// default; other keys are ignored.
RunOptions run_options(const nanobind::dict& options);

}  // namespace pointsweep
