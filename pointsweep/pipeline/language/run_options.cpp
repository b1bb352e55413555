// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/language/run_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <set>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/pipeline/language/quantities.h"

namespace pointsweep {
namespace {

using enum RunOption::Group;
using enum RunOption::Effect;

constexpr unsigned kMostThreads = 4096;

std::string list_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

// Values of the types that options have, from texts and as texts.

void read(const std::string& text, const std::string&, std::string& value) { value = text; }
void read(const std::string& text, const std::string&, std::filesystem::path& value) { value = text; }
void read(const std::string& text, const std::string& where, std::uint64_t& bytes) { bytes = parse_size(where, text); }
void read(const std::string& text, const std::string& where, unsigned& threads) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
  if (error != std::errc() || end != text.data() + text.size() || threads < 1 || threads > kMostThreads)
    fail_usage("{}: '{}' is not a whole number from 1 to {}.", where, text, kMostThreads);
}
void read(const std::string& text, const std::string& where, std::vector<std::string>& names) {
  names = parse_names(where, text);
}

std::string text_of(const std::string& value) { return value; }
std::string text_of(const std::filesystem::path& value) { return value.string(); }
std::string text_of(std::uint64_t bytes) { return fmt::format("{}B", bytes); }
std::string text_of(unsigned number) { return fmt::format("{}", number); }
std::string text_of(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(std::set<std::string>(names.begin(), names.end()), ","));
}

/// Completes the declaration of an option that `member` of RunOptions holds: a pointer to a member, or a function.
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

/// The same for a switch, which sets a truth value that is not the default.
RunOption switching(RunOption declared, bool RunOptions::*member) {
  declared.set = [member](RunOptions& options, const std::string&, const std::string&) {
    options.*member = !(RunOptions().*member);
  };
  declared.text = [member](const RunOptions& options) {
    return std::string(options.*member == RunOptions().*member ? "" : kSwitchedOn);
  };
  return declared;
}

/// The same for an option whose values are words.
template <class T>
RunOption words(RunOption declared, T RunOptions::*member, const std::vector<std::pair<std::string, T>>& values) {
  for (const auto& [word, value] : values) declared.words.push_back(word);
  declared.value = fmt::format("{}", fmt::join(declared.words, "|"));
  declared.set = [member, values, all = declared.words](RunOptions& options, const std::string& text,
                                                        const std::string& where) {
    const auto found = std::ranges::find(values, text, &std::pair<std::string, T>::first);
    if (found == values.end()) fail_usage("{}: '{}' is not {}.", where, text, list_of(all));
    options.*member = found->second;
  };
  declared.text = [member, values](const RunOptions& options) {
    const auto found = std::ranges::find(values, options.*member, &std::pair<std::string, T>::second);
    const bool is_preset = options.*member == RunOptions().*member;
    return is_preset || found == values.end() ? std::string() : found->first;
  };
  return declared;
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
