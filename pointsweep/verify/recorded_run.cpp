// SPDX-License-Identifier: MIT
/// The run that the processing record of a file describes, and the present places of its inputs.
#include <cstdint>

#include "pointsweep/fail.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/place.h"
#include "pointsweep/storage/remote/url.h"
#include "pointsweep/verify/checked_stages.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

fs::path found_input(const ProvenanceInput& input, const fs::path& file) {
  const fs::path name = file_name(input.name);
  const bool is_whole = fs::path(input.name).is_absolute() || is_url(input.name);
  std::optional<fs::path> other;  // a file with the right name but another size
  std::uint64_t other_bytes = 0;
  for (const fs::path& place : {is_whole ? fs::path(input.name) : fs::path(), file.parent_path() / name, name}) {
    const std::optional<std::uint64_t> bytes = place.empty() ? std::nullopt : bytes_of_file(place);
    if (!bytes) continue;
    if (*bytes == input.bytes) return place;
    other = place;
    other_bytes = *bytes;
  }
  if (other)
    fail("{}: has changed since {} was made from it: it had {} bytes and has {}; name the inputs as well.",
         other->string(), file.string(), input.bytes, other_bytes);
  fail("{}: was made from '{}', which is neither in its folder nor in this one; name the inputs as well.",
       file.string(), input.name);
}

}  // namespace

std::optional<ProvenanceRecord> recorded_run(const fs::path& file) {
  if (is_array_name(file)) return std::nullopt;
  std::vector<ProvenanceRecord> records = records_of(open_reader(file)->info().provenance);
  if (records.empty() || records.back().stages.empty()) return std::nullopt;
  return std::move(records.back());
}

std::vector<fs::path> recorded_inputs(const ProvenanceRecord& record, const fs::path& file) {
  if (record.more_inputs > 0 || record.inputs.empty())
    fail_usage("{}: does not name all the files it was made from; name the inputs as well.", file.string());
  std::vector<fs::path> inputs;
  for (const ProvenanceInput& input : record.inputs) inputs.push_back(found_input(input, file));
  return inputs;
}

}  // namespace pointsweep
