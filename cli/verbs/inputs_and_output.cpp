// SPDX-License-Identifier: MIT
/// The inputs and the output that a command names, and the files for which they stand.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "cli/console/console.h"
#include "cli/text/help.h"
#include "cli/verbs/common_options.h"
#include "pointsweep/files.h"
#include "pointsweep/program/formats.h"
#include "pointsweep/program/standard_streams.h"
#include "pointsweep/url.h"

namespace pointsweep {

namespace fs = std::filesystem;

namespace {

bool is_folder_name(const fs::path& path) {
  std::error_code error;
  return !is_standard_stream(path) && (!path.has_filename() || fs::is_directory(path, error));
}

/// Returns whether the last of three or more names may be meant as an input: a file, or a folder of point files, of
/// this name exists, and the folder is not the output of a run that is resumed.
bool may_be_input(const InputsAndOutput& named) {
  std::error_code error;
  if (is_url(named.output())) return false;  // opening the output refuses an object that exists
  if (!named.named_output.empty() || named.inputs_named() <= 1 || is_standard_stream(named.output())) return false;
  if (fs::is_directory(named.output(), error)) return !named.resumes && holds_point_files(named.output());
  return fs::exists(fs::symlink_status(named.output(), error));
}

void require_input_and_output(const InputsAndOutput& named) {
  if (named.inputs_named() == 0)
    refuse("IN... OUT: name at least one input file, then the output file (or name it with -o FILE).");
  if (may_be_input(named))
    refuse(
        "{}: exists, and as the last of {} files it may be an input; name the output with -o FILE, before or after the "
        "inputs.",
        named.output().string(), named.files.size());
}

/// Throws UsageError if the folder of outputs is a folder of inputs, or with --recursive lies inside of one: a later
/// run would take the outputs as inputs.
void require_no_folder_of_inputs(const InputsAndOutput& named, const fs::path& folder) {
  std::error_code error;
  const fs::path output = fs::weakly_canonical(fs::absolute(folder / "", error), error);
  for (const fs::path& input : named.inputs()) {
    if (is_url(input) && (input / "") == (folder / ""))
      refuse("{}: is also the folder of inputs, so its files would be inputs of a later run; name another folder.",
             folder.string());
    if (!fs::is_directory(input, error) || is_url(folder)) continue;
    const fs::path relative = output.lexically_relative(fs::canonical(input / "", error));
    const bool is_same = relative == "." || relative == "./" || relative.empty();
    if (is_same || (named.recursive && relative.begin()->string() != ".."))
      refuse("{}: is {} the folder of inputs {}, so its files would be inputs of a later run; name another folder.",
             folder.string(), is_same ? "also" : "in", input.string());
  }
}

void require_written_format(const fs::path& input, const fs::path& output) {
  std::error_code error;
  if (!is_url(input) && !fs::exists(input, error))
    throw Error(fmt::format("{}: no such file; check the path.", input.string()));
  if (writes_points_to(output)) return;
  refuse("{}: files named {} are not written; choose a format for the outputs, e.g. --output-format laz.",
         input.string(), extension_of(output).empty() ? "without extension" : "*" + extension_of(output));
}

/// Throws Error if the folder in which the folder of outputs would be made does not exist.
void require_place_of(const fs::path& folder) {
  std::error_code error;
  if (is_url(folder)) return;
  const fs::path parent = (folder / "").parent_path().parent_path();
  if (!parent.empty() && !fs::is_directory(parent, error))
    throw Error(fmt::format("{}: the folder {} does not exist; create it first.", folder.string(), parent.string()));
}

/// Returns the path of the files among which a run divides its output, with a * in the place of their names: OUT if it
/// has a *, else a path in the folder OUT.
fs::path divided_output(const InputsAndOutput& named, const std::vector<ListedFile>& inputs) {
  const fs::path& output = named.output();
  if (is_standard_stream(output)) refuse("-: many files are written; name a folder for them.");
  require_output_name(output);
  const bool is_pattern = output.filename().string().find('*') != std::string::npos;
  if (!is_pattern && !is_folder_name(output) && has_output_format(output))
    refuse("{}: is the name of one file, and many are written; name a folder for them.", output.string());
  const fs::path folder = is_pattern ? output.parent_path() : output;
  if (!folder.empty()) require_no_folder_of_inputs(named, folder);
  require_place_of(folder);
  if (is_pattern && !named.output_format.empty())
    refuse("--output-format: {} says the format; leave the option out, or name a folder.", output.string());
  const fs::path& first = inputs.front().path;
  const std::string own = is_standard_stream(first) ? ".ply" : extension_of(first);
  fs::path pattern = is_pattern ? output : output / ("*" + (named.output_format.empty() ? own : named.output_format));
  if (!is_standard_stream(first)) require_written_format(first, pattern);
  return pattern;
}

std::vector<fs::path> tiles_in(const InputsAndOutput& named, const std::vector<ListedFile>& inputs) {
  require_no_folder_of_inputs(named, named.output());
  require_place_of(named.output());
  std::vector<fs::path> tiles;
  std::map<fs::path, fs::path> inputs_of;
  for (const ListedFile& input : inputs) {
    if (is_standard_stream(input.path))
      refuse("-: standard input has no name for its output in a folder; name an output file.");
    tiles.push_back(named.output() / tile_name(input.relative, named.output_format));
    require_written_format(input.path, tiles.back());
    const auto [other, is_new] = inputs_of.try_emplace(tiles.back(), input.path);
    if (!is_new)
      refuse(
          "{} and {} would both be written as {}; name the folder that holds both, with --recursive, or make two runs.",
          other->second.string(), input.path.string(), tiles.back().string());
  }
  return tiles;
}

void require_folder_for_format(const InputsAndOutput& named, bool is_folder) {
  if (is_folder || named.output_format.empty() || is_standard_stream(named.output())) return;
  refuse("--output-format: {} is a file, and its name says its format; leave the option out, or name a folder or -.",
         named.output().string());
}

/// Returns the extension that --output-format states: ".laz" for "laz" and ".LAZ". Throws UsageError for an unknown
/// extension.
std::string parse_output_format(const std::string& text) {
  const std::string word = text.substr(text.starts_with('.') ? 1 : 0);
  std::string extension = extension_of("tile." + word);
  const std::vector<std::string_view> known = writable_extensions();
  // False for "copc.laz", of which extension_of() returns only the last part.
  const bool is_whole = extension.size() == word.size() + 1;
  if (!is_whole || std::ranges::find(known, extension) == known.end())
    refuse("--output-format: '{}' is not one of {}.", text, fmt::join(known, ", "));
  return extension;
}

}  // namespace

void add_files(CLI::App& verb, InputsAndOutput& paths, const std::string& output_meaning) {
  verb.add_option(kInputsAndOutput, paths.files,
                  fmt::format("Input files (merged), then output {}. A folder or a quoted pattern such as "
                              "'tiles/*.laz' stands for its point files; - is standard input or output (PLY); a URL "
                              "(https://, s3://, gs://, az://) takes the place of any path",
                              output_meaning))
      ->type_name("");
  add_recursive_option(verb, paths.recursive);
}

void add_inputs_and_output(CLI::App& verb, InputsAndOutput& paths, const std::string& output_meaning) {
  add_files(verb, paths, output_meaning);
  add_output_option(verb, paths.named_output);
}

void add_recursive_option(CLI::App& verb, bool& recursive) {
  verb.add_flag("--recursive", recursive, "Read the folders inside of folders, too")->group(kOtherGroup);
}

void add_output_format_option(CLI::App& verb, std::string& format) {
  verb.add_option_function<std::string>(
          "--output-format", [&format](const std::string& text) { format = parse_output_format(text); },
          "Format of standard output, e.g. csv (default: ply), or of all files in a folder of outputs, e.g. laz "
          "(default: that of each input)")
      ->type_name("EXT")
      ->group(kOutputGroup);
}

void add_output_option(CLI::App& verb, fs::path& output) {
  verb.add_option("-o,--output", output, "Output file or folder (default: the last argument)")
      ->type_name("FILE")
      ->group(kOutputGroup);
}

ResolvedFiles resolve(const InputsAndOutput& named, const std::string& format) {
  require_input_and_output(named);
  const bool is_folder = named.divides || is_folder_name(named.output());
  require_folder_for_format(named, is_folder);
  InputList list = list_inputs(named.inputs(), named.recursive, format);
  ResolvedFiles files{.inputs = {}, .output = named.output(), .tiles = {}, .notices = std::move(list.notices)};
  if (named.divides)
    files.output = divided_output(named, list.files);
  else if (is_folder)
    files.tiles = tiles_in(named, list.files);
  else if (is_standard_stream(named.output()))
    files.output += named.output_format;
  for (ListedFile& file : list.files) files.inputs.push_back(std::move(file.path));
  std::vector<fs::path> read = files.inputs, written = files.tiles;
  if (!is_folder) written.push_back(files.output);
  read.insert(read.end(), named.other_inputs.begin(), named.other_inputs.end());
  written.insert(written.end(), named.other_outputs.begin(), named.other_outputs.end());
  require_separate_files(read, written);
  return files;
}

void require_one_output(const ResolvedFiles& files, const char* reason) {
  if (!files.tiles.empty()) refuse("{}: is a folder, but {}; name an output file.", files.output.string(), reason);
}

}  // namespace pointsweep
