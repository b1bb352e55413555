// SPDX-License-Identifier: MIT
/// Eigenvalues and eigenvectors of a symmetric matrix by Jacobi's rotations (C. G. J. Jacobi 1846; Golub and Van Loan,
/// "Matrix Computations", Section 8.5), which need no case distinctions. Not the closed form that the operators use.
#pragma once

#include "pointsweep/verify/formulas/vector.h"

namespace pointsweep::formulas {

/// value[i] belongs to the unit vector[i]; values ascend. The sign of each vector is arbitrary.
struct Eigen {
  std::array<Real, 3> value{};
  std::array<Vector, 3> vector{};
};

Eigen eigen_of(const Matrix& symmetric);

}  // namespace pointsweep::formulas
