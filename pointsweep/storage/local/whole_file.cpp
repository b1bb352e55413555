// SPDX-License-Identifier: MIT
#include "pointsweep/program/whole_file.h"

#include "pointsweep/storage/local/output_file.h"

namespace pointsweep {

WholeFile::WholeFile(const std::filesystem::path& destination, bool overwrite)
    : file_(std::make_unique<OutputFile>(destination, overwrite)) {}

WholeFile::~WholeFile() = default;

void WholeFile::complete(std::span<const std::byte> content) {
  file_->append(content);
  file_->seal();
}

void WholeFile::complete(std::string_view content) { complete(std::as_bytes(std::span(content))); }

}  // namespace pointsweep
