// SPDX-License-Identifier: MIT
/// The run that made a file, as the file itself says, and where its inputs are now.
#include <system_error>

#include "pointsweep/fail.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/reader.h"
#include "pointsweep/verify/checked_stages.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

fs::path found_input(const ProvenanceInput& input, const fs::path& file) {
  const fs::path name = fs::path(input.name).filename();
  std::error_code error;
  std::optional<fs::path> other;  // of the name, but not of the size
  for (const fs::path& place :
       {fs::path(input.name).is_absolute() ? fs::path(input.name) : fs::path(), file.parent_path() / name, name}) {
    if (place.empty() || !fs::is_regular_file(place, error)) continue;
    if (fs::file_size(place, error) == input.bytes) return place;
    other = place;
  }
  if (other)
    fail("{}: has changed since {} was made from it: it had {} bytes and has {}; name the inputs as well.",
         other->string(), file.string(), input.bytes, fs::file_size(*other, error));
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
