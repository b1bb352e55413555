// SPDX-License-Identifier: MIT
/// Operators that call functions written in Python.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <vector>

#include "pointsweep/chain.h"

namespace pointsweep {

class PythonFunction;
class PythonThreads;

/// The Python functions that a chain calls, one for each of its operators of Python.
using PythonFunctions = std::vector<std::shared_ptr<PythonFunction>>;

/// Returns the stage that `op`, a pointsweep.Operator, describes: a SelectOperator if `op` makes no attribute. Appends
/// the function of `op` to `functions`.
ChainStage python_operator(nanobind::handle op, PythonFunctions& functions);

/// Makes the run call the functions on `threads`, which must outlive the run.
void call_python_on(PythonThreads& threads, const PythonFunctions& functions);

/// Throws the exception that a function has raised, if one has.
void rethrow_python_exception(const PythonFunctions& functions);

}  // namespace pointsweep
