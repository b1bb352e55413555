// SPDX-License-Identifier: MIT
/// Numbers and lists as people write and read them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/export.h"
#include "pointsweep/geometry.h"

namespace pointsweep {

/// Parses "800000000B", "256M", "1.5GB", "4GiB" as bytes: K M G T are powers of 1024 followed by B, iB or nothing, in
/// either case. Throws UsageError beginning with `option`, also for 0 and if the unit is missing.
POINTSWEEP_EXPORT std::uint64_t parse_size(std::string_view option, std::string_view text);
/// Parses "8", "20000000", "20M" as a whole number: K M G T are powers of 1000. Throws UsageError beginning with
/// `option`.
POINTSWEEP_EXPORT std::uint64_t parse_count(std::string_view option, std::string_view text);
/// Parses "X,Y,Z". Throws UsageError beginning with `option`.
POINTSWEEP_EXPORT Vec3 parse_vector(std::string_view option, std::string_view text);
/// Parses "A,B,..." as names, none of them empty. Throws UsageError beginning with `option`.
POINTSWEEP_EXPORT std::vector<std::string> parse_names(std::string_view option, const std::string& text);

/// Returns a text like "3.50G": about three digits and a power of 1024.
POINTSWEEP_EXPORT std::string size_text(std::uint64_t bytes);
/// Returns a text like "12.3M": three digits and a power of 1000; below 10,000 the rounded number.
POINTSWEEP_EXPORT std::string count_text(double count);
/// Returns "1,772": all digits, in groups of three.
POINTSWEEP_EXPORT std::string grouped_text(std::uint64_t count);
/// Returns a text like "1:02:03" or "0:07".
POINTSWEEP_EXPORT std::string duration_text(double seconds);

}  // namespace pointsweep
