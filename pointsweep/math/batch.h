// SPDX-License-Identifier: MIT
/// Eigenvectors, exponentials and logarithms of many arguments at once, in the widest vector lanes of the machine.
/// Every result has the bits of eigen_symmetric3(), exp_negative() and natural_logarithm(), on any machine and in any
/// batch.
#pragma once

#include <span>

#include "pointsweep/math/symmetric3.h"

namespace pointsweep {

/// Computes out[i] = eigen_symmetric3(matrices[i]); both spans have the same size. About 35 to 60 ns per matrix on one
/// core with AVX-512.
void batch_eigen_symmetric3(std::span<const Symmetric3> matrices, std::span<Eigen3> out);

/// Computes out[i] = exp_negative(x[i]); both spans have the same size and may be the same span. About 1 ns per number
/// with AVX-512.
void batch_exp_negative(std::span<const double> x, std::span<double> out);

/// Computes out[i] = natural_logarithm(x[i]); both spans have the same size and may be the same span.
void batch_natural_logarithm(std::span<const double> x, std::span<double> out);

}  // namespace pointsweep
