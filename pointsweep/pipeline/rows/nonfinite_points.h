// SPDX-License-Identifier: MIT
/// Points without a finite place: they are in no slab and are neighbours of no point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/order/stream.h"

namespace pointsweep {

/// Calls `use` for the nonfinite points of the stream in ascending row: with the number of the first of some, and with
/// their working records.
void for_each_nonfinite(const Stream& stream,
                        const std::function<void(std::uint64_t first, std::span<const std::byte> records)>& use);

/// Returns the rows of `records`, working records of the stream.
std::vector<std::uint64_t> rows_of_records(const Stream& stream, std::span<const std::byte> records);

/// Numbers of the first of these rows, ascending, at most `most`.
std::vector<std::uint64_t> first_nonfinite_rows(const Stream& stream, std::size_t most);

}  // namespace pointsweep
