// SPDX-License-Identifier: MIT
/// Translation of the library's exceptions to the exceptions of the package.
#pragma once

namespace pointsweep {

/// Translates Error and UsageError to the classes of these names in pointsweep._errors.
void translate_errors();

}  // namespace pointsweep
