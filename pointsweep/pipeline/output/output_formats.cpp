// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/output_formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>

#include "pointsweep/fail.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/formats/files/folders.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/points/input_row.h"
#include "pointsweep/points/lower_case.h"
#include "pointsweep/program/pipeline.h"
#include "pointsweep/program/run_options.h"
#include "pointsweep/program/standard_streams.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

bool moves(const Attribute& a) {
  return a.name == position_attribute().name || a.name == stream_position_attribute().name;
}

class Naming {
 public:
  Naming(const Schema& input, const std::string& input_name, const std::filesystem::path& output,
         const NamingRules& rules)
      : input_(input), input_name_(input_name), format_(format_of_output(output)), rules_(rules) {
    if (!rules.prefix.empty() && !is_name(rules.prefix))
      fail_usage("--prefix: '{}' is not made of letters, digits, _ . and -.", rules.prefix);
    for (const std::string& column : column_names(input)) columns_.push_back(stored_name(column));
    for (const std::string& name : rules.replace) unused_.insert(in_lower_case(name));
  }

  OutputNames run(const std::vector<Attribute>& made, const KeptFields& kept) {
    out_.made = made;
    out_.kept = kept;
    out_.kept.left_out.clear();
    for (const Attribute& a : made)
      for (const std::string& field : a.fields)
        if (!moves(a)) std::ranges::replace(out_.kept.order, field, rules_.prefix + field);
    for (Attribute& a : out_.made)
      for (std::string& field : a.fields) {
        if (kept.left_out.contains(field))
          out_.kept.left_out.insert(field = (moves(a) ? "" : rules_.prefix) + field);
        else if (!moves(a))
          name(a, field);
      }
    if (!unused_.empty())
      fail_usage("--replace: '{}' is no attribute of {} whose name a made attribute takes; leave it out.",
                 *unused_.begin(), input_name_);
    return std::move(out_);
  }

 private:
  /// Returns the name of a field in the file, in lower case.
  std::string stored_name(const std::string& name) const {
    const bool has_own_names = format_ != nullptr && format_->stored_name != nullptr;
    return in_lower_case(has_own_names ? format_->stored_name(name) : name);
  }

  void name(const Attribute& attribute, std::string& field) {
    const std::string own = field;
    field = rules_.prefix + field;
    const std::string stored = stored_name(field);
    const std::size_t most = format_ != nullptr ? format_->name_bytes : 0;
    const bool too_long = most != 0 && !rules_.prefix.empty() && field.size() > most;
    if (!taken_.insert(stored).second || too_long)
      fail_usage("--prefix: '{}' is too long, since {} keeps {} bytes of a name; choose a shorter prefix.", field,
                 format_ != nullptr ? format_->name : "the output", most);
    if (const auto at = input_.find(field)) return meet(attribute, own, field, input_.fields[*at]);
    const auto column = std::find(columns_.begin(), columns_.end(), stored);
    if (column != columns_.end())
      refuse(field, column_names(input_)[static_cast<std::size_t>(column - columns_.begin())], "");
  }

  /// Allows the made field `field` to overwrite `old`, the field of the input with the same name in any spelling, or
  /// throws UsageError.
  void meet(const Attribute& attribute, const std::string& own, const std::string& field, const Field& old) {
    if (old.count != 1) refuse(field, old.name, "");
    if (asked_to_replace({attribute.name, own, old.name, library_name_of(old.name)})) return;
    const bool is_color = attribute.kind == Kind::color;  // colours of a camera cannot be computed again
    const bool is_asked_for = !is_color && means_only(old.name, own);
    if (!rules_.prefix.empty() || !is_asked_for)
      refuse(field, old.name, attribute.is_list() ? attribute.name : old.name);
    out_.replaced.push_back(old.name);
  }

  bool asked_to_replace(std::initializer_list<std::string> names) {
    bool asked = false;
    for (const std::string& name : names)
      for (const std::string& wanted : rules_.replace)
        if (is_spelling_of(name, wanted)) asked = true, unused_.erase(in_lower_case(wanted));
    return asked;
  }

  /// Throws UsageError. `replaceable`: the name with which --replace allows `old` to be overwritten; empty if none
  /// does.
  [[noreturn]] void refuse(const std::string& field, const std::string& old, const std::string& replaceable) const {
    const std::string overwrite =
        replaceable.empty() ? "" : fmt::format("allow it with --replace {}, or ", replaceable);
    const std::string other =
        rules_.prefix.empty() ? "rename the computed attributes with --prefix NAME" : "choose another prefix";
    fail_usage("{}: the computed '{}' would overwrite its attribute '{}'; {}{}.", input_name_, field, old, overwrite,
               other);
  }

