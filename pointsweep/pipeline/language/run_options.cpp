// SPDX-License-Identifier: MIT
#include "pointsweep/program/run_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/number_from.h"
#include "pointsweep/program/declaration.h"
#include "pointsweep/program/quantities.h"

namespace pointsweep {
namespace {

using enum RunOption::Group;
using enum RunOption::Effect;

constexpr int kMostThreads = 4096;
constexpr int kMostDigits = 15;  ///< decimal digits that float64 represents
constexpr const char* kAutomatic = "auto";

std::optional<int> parse_whole(const std::string& text, int least, int most) {
  const auto number = number_from<int>(text);
  return number && *number >= least && *number <= most ? number : std::nullopt;
}

std::string list_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

// Conversions between texts and the types that option values have.

void read(const std::string& text, const std::string&, std::string& value) { value = text; }
void read(const std::string& text, const std::string&, std::filesystem::path& value) { value = text; }
void read(const std::string& text, const std::string& where, std::uint64_t& bytes) { bytes = parse_size(where, text); }
void read(const std::string& text, const std::string& where, unsigned& threads) {
  const std::optional<int> number = parse_whole(text, 1, kMostThreads);
  if (!number) fail_usage("{}: '{}' is not a whole number from 1 to {}.", where, text, kMostThreads);
  threads = static_cast<unsigned>(*number);
}
void read(const std::string& text, const std::string& where, std::vector<std::string>& names) {
  names = parse_names(where, text);
}

/// Parses the steps of integer coordinates. A single number is the step of all axes.
void read(const std::string& text, const std::string& where, std::optional<Vec3>& steps) {
  double one = 0;
  const bool is_one = parse_number(text, one);
  steps = is_one ? Vec3{one, one, one} : parse_vector(where, text);
  if (!(steps->x > 0 && steps->y > 0 && steps->z > 0)) fail_usage("{}: '{}' is not above 0.", where, text);
}
void read(const std::string& text, const std::string& where, std::optional<Anchor>& place) {
  place.emplace();
  if (text != kAutomatic) place->at = parse_vector(where, text);
}
void read(const std::string& text, const std::string& where, std::optional<int>& digits) {
  digits = parse_whole(text, 0, kMostDigits);
  if (!digits) fail_usage("{}: '{}' is not a whole number from 0 to {}.", where, text, kMostDigits);
}

void read(const std::string& text, const std::string& where, double& length) {
  if (!parse_number(text, length) || !std::isfinite(length) || length < 0)
    fail_usage("{}: '{}' is not a number from 0 on.", where, text);
}
void read(const std::string& text, const std::string& where, std::optional<double>& length) {
  read(text, where, length.emplace());
  if (*length == 0) fail_usage("{}: '{}' is not above 0.", where, text);
}
void read(const std::string& text, const std::string& where, std::array<double, 2>& corner) {
  const std::size_t comma = text.find(',');
  const auto is_number = [&](const std::string& word, double& value) {
    return parse_number(word, value) && std::isfinite(value);
  };
  if (comma == std::string::npos || !is_number(text.substr(0, comma), corner[0]) ||
      !is_number(text.substr(comma + 1), corner[1]))
    fail_usage("{}: '{}' is not X,Y, two numbers.", where, text);
}

std::string text_of(double length) { return fmt::format("{}", length); }
std::string text_of(const std::optional<double>& length) { return fmt::format("{}", *length); }
std::string text_of(const std::array<double, 2>& corner) { return fmt::format("{},{}", corner[0], corner[1]); }
std::string text_of(Vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }
std::string text_of(const std::optional<Vec3>& steps) {
  return steps->x == steps->y && steps->y == steps->z ? fmt::format("{}", steps->x) : text_of(*steps);
}
std::string text_of(const std::optional<Anchor>& place) { return place->at ? text_of(*place->at) : kAutomatic; }
std::string text_of(std::optional<int> digits) { return fmt::format("{}", *digits); }
std::string text_of(const std::string& value) { return value; }
std::string text_of(const std::filesystem::path& value) { return value.string(); }
std::string text_of(std::uint64_t bytes) { return fmt::format("{}B", bytes); }
std::string text_of(unsigned number) { return fmt::format("{}", number); }
std::string text_of(const std::vector<std::string>& names) {
  const std::set<std::string> distinct(names.begin(), names.end());
  return list_of_words({distinct.begin(), distinct.end()});
}

/// Completes the declaration of an option whose value is `member` of RunOptions: a pointer to a data member, or a
/// function that returns a reference to the value.
template <class Member>
RunOption option(RunOption declared, Member member) {
  declared.set = [member](RunOptions& options, const std::string& text, const std::string& where) {
    read(text, where, std::invoke(member, options));
  };
  declared.text = [member](const RunOptions& options) {
    const RunOptions presets;
    const bool is_preset = std::invoke(member, options) == std::invoke(member, presets);
    return is_preset ? std::string() : text_of(std::invoke(member, options));
  };
  return declared;
}

/// Completes the declaration of a switch, which sets the truth value that is not the default.
RunOption switching(RunOption declared, bool RunOptions::*member) {
  declared.set = [member](RunOptions& options, const std::string&, const std::string&) {
    options.*member = !(RunOptions().*member);
  };
  declared.text = [member](const RunOptions& options) {
    return std::string(options.*member == RunOptions().*member ? "" : kSwitchedOn);
  };
  return declared;
}

/// Completes the declaration of an option whose values are words.
template <class T, class Member>
RunOption words(RunOption declared, Member member, const std::vector<std::pair<std::string, T>>& values) {
  for (const auto& [word, value] : values) declared.words.push_back(word);
  declared.value = fmt::format("{}", fmt::join(declared.words, "|"));
  declared.set = [member, values, all = declared.words](RunOptions& options, const std::string& text,
                                                        const std::string& where) {
    const auto found = std::ranges::find(values, text, &std::pair<std::string, T>::first);
    if (found == values.end()) fail_usage("{}: '{}' is not {}.", where, text, list_of(all));
    std::invoke(member, options) = found->second;
  };
  declared.text = [member, values](const RunOptions& options) {
    const RunOptions presets;
    const auto found = std::ranges::find(values, std::invoke(member, options), &std::pair<std::string, T>::second);
    const bool is_preset = std::invoke(member, options) == std::invoke(member, presets);
    return is_preset || found == values.end() ? std::string() : found->first;
  };
  return declared;
}

/// Returns the whole numbers from 0 to `last` with their texts, for words().
std::vector<std::pair<std::string, std::optional<int>>> whole_numbers_to(int last) {
  std::vector<std::pair<std::string, std::optional<int>>> numbers;
  for (int number = 0; number <= last; ++number) numbers.emplace_back(std::to_string(number), number);
  return numbers;
}

}  // namespace

const std::vector<RunOption>& run_options() {
  static const std::vector<RunOption> all = {
      words<Order>(
          {"order", "--order", "",
           "Order of the points in the output: as in the input, or ascending along the sweep axis (default: input)"},
          &RunOptions::order, {{"input", Order::input}, {"sweep", Order::sweep}}),
      words<std::optional<int>>(
          {"axis", "--axis", "", "Axis along which the run sweeps; auto is the longest (default: auto)", machine},
          &RunOptions::axis, {{"auto", {}}, {"x", 0}, {"y", 1}, {"z", 2}}),
      words<Engine>({"engine", "--engine", "",
                     "Use the exact engine, or the paper's own algorithm, which is slow and not always exact (default: "
                     "exact)",
                     other},
                    &RunOptions::engine, {{"exact", Engine::exact}, {"reference", Engine::reference}}),
      option({"replace", "--replace", "A,B,...",
              "Allow computed attributes to overwrite these of the input, e.g. curvature,color"},
             &RunOptions::replace),
      option({"prefix", "--prefix", "NAME", "Put this before the names of computed attributes"}, &RunOptions::prefix),
      words<std::optional<Type>>(
          {"positions", "--positions", "",
           "Type of x, y and z in the output, not for LAS (default: that of the input; float64 of moved points)"},
          &RunOptions::positions, {{"float32", Type::f32}, {"float64", Type::f64}}),
      option(
          {"scale", "--scale", "S|X,Y,Z",
           "Steps of the integer coordinates of LAS, to which they are rounded (default: those of the input, or the "
           "finest that reach all points)"},
          [](auto& options) -> auto& { return options.layout.scale; }),
      option(
          {"offset", "--offset", "auto|X,Y,Z",
           "Offset of the integer coordinates of LAS; auto is near the middle (default: that of the input as long as "
           "it reaches all points)"},
          [](auto& options) -> auto& { return options.layout.offset; }),
      words<std::optional<int>>(
          {"point_format", "--point-format", "",
           "Point format of LAS; attributes without a field there become extra bytes (default: that of the input, or "
           "the shortest that holds all)"},
          [](auto& options) -> auto& { return options.layout.point_format; }, whole_numbers_to(10)),
      words<std::optional<int>>(
          {"las_version", "--las-version", "", "Version of LAS (default: that of the input, or 1.4)"},
          [](auto& options) -> auto& { return options.layout.las_version; },
          {{"1.0", 0}, {"1.1", 1}, {"1.2", 2}, {"1.3", 3}, {"1.4", 4}}),
      option(
          {"decimals", "--decimals", "DIGITS",
           "Digits of x, y and z after the decimal point in text (default: as many as their values need)"},
          [](auto& options) -> auto& { return options.layout.decimals; }),
      option(
          {"tile", "--tile", "LENGTH",
           "Divide the output among square tiles of this edge, files X_Y in the folder OUT, named after their lower "
           "corners"},
          [](auto& options) -> auto& { return options.division.tile; }),
      option(
          {"tile_origin", "--tile-origin", "X,Y", "Corner of a tile (default: 0,0)"},
          [](auto& options) -> auto& { return options.division.tile_origin; }),
      option(
          {"tile_buffer", "--tile-buffer", "WIDTH",
           "Tiles also hold the points of their neighbours for X - WIDTH <= x < X + size + WIDTH, likewise in y, with "
           "the attribute buffer = 1 (default: 0, none)"},
          [](auto& options) -> auto& { return options.division.tile_buffer; }),
      option(
          {"split", "--split", "ATTRIBUTE",
           "Write a file into the folder OUT for each value of this attribute, e.g. classification"},
          [](auto& options) -> auto& { return options.division.split; }),
      words<Nonfinite>(
          {"nonfinite", "--nonfinite", "",
           "Keep, drop or refuse points with NaN or infinite coordinates (default: keep; drop for LAS outputs)", other},
          &RunOptions::nonfinite,
          {{"keep", Nonfinite::keep}, {"drop", Nonfinite::drop}, {"refuse", Nonfinite::refuse}}),
      words<bool>({"provenance", "--provenance", "",
                   "Record inputs by their names or by their absolute paths in the processing record (default: names)",
                   output, file},
                  &RunOptions::input_paths, {{"names", false}, {"paths", true}}),
      switching({"no_provenance", "--no-provenance", "", "Omit the processing record", output, file},
                &RunOptions::provenance),
      switching({"overwrite", "-f,--force", "", "Overwrite existing outputs", output, none}, &RunOptions::overwrite),
      option(
          {"memory", "--memory", "SIZE",
           "Memory budget of the whole process, e.g. 800M, 2GB or 4GiB, in powers of 1024 (default: half of the "
           "available memory)",
           machine, none},
          [](auto& options) -> auto& { return options.resources.memory_bytes; }),
      option(
          {"threads", "--threads", "N", "Number of threads (default: one per processor)", machine, none},
          [](auto& options) -> auto& { return options.resources.threads; }),
      option(
          {"temp_folder", "--temp-dir", "DIR",
           "Existing folder for temporary files, which a cloud beyond the budget needs (default: that of the "
           "system)",
           machine, none},
          [](auto& options) -> auto& { return options.resources.temp_folder; }),
      option({"resume", "--resume", "DIR",
              "Keep checkpoints in this folder. Rerun the command to resume after an interruption", machine, none},
             &RunOptions::resume_folder),
  };
  return all;
}

const RunOption& run_option(std::string_view name) { return *std::ranges::find(run_options(), name, &RunOption::name); }

std::string identity_text(const RunOptions& options) {
  std::string lines;
  for (const RunOption& option : run_options()) {
    if (option.effect == none) continue;
    const std::string value = option.text(options);
    lines += fmt::format("{} {}\n", option.name, value.empty() ? "by default" : value);
  }
  return lines;
}

}  // namespace pointsweep
