// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/language/run_words.h"

#include <algorithm>
#include <utility>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

template <class T>
RunWords declared(std::string name, T RunOptions::*option, const std::vector<std::pair<std::string, T>>& values,
                  std::string meaning) {
  RunWords made{std::move(name), {}, std::move(meaning), {}, {}};
  for (const auto& [word, value] : values) made.words.push_back(word);
  made.set = [option, values](RunOptions& options, std::size_t i) { options.*option = values[i].second; };
  made.current = [option, values](const RunOptions& options) {
    const auto found = std::ranges::find(values, options.*option, &std::pair<std::string, T>::second);
    const bool is_default = options.*option == RunOptions().*option;
    return is_default || found == values.end() ? std::string() : found->first;
  };
  return made;
}

std::string list_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

}  // namespace

const std::vector<RunWords>& run_words() {
  static const std::vector<RunWords> all = {
      declared<Order>(
          "order", &RunOptions::order, {{"input", Order::input}, {"sweep", Order::sweep}},
          "Order of the points in the output: as in the input, or ascending along the sweep axis (default: input)"),
      declared<std::optional<int>>("axis", &RunOptions::axis, {{"auto", {}}, {"x", 0}, {"y", 1}, {"z", 2}},
                                   "Axis along which the run sweeps; auto is the longest (default: auto)"),
      declared<Engine>(
          "engine", &RunOptions::engine, {{"exact", Engine::exact}, {"reference", Engine::reference}},
          "Use the exact engine, or the paper's own algorithm, which is slow and not always exact (default: exact)"),
      declared<Nonfinite>(
          "nonfinite", &RunOptions::nonfinite,
          {{"keep", Nonfinite::keep}, {"drop", Nonfinite::drop}, {"refuse", Nonfinite::refuse}},
          "Keep, drop or refuse points with NaN or infinite coordinates (default: keep; drop for LAS outputs)"),
      declared<std::optional<Type>>(
          "positions", &RunOptions::positions, {{"float32", Type::f32}, {"float64", Type::f64}},
          "Type of x, y and z in the output, not for LAS (default: that of the input; float64 of moved points)"),
      declared<bool>(
          "provenance", &RunOptions::input_paths, {{"names", false}, {"paths", true}},
          "Record inputs by their names or by their absolute paths in the processing record (default: names)"),
  };
  return all;
}

const RunWords& run_words(std::string_view name) { return *std::ranges::find(run_words(), name, &RunWords::name); }

void set_word(RunOptions& options, std::string_view name, std::string_view word) {
  const RunWords& declaration = run_words(name);
  const auto found = std::ranges::find(declaration.words, word);
  if (found == declaration.words.end()) fail_usage("--{}: '{}' is not {}.", name, word, list_of(declaration.words));
  declaration.set(options, static_cast<std::size_t>(found - declaration.words.begin()));
}

}  // namespace pointsweep
