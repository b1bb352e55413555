// SPDX-License-Identifier: MIT
/// Exceptions of the library as those of the package.
#pragma once

namespace pointsweep {

/// Error and UsageError become the classes of those names in pointsweep._errors.
void translate_errors();

}  // namespace pointsweep
