// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "pointsweep/program/quantities.h"
#include "pointsweep/verify.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMostNames = 12;
/// The conclusion tells of coordinates that are rounded by more than kNoticed or this share of the extent.
constexpr double kNoticed = 0.001, kNoticedShare = 1e-5;

std::string names_text(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMostNames; ++i) text += (i == 0 ? "" : " ") + names[i];
  if (names.size() > kMostNames) text += fmt::format(" and {} more", names.size() - kMostNames);
  return text;
}

/// Returns a number and its noun in the right form: "1 value", "10,000 values".
std::string counted(std::uint64_t number, const char* what) {
  return fmt::format("{} {}{}", grouped_text(number), what, number == 1 ? "" : "s");
}

std::string checksum_text(const AttributeArrival& a) {
  if (a.sum_in == a.sum_out) return fmt::format("  {:<18} {:016x}\n", a.name, a.sum_in);
  return fmt::format("  {:<18} {:016x} in the input, {:016x} in the output\n", a.name, a.sum_in, a.sum_out);
}

std::string order_text(const Verdict& v) {
  if (v.order.empty()) return v.same() ? "in another order than those of the input" : "?";
  return "in the order of the " + v.order;
}

/// Returns how far coordinates were rounded, such as "x by up to 0.005"; empty if none was by more than `least`.
std::string rounding_text(const Verdict& v, double least) {
  std::string text;
  for (const AttributeArrival& a : v.arrivals.attributes)
    if (a.rounded_by > least)
      text += fmt::format("{}{} by up to {:.3g}", text.empty() ? "" : ", ", a.name, a.rounded_by);
  return text;
}

std::string differences_text(const Verdict& v) {
  std::string text;
  for (const std::string& difference : v.differences) text += fmt::format("  DIFFERENT          {}\n", difference);
  if (v.difference_count > v.differences.size())
    text += fmt::format("  DIFFERENT          {} more\n", grouped_text(v.difference_count - v.differences.size()));
  return text;
}

std::string unchecked_text(const Verdict& v) {
  std::string text;
  if (v.open_values > 0)
    text += fmt::format("  not checked        {} of {}, which rounding decides\n", grouped_text(v.open_values),
                        counted(v.values, "value"));
  if (v.open_rows > 0)
    text += fmt::format("  not checked        whether {} of {} stay, which the data do not tell\n",
                        grouped_text(v.open_rows), counted(v.sampled, "row"));
  if (!v.unknown.empty())
    text += fmt::format("  not checked        {}: not of the input, and not made by stages that can be checked\n",
                        names_text(v.unknown));
  for (const std::string& why : v.untold) text += fmt::format("  not checked        {}\n", why);
  return text;
}

std::string conclusion_of_what_differs(const Verdict& v) {
  if (v.different_rows > 0 && v.wrong_points == 0)
    return fmt::format("{} differs from its input in {}", v.output, counted(v.different_rows, "row"));
  if (v.different_rows == 0 && v.wrong_points > 0)
    return fmt::format("{}: {} of {} {} wrong", v.output, grouped_text(v.wrong_points), counted(v.sampled, "sample"),
                       v.wrong_points == 1 ? "is" : "are");
  return fmt::format("{} differs from its input", v.output);
}

std::string conclusion_of_what_is_open(const Verdict& v) {
  std::string text;
  const auto add = [&](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  if (v.open_values > 0) add(fmt::format("{} of {}", grouped_text(v.open_values), counted(v.values, "value")));
  if (v.open_rows > 0) add(fmt::format("{} of {}", grouped_text(v.open_rows), counted(v.sampled, "row")));
  if (!v.unknown.empty()) add(counted(v.unknown.size(), "attribute"));
  if (!v.untold.empty()) add(counted(v.untold.size(), "stage"));
  return "not checked: " + text + "; all else is correct";
}

}  // namespace

std::string conclusion(const Verdict& v) {
  if (!v.same()) return conclusion_of_what_differs(v);
  if (!v.is_complete()) return conclusion_of_what_is_open(v);
  const Vec3 extent = v.arrivals.bounds.extent();
  const std::string rounding =
      rounding_text(v, std::min(kNoticed, kNoticedShare * std::max({extent.x, extent.y, extent.z, 0.0})));
  std::string text = v.attributes_compared ? "inputs unchanged" : "";
  if (!rounding.empty()) text = "inputs unchanged but for rounding";
  if (v.sampled > 0) text += (text.empty() ? "" : ", ") + counted(v.sampled, "sample") + " correct";
  return "OK: " + (text.empty() ? "nothing was to be checked" : text);
}

std::string to_text(const Verdict& v, Checksums checksums) {
  std::string text;
  if (v.dropped > 0)
    text = fmt::format("left out     {} points of the input whose coordinates are not finite; rows count the others\n",
                       v.dropped);
  text += fmt::format("{} against {}\n", v.output, v.input) + differences_text(v);
  text += fmt::format("  points             {}", grouped_text(v.arrivals.points_out));
  if (v.attributes_compared && v.arrivals.points_out != v.points_of_inputs)
    text += fmt::format(", of {} in the input", grouped_text(v.points_of_inputs));
  text += "\n";
  if (const std::string rounding = rounding_text(v, 0); !rounding.empty())
    text += fmt::format("  rounded            {}\n", rounding);
  if (v.attributes_compared) text += fmt::format("  rows               {}\n", order_text(v));
  if (checksums == Checksums::show)
    for (const AttributeArrival& a : v.arrivals.attributes) text += checksum_text(a);
  if (v.made.empty())
    text += "  operators          none, so no neighbourhoods were looked at\n";
  else
    text += fmt::format("  by brute force     {} of {}, {} wrong: {}\n", grouped_text(v.sampled),
                        counted(v.arrivals.points_in + v.left_out.value_or(0), "point"), grouped_text(v.wrong_points),
                        names_text(v.made));
  if (v.left_out)
    text += fmt::format("  rows left out      {}; whether a row stays was checked for {} of {}\n",
                        grouped_text(*v.left_out), grouped_text(v.sampled - v.open_rows), counted(v.sampled, "row"));
  if (!v.by_own_operator.empty()) text += fmt::format("  not independent    {}\n", names_text(v.by_own_operator));
  return text + unchecked_text(v) + conclusion(v) + "\n";
}

}  // namespace pointsweep
