// SPDX-License-Identifier: MIT
/// The points of an InputCloud as a source for streams.
#pragma once

#include <cstddef>
#include <functional>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/order/source.h"

namespace pointsweep {

/// Returns the points of `cloud`, which must outlive the source. Calls `note` with the number of rows after each
/// reading, from any thread.
PointSource source_of(InputCloud& cloud, const std::function<void(std::size_t rows)>& note);

}  // namespace pointsweep
