// SPDX-License-Identifier: MIT
/// Operators that are functions of Python.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operator.h"

namespace pointsweep {

class PythonThreads;

/// The operator that `op`, a pointsweep.Operator, describes.
std::shared_ptr<const Operator> python_operator(nanobind::handle op);

/// The operators of Python in `chain` call their functions on `threads`, which outlives the run.
void call_python_on(PythonThreads& threads, const Chain& chain);

/// Throws the exception that an operator of Python in `chain` has raised, if one has.
void rethrow_python_exception(const Chain& chain);

}  // namespace pointsweep
