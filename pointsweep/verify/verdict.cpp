// SPDX-License-Identifier: MIT
#include "pointsweep/verify/verdict.h"

#include <fmt/format.h>

namespace pointsweep {
namespace {

constexpr std::size_t kMostNames = 12;

std::string names_text(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMostNames; ++i) text += (i == 0 ? "" : " ") + names[i];
  if (names.size() > kMostNames) text += fmt::format(" and {} more", names.size() - kMostNames);
  return text;
}

std::string attribute_text(const AttributeArrival& a) {
  if (a.sum_in == a.sum_out) return fmt::format("  {:<18} {:016x}\n", a.name, a.sum_in);
  return fmt::format("  {:<18} {:016x} in the input, {:016x} in the output\n", a.name, a.sum_in, a.sum_out);
}

}  // namespace

std::string to_text(const Verdict& v) {
  std::string text = fmt::format("{} against {}\n  points             {}\n", v.output, v.input, v.arrivals.points_out);
  if (v.attributes_compared)
    text += fmt::format("  rows               {}\n", v.order.empty() ? "?" : "in the order of the " + v.order);
  for (const AttributeArrival& a : v.arrivals.attributes) text += attribute_text(a);
  if (v.made.empty())
    text += "  operators          none, so no neighbourhoods were looked at\n";
  else
    text += fmt::format("  by brute force     {} of {} points, {} wrong: {}\n", v.sampled,
                        v.arrivals.points_in + v.left_out.value_or(0), v.wrong_points, names_text(v.made));
  if (v.left_out)
    text += fmt::format("  rows left out      {}; whether a row stays is told for {} of {} rows\n", *v.left_out,
                        v.sampled - v.open_rows, v.sampled);
  if (!v.by_own_operator.empty()) text += fmt::format("  not independent    {}\n", names_text(v.by_own_operator));
  if (v.open_values > 0)
    text += fmt::format("  undetermined       {} of {} values: the data do not tell which is right\n", v.open_values,
                        v.values);
  if (!v.unknown.empty()) text += fmt::format("  not checked        {}\n", names_text(v.unknown));
  for (const std::string& why : v.untold) text += fmt::format("  not checked        {}\n", why);
  for (const std::string& difference : v.differences) text += fmt::format("  DIFFERENT          {}\n", difference);
  if (v.difference_count > v.differences.size())
    text += fmt::format("  DIFFERENT          {} more\n", v.difference_count - v.differences.size());
  return text + (v.same() ? "same\n" : "different\n");
}

}  // namespace pointsweep