  const Schema& input_;
  const std::string& input_name_;
  const Format* format_;  ///< format of the output; null if unknown
  const NamingRules& rules_;
  /// Names under which the output stores the written fields of the input, in lower case.
  std::vector<std::string> columns_;
  std::set<std::string> taken_;   ///< names under which the output stores made fields, in lower case
  std::set<std::string> unused_;  ///< names in `replace` that no made attribute has matched
  OutputNames out_;
};

struct Moves {
  std::vector<std::string> stages;  ///< names of stages, without repetition
  std::array<bool, 3> axes{};       ///< x, y and z: true if a stage may move the coordinate to another system
};

/// Records the coordinates that stage `op`, which makes positions, may move to another coordinate system.
void add_moves(const LocalOperator& op, Moves& moves) {
  const std::array<bool, 3> axes = op.changes_system();
  if (axes == std::array<bool, 3>{}) return;
  for (std::size_t axis = 0; axis < 3; ++axis) moves.axes[axis] |= axes[axis];
  if (std::ranges::find(moves.stages, op.name()) == moves.stages.end()) moves.stages.push_back(op.name());
}

Moves moves_of(const ChainGraph& graph) {
  Moves moves;
  for (const GraphNode& node : graph.nodes)
    for (const std::size_t v : node.makes)
      if (const auto* op = std::get_if<std::shared_ptr<const LocalOperator>>(node.op());
          op != nullptr && graph.versions[v].attribute.name == position_attribute().name)
        add_moves(**op, moves);
  return moves;
}

/// Throws UsageError for options of FileLayout that the format of an output does not support.
void require_layout_possible(const Outputs& outputs, const EngineOptions& options) {
  for (const OutputFormat& output : output_formats(outputs))
    for (const RunOption& option : run_options()) {
      const auto takes = [&](const Format* format) {
        return std::ranges::find(format->layout, option.name) != format->layout.end();
      };
      std::vector<std::string_view> takers;
      for (const Format* format : formats())
        if (takes(format) && std::ranges::find(takers, format->name) == takers.end()) takers.push_back(format->name);
      if (takers.empty() || takes(output.format) || option.text(options).empty()) continue;
      fail_usage("{}: is for {} outputs, and {} is {}; leave the option out.", option.flag, fmt::join(takers, ", "),
                 output.example.string(), output.format->name);
    }
}

bool is_point_output(const std::filesystem::path& file) {
  const Format* const format = is_hidden(file) ? nullptr : format_of_output(file);
  return format != nullptr && format->content == Format::Content::points;
}

bool holds_point_files(const std::filesystem::path& folder) {
  std::error_code error;
  if (is_url(folder))
    return std::ranges::any_of(list_remote((folder / "").string(), false),
                               [](const RemoteEntry& entry) { return is_point_output(entry.url); });
  if (!std::filesystem::is_directory(folder, error)) return false;
  return std::ranges::any_of(entries_of(folder), [](const auto& entry) { return is_point_output(entry.path()); });
}

void require_division_possible(const Outputs& outputs, const EngineOptions& options) {
  const OutputDivision& division = options.division;
  if (!division.tile && (division.tile_buffer != 0 || division.tile_origin != OutputDivision().tile_origin))
    fail_usage("--tile-origin and --tile-buffer belong to --tile; give it, or leave them out.");
  if (!division.divides()) return;
  if (division.tile && !division.split.empty())
    fail_usage("--tile and --split each divide the output; make two runs, e.g. split first, then tile.");
  if (division.tile &&
      (!(*division.tile > 0) || !(division.tile_buffer >= 0 && division.tile_buffer <= *division.tile)))
    fail_usage("--tile-buffer: {} is not from 0 to the size of a tile, {}.", division.tile_buffer, *division.tile);
  const std::string name = outputs.points.filename().string();
  if (std::ranges::count(name, '*') > 1)
    fail_usage("{}: one '*' stands for the name of each file; leave out the others.", outputs.points.string());
  if (name.find('*') == std::string::npos) fail_usage("--tile and --split write many files: name a folder for them.");
  if (!outputs.arrays.empty() || outputs.writer || !outputs.tiles.empty())
    fail_usage("--tile and --split divide point files, and nothing else can be written with them; make two runs.");
  if (!options.resume_folder.empty())
    fail_usage(
        "--resume: a run that divides its output cannot be resumed; write one file with --resume, then divide that.");
  const std::filesystem::path folder = folder_of(outputs.points);
  if (!options.overwrite && holds_point_files(folder))
    fail(
        "{}: holds point files already, which could not be told from those of this run; name another folder, or allow "
        "files to be replaced (--force).",
        folder.string());
}

}  // namespace

std::string OutputNames::warning() const {
  if (replaced.empty()) return "";
  return fmt::format("replacing {} of the input with computed values.", fmt::join(replaced, ", "));
}

