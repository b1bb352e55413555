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

/// The operator that `op`, a pointsweep.Operator, describes.
std::shared_ptr<const Operator> python_operator(nanobind::handle op);

/// Throws the exception that an operator of Python in `chain` has raised, if one has.
void rethrow_python_exception(const Chain& chain);

}  // namespace pointsweep
