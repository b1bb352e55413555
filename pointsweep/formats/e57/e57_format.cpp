// SPDX-License-Identifier: MIT
#include "pointsweep/formats/e57/e57_format.h"

#include "pointsweep/formats/e57/e57_columns.h"
#include "pointsweep/formats/e57/e57_file.h"
#include "pointsweep/formats/format.h"

namespace pointsweep {
namespace {

constexpr std::string_view kE57Extensions[] = {".e57"};

bool starts_as_e57(std::string_view head) { return head.starts_with("ASTM-E57"); }

/// Returns 0 for the number of the scan and the invalid state, since an output is one scan; nothing for other names.
std::optional<double> own_field(std::string_view name) {
  if (name == "scan" || name == "invalid_state") return 0;
  return std::nullopt;
}

}  // namespace

const Format kE57Format = {.name = "E57",
                           .title = "E57",
                           .details = "#e57",
                           .reads = "all scans as one cloud, poses applied",
                           .writes = "one scan",
                           .extensions = kE57Extensions,
                           .codec = "E57",
                           .has_codec = has_e57,
                           .is = starts_as_e57,
                           .open = open_e57,
                           .create = create_e57_writer,
                           .holds_crs = true,
                           .holds_provenance = true,
                           .encoder_bytes = e57_encoder_bytes,
                           .name_bytes = 252,
                           .stored_name = e57_name,
                           .own_field = own_field};

}  // namespace pointsweep