OutputNames name_outputs(const Schema& input, const std::string& input_name, const std::vector<Attribute>& made,
                         const KeptFields& named, const std::filesystem::path& output, const NamingRules& rules) {
  const Schema all = without_input_row(input);
  const KeptFields kept = rules.prefix.empty() ? without_replaced(named, all) : named;
  Schema written = all;  // the written fields of the input
  if (kept.input) {
    written.fields.clear();
    for (const std::size_t f : *kept.input) written.fields.push_back(all.fields[f]);
  }
  return Naming(written, input_name, output, rules).run(made, kept);
}

std::vector<OutputFormat> output_formats(const Outputs& outputs) {
  std::vector<std::filesystem::path> paths = outputs.tiles;
  if (!outputs.points.empty()) paths.push_back(outputs.points);
  std::vector<OutputFormat> formats;
  for (const std::filesystem::path& path : paths) {
    const Format& format = point_format_of_output(path);
    if (std::ranges::find(formats, &format, &OutputFormat::format) == formats.end()) formats.push_back({&format, path});
  }
  return formats;
}

bool needs_bounds(const Format* format, const Schema& schema, const FileLayout& layout) {
  return format != nullptr && format->needs_bounds != nullptr && format->needs_bounds(schema, layout);
}

std::shared_ptr<KnownValues> values_if_needed(const Format* format, InputCloud& cloud, const FileLayout& layout,
                                              const std::function<void(std::uint64_t rows)>& progress) {
  if (format == nullptr || format->values == nullptr) return nullptr;
  return std::make_shared<KnownValues>(format->values(cloud, layout, progress));
}

OutputNames names_in_outputs(const InputCloud& cloud, const ChainPlan& plan, const Outputs& outputs,
                             const EngineOptions& options) {
  const std::string name = cloud.readers().empty() ? "The input" : cloud.readers().front()->info().path.string();
  std::vector<std::filesystem::path> examples;
  for (const OutputFormat& format : output_formats(outputs)) examples.push_back(format.example);
  if (examples.empty()) examples.push_back(outputs.points);
  OutputNames names;
  for (const std::filesystem::path& example : examples)
    names = name_outputs(cloud.schema(), name, plan.made, plan.kept, example, {options.prefix, options.replace});
  return names;
}

void require_outputs(const Outputs& outputs) {
  if (outputs.points.empty() && outputs.arrays.empty() && outputs.tiles.empty() && !outputs.writer)
    fail_usage("the run has no output: name a point file, arrays, a writer or tiles.");
}

void require_order_kept(const Outputs& outputs) {
  for (const OutputFormat& output : output_formats(outputs))
    if (output.format->reorders)
      fail_usage(
          "{}: {} has its points in the order of nodes of an octree; write another format, e.g. LAZ, to have them "
          "along an axis.",
          output.example.string(), output.format->name);
}

void require_outputs_possible(const Outputs& outputs, const EngineOptions& options) {
  if (options.order == Order::sweep) require_order_kept(outputs);
  require_layout_possible(outputs, options);
  require_division_possible(outputs, options);
  if (outputs.tiles.empty()) return;
  if (!outputs.points.empty() || !outputs.arrays.empty() || outputs.writer)
    fail_usage("An output for each input cannot be combined with an output of all points; make two runs.");
  if (options.order == Order::sweep)
    fail_usage(
        "A folder of outputs has the points of each input in their order: leave out --order sweep, or name one output "
        "file.");
}

OutputNeeds needs_of(const Outputs& outputs, const EngineOptions& options) {
  const std::vector<OutputFormat> written = output_formats(outputs);
  const bool bounds = std::ranges::any_of(written, [](const OutputFormat& o) { return o.format->needs_bounds; });
  return {.stream_order = options.order == Order::sweep, .bounds = bounds};
}

std::string name_of_output(const Outputs& outputs) {
  if (!outputs.tiles.empty()) return outputs.tiles.front().parent_path().string();
  if (outputs.points.filename().string().find('*') != std::string::npos) return folder_of(outputs.points).string();
  if (is_standard_output(outputs.points)) return "standard output";
  return outputs.points.empty() ? "the output" : outputs.points.string();
}

std::string kept_system_warning(const ChainPlan& plan, const InputCloud& cloud, const Outputs& outputs) {
  const std::optional<Crs>& crs = cloud.crs();
  const auto holds_crs = [](const OutputFormat& output) { return output.format->holds_crs; };
  if (!crs || cloud.stated_crs() || std::ranges::none_of(output_formats(outputs), holds_crs)) return "";
  const Moves moves = moves_of(plan.graph);
  if (!moves.axes[0] && !moves.axes[1] && (!moves.axes[2] || crs->vertical_epsg == 0)) return "";
  std::vector<std::string> axes;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (moves.axes[axis]) axes.push_back({"xyz"[axis]});
  return fmt::format(
      "{} changes {}, and the output states the coordinate system of the input, {}; if the new coordinates are in "
      "another system, state it with --crs and --replace-crs.",
      fmt::join(moves.stages, ", "), fmt::join(axes, ", "), short_text(*crs));
}

}  // namespace pointsweep
