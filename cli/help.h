// SPDX-License-Identifier: MIT
/// How help looks: plain names, and IN... OUT where a verb takes files of which the last is the output.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Formatter.hpp>
#include <string>

namespace pointsweep {

inline constexpr const char* kInputsAndOutput = "FILES";  ///< to the parser IN... OUT is one list of this name

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    column_width(30);
    label("SUBCOMMAND", "VERB");
  }
  std::string make_option_name(const CLI::Option* option, bool positional) const override {
    const std::string name = option->get_name(positional, !positional);
    return name == kInputsAndOutput ? "IN... OUT" : name;
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    return option->get_type_name().empty() ? "" : " " + option->get_type_name();
  }
  std::string make_option_usage(const CLI::Option* option) const override {
    return make_option_name(option, true) +
           (option->get_name(true) != kInputsAndOutput && option->get_expected_max() > 1 ? "..." : "");
  }
};

}  // namespace pointsweep
