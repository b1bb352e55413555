// SPDX-License-Identifier: MIT
/// Facts about files in words.
#include <fmt/format.h>

#include "pointsweep/formats/las_classes.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/info.h"

namespace pointsweep {

std::vector<std::string> made_by(const FileInfo& info) {
  std::vector<std::string> lines;
  for (const ProvenanceRecord& record : records_of(info.provenance)) lines.push_back(to_text(record));
  return lines;
}

std::string text_of_class(std::uint8_t code) { return fmt::format("{} {}", code, name_of_las_class(code)); }

}  // namespace pointsweep
