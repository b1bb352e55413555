// SPDX-License-Identifier: MIT
#include "cli/tool.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "cli/console/console.h"
#include "cli/console/interrupt.h"
#include "cli/console/program.h"
#include "cli/text/help.h"
#include "cli/text/operator_listing.h"
#include "cli/verbs/commands.h"
#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"
#include "pointsweep/program/process.h"
#include "pointsweep/url.h"
#include "reference/engine.h"

namespace pointsweep {
namespace {

int fail_with(int status, const std::string& sentence) {
  report(Severity::error, sentence);
  return status;
}

/// Returns whether the command line is the name of an operator alone: "pointsweep voxel" means "pointsweep help voxel",
/// unless a verb has this name.
bool names_operator_alone(const CLI::App& app, int argc, char** argv) {
  return argc == 2 && find_verb(app, argv[1]) == nullptr && !command_of_operator(argv[1]).empty();
}

int parse_and_run(CLI::App& app, int argc, char** argv) {
  try {
    if (names_operator_alone(app, argc, argv))
      print(help_of_operator(argv[1]));
    else
      app.parse(argc, argv);
    return 0;
  } catch (const CLI::CallForVersion& version) {
    print(std::string(version.what()) + "\n");
    return 0;
  } catch (const CLI::CallForHelp&) {
    print(app.help());
    return 0;
  } catch (const CLI::ParseError& error) {
    return fail_with(2, usage_sentence(app, error));
  } catch (const UsageError& error) {
    return fail_with(2, error.what());
  } catch (const NotChecked& remainder) {
    report(Severity::warning, remainder.what());
    return 3;
  } catch (const Cancelled&) {
    const OutputsSoFar outputs = outputs_so_far();
    return fail_with(128 + interrupting_signal(),
                     fmt::format("stopped; {}", outputs.any_is_complete   ? "outputs that were complete by then stay"
                                                : outputs.any_is_streamed ? "what standard output has got is incomplete"
                                                                          : "no output was written"));
  } catch (const std::bad_alloc&) {
    return fail_with(1, "the machine has no memory left for this; lower --memory or close other programs");
  } catch (const std::exception& error) {
    if (outputs_so_far().reader_has_ended) return 0;
    // After an interruption, threads that still run may fail because files have been removed.
    return fail_with(interrupted() ? 128 + interrupting_signal() : 1, error.what());
  }
}

/// The arguments of the command line after with_known_places(), which removes passwords and signatures from URLs.
class KnownArguments {
 public:
  KnownArguments(int argc, char** argv) {
    for (int i = 0; i < argc; ++i) texts_.push_back(with_known_places(argv[i]));
    for (std::string& text : texts_) pointers_.push_back(text.data());
    pointers_.push_back(nullptr);
  }
  char** argv() { return pointers_.data(); }

 private:
  std::vector<std::string> texts_;
  std::vector<char*> pointers_;
};

}  // namespace

int run_tool(int argc, char** given) {
  keep_little_free_memory();
  open_console();
  register_reference_engine();
  CLI::App app{
      "Computes normals, curvatures, splats and other local attributes of point clouds of any size, exactly and within "
      "a memory budget.",
      "pointsweep"};
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "Show this help");
  app.set_version_flag("--version", version_text, "Show version, build, instruction set and formats");
  app.require_subcommand(1);
  app.footer(
      "'pointsweep help VERB' explains a verb. Exit status: 0 success; 1 an error of a file or of the machine; 2 an "
      "error of the command line; 3 'verify' could not check everything; 128 + N stopped by signal N.\n"
      "\nExample:\n"
      "  pointsweep normals scan.ply normals.ply -k 12 --memory 2G");
  KnownArguments arguments(argc, given);
  char** const argv = arguments.argv();
  add_verbs(app, argc > 1 ? argv[1] : "");
  keep_command_line(argc, argv);

  catch_interrupts();
  if (argc <= 1) return fail_with(2, "name a verb, as in the example below.\n\n" + app.help());
  const CancellationScope scope(&interrupt_token());
  const int status = parse_and_run(app, argc, argv);
  if (status != 0 || printing_error() == 0) return status;
  return fail_with(1, fmt::format("standard output cannot be written: {}; redirect it to another place.",
                                  std::generic_category().message(printing_error())));
}

}  // namespace pointsweep
