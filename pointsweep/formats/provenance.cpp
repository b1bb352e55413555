// SPDX-License-Identifier: MIT
#include "pointsweep/formats/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pointsweep/number_from.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

constexpr std::size_t kLongestProvenanceLine = 999;  ///< rply, the reader of Open3D and CloudCompare, allows 1,023
constexpr std::size_t kLongestReadLine = 60'000;  ///< earlier versions did not divide lines; a VLR holds 65,535 bytes
constexpr std::string_view kGoesOn = "+ ";        ///< follows the mark in a line that continues the previous line
constexpr std::size_t kMostProvenanceBytes = 256 << 10;
constexpr std::size_t kMostInputBytes = 32 << 10;  ///< largest size of the input lines in one record

bool is_printable(char c) { return c >= 0x20 && c < 0x7f; }

std::string percent_encoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool ends_or_repeats = i == 0 || i + 1 == text.size() || text[i - 1] == ' ';
    if (is_printable(text[i]) && text[i] != '%' && !(ends_or_repeats && text[i] == ' '))
      out += text[i];
    else
      out += fmt::format("%{:02X}", static_cast<unsigned char>(text[i]));
  }
  return out;
}

bool take_count(std::string_view& text, std::uint64_t& count) {
  const auto number = take_number<std::uint64_t>(text);
  count = number.value_or(count);
  return number.has_value();
}

bool take_word(std::string_view& text, std::string_view word) {
  if (!text.starts_with(word)) return false;
  text.remove_prefix(word.size());
  return true;
}

/// Appends a line, divided into pieces of at most kLongestProvenanceLine bytes. No piece begins or ends with a space,
/// since readers trim lines.
void append_in_pieces(std::string line, std::vector<std::string>& lines) {
  while (line.size() > kLongestProvenanceLine) {
    std::size_t end = kLongestProvenanceLine;
    while (line[end - 1] == ' ' || line[end] == ' ') --end;
    lines.push_back(line.substr(0, end));
    line = fmt::format("{}{}{}", kProvenanceMark, kGoesOn, line.substr(end));
  }
  lines.push_back(std::move(line));
}

std::string line_of(const ProvenanceInput& input) {
  const std::string counts = fmt::format("{}input {} points, {} bytes: ", kProvenanceMark, input.points, input.bytes);
  const std::string name = percent_encoded(input.name);
  if (counts.size() + name.size() <= kLongestProvenanceLine) return counts + name;
  return counts + percent_encoded(std::string_view(input.name).substr(input.name.rfind('/') + 1));
}

std::optional<ProvenanceInput> input_of(std::string_view text) {
  ProvenanceInput input;
  const bool counts = take_count(text, input.points) && take_word(text, " points, ") && take_count(text, input.bytes) &&
                      take_word(text, " bytes: ");
  if (!counts || text.empty()) return std::nullopt;
  input.name = percent_decoded(text);
  return input;
}

/// Adds the content of a line to `record`. `text`: the stage or value in `record` that a continuation line would
/// extend; null if the previous line has neither.
void read_line(std::string_view line, ProvenanceRecord& record, std::string*& text) {
  if (take_word(line, kGoesOn)) return text != nullptr ? void(*text += line) : void();
  text = nullptr;
  if (take_word(line, "stage ")) return void(text = &record.stages.emplace_back(line));
  if (take_word(line, "input ")) {
    if (auto input = input_of(line)) record.inputs.push_back(std::move(*input));
    return;
  }
  if (take_word(line, "more-inputs ")) return void(take_count(line, record.more_inputs));
  const std::size_t space = line.find(' ');
  if (space != line.npos) text = &record.settings.emplace_back(line.substr(0, space), line.substr(space + 1)).second;
}

/// Returns the indices of the lines at which records begin, followed by the number of lines.
std::vector<std::size_t> record_starts(std::span<const std::string> lines) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string_view rest = std::string_view(lines[i]).substr(kProvenanceMark.size());
    if (starts.empty() || (!rest.empty() && rest[0] >= '0' && rest[0] <= '9')) starts.push_back(i);
  }
  starts.push_back(lines.size());
  return starts;
}

