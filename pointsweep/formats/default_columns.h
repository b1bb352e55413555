// SPDX-License-Identifier: MIT
/// Names for columns that have none.
#pragma once

#include <string>
#include <vector>

namespace pointsweep {

/// From the number of columns, which are at least three, and the values of the first rows, each of so many values:
/// 3: x y z;  4: x y z intensity;  6: x y z and a normal or colour;  7: x y z intensity and a colour;
/// 9: x y z, a colour and a normal;  else x y z column_4 column_5 ...
/// A normal has length 1 or 0, a colour integers in 0..255.
std::vector<std::string> default_column_names(const std::vector<std::vector<double>>& rows);

}  // namespace pointsweep