std::size_t bytes_of(std::span<const std::string> lines) {
  std::size_t bytes = 0;
  for (const std::string& line : lines) bytes += line.size() + 1;
  return bytes;
}

}  // namespace

std::optional<std::string> ProvenanceRecord::setting(std::string_view name) const {
  for (const auto& [key, value] : settings)
    if (key == name) return value;
  return std::nullopt;
}

std::vector<std::string> lines_of(const ProvenanceRecord& record) {
  const std::string mark(kProvenanceMark);
  std::vector<std::string> lines = {mark + record.version};
  for (const std::string& stage : record.stages) append_in_pieces(mark + "stage " + percent_encoded(stage), lines);
  for (const auto& [name, value] : record.settings) append_in_pieces(mark + name + " " + percent_encoded(value), lines);
  std::uint64_t left_out = record.more_inputs;
  std::size_t bytes = 0;
  for (const ProvenanceInput& input : record.inputs) {
    std::string line = line_of(input);
    if (bytes += line.size(); bytes > kMostInputBytes)
      ++left_out;
    else
      lines.push_back(std::move(line));
  }
  if (left_out > 0) lines.push_back(fmt::format("{}more-inputs {}", mark, left_out));
  return lines;
}

std::vector<ProvenanceRecord> records_of(std::span<const std::string> lines) {
  std::vector<ProvenanceRecord> records;
  const std::vector<std::size_t> starts = record_starts(lines);
  for (std::size_t r = 0; r + 1 < starts.size(); ++r) {
    ProvenanceRecord record;
    record.version = lines[starts[r]].substr(kProvenanceMark.size());
    std::string* text = nullptr;
    for (std::size_t i = starts[r] + 1; i < starts[r + 1]; ++i)
      read_line(std::string_view(lines[i]).substr(kProvenanceMark.size()), record, text);
    for (std::string& stage : record.stages) stage = percent_decoded(stage);
    for (auto& [name, value] : record.settings) value = percent_decoded(value);
    records.push_back(std::move(record));
  }
  return records;
}

std::string to_text(const ProvenanceRecord& record) {
  std::string text = std::string(kProvenanceMark) + record.version;
  for (std::size_t i = 0; i < record.stages.size(); ++i)
    text += (i == 0 ? ": " : " | ") + percent_encoded(record.stages[i]);
  for (const auto& [name, value] : record.settings) text += "; " + name + " " + percent_encoded(value);
  for (std::size_t i = 0; i < record.inputs.size() && i < 3; ++i)
    text += (i == 0 ? "; from " : ", ") + percent_encoded(record.inputs[i].name);
  const std::uint64_t others =
      record.more_inputs + record.inputs.size() - std::min<std::size_t>(3, record.inputs.size());
  return others == 0 ? text : text + fmt::format(" and {} more", others);
}

void add_provenance(std::vector<std::string>& lines, std::span<const std::string> more) {
  const std::vector<std::size_t> starts = record_starts(more);
  for (std::size_t r = 0; r + 1 < starts.size(); ++r) {
    const auto record = more.subspan(starts[r], starts[r + 1] - starts[r]);
    if (std::search(lines.begin(), lines.end(), record.begin(), record.end()) != lines.end()) continue;
    if (bytes_of(lines) + bytes_of(record) > kMostProvenanceBytes) {
      const std::string note = std::string(kProvenanceMark) + "note more records are left out";
      if (lines.empty() || lines.back() != note) lines.push_back(note);
      return;
    }
    lines.insert(lines.end(), record.begin(), record.end());
  }
}

std::span<const std::string> provenance_beyond(std::span<const std::string> all, std::span<const std::string> present) {
  const bool begins = present.size() <= all.size() &&
                      std::equal(present.begin(), present.end(), all.begin(), all.begin() + std::ssize(present));
  return begins ? all.subspan(present.size()) : all;
}

std::optional<std::string> provenance_line(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == text.npos) return std::nullopt;
  text = text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
  if (text.size() > kLongestReadLine) return std::nullopt;
  if (!text.starts_with(kProvenanceMark) || !std::ranges::all_of(text, is_printable)) return std::nullopt;
  return std::string(text);
}

std::vector<std::string> provenance_in(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (auto found = provenance_line(line)) lines.push_back(std::move(*found));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return lines;
}

}  // namespace pointsweep
