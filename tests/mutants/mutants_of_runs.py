# SPDX-License-Identifier: MIT
"""Mistakes in runs as a whole: planning, naming, resuming, ending."""
from mutant import Mutant

SWEEP = "pointsweep/sweep/"
PIPELINE = "pointsweep/pipeline/"

MUTANTS = [
    Mutant("the reference engine's stream is in no order", "order", PIPELINE + "run/order_phase.cpp",
           "whole || run.by_reference();", "whole;", ("reference:Reference.*",)),
    Mutant("rows carried between sweeps begin at 0", "spills", PIPELINE + "updated_cloud.cpp",
           "carried->read(first + at, old);", "carried->read(at, old);", ("pipeline:Reneighbor.*",)),
    Mutant("points of infinite position are lost in sweep order", "order", PIPELINE + "ordered_output.cpp",
           "{ write({record, bytes}); });", "{ if (bytes == 0) write({record, bytes}); });",
           ("pipeline:Sort.*:Run.*", "cli:NonfinitePoints.*")),
    Mutant("a recalled point's place is its index", "recall", PIPELINE + "result_sinks.cpp",
           "kept_[{slab, index}] = {stream_.slabs()[slab].first + open.rank[index],",
           "kept_[{slab, index}] = {stream_.slabs()[slab].first + index,", ("pipeline:Run.*",)),
    Mutant("a resumed run reads no slab twice", "resume", SWEEP + "sweep_restart.cpp",
           "return slab - std::min(slab, static_cast<std::uint32_t>(plan_.step_count()));", "return slab;",
           ("pipeline:Resume.*:Refused.*",)),
    Mutant("a resumed run forgets the dropped cells", "resume", SWEEP + "sweep_restart.cpp",
           "if (slab < first_slab_) frontier.cell_was_dropped", "if (slab > first_slab_) frontier.cell_was_dropped",
           ("pipeline:Resume.*:Refused.*",)),
    Mutant("a resumed run forgets the deferred points", "resume", SWEEP + "sweep.cpp",
           "workers_.front().deferred = from.deferred;", "", ("pipeline:Resume.*:Refused.*",)),
    Mutant("a checkpoint in a sweep keeps the results before it", "resume", PIPELINE + "checkpoints.cpp",
           "last_.progress = packed(progress);\n  last_.results = packed(results);", "last_.progress = packed(progress);",
           ("pipeline:Resume.*:Refused.*",)),
    Mutant("another radius counts as the same run", "resume", "pointsweep/points/neighborhood_options.cpp",
           "if (std::isfinite(neighborhood.radius)) options", "if (neighborhood.radius < 0) options", ("pipeline:Resume.*:Refused.*",)),
    Mutant("a run that keeps other attributes counts as the same run", "resume", PIPELINE + "run_identity.cpp",
           "text += kept_text(plan.kept, cloud.schema());",
           "if (text.empty()) text += kept_text(plan.kept, cloud.schema());", ("pipeline:Resume.*:Refused.*",)),
    Mutant("another type of moved positions counts as the same run", "resume", PIPELINE + "run_identity.cpp",
           "if (options.moved_positions != Type::f64)", "if (options.moved_positions == Type::i32)",
           ("pipeline:Resume.*:Refused.*",)),
    Mutant("another prefix counts as the same run", "resume", PIPELINE + "run_identity.cpp",
           "options.prefix, fmt::join(options.replace, \",\")", "\"\", fmt::join(options.replace, \",\")",
           ("pipeline:Resume.*:Refused.*",)),
    Mutant("a changed input counts as the same run", "resume", PIPELINE + "run_identity.cpp",
           "info.count, state.text());", "info.count, \"\");", ("pipeline:Resume.*:Refused.*",)),

    # Provenance
    Mutant("the provenance record does not say the type of moved positions", "provenance", PIPELINE + "provenance_record.cpp",
           "set(\"positions\", options.moved_positions == Type::f64 ? \"\" :",
           "set(\"positions\", options.moved_positions != Type::i32 ? \"\" :", ("cli:Provenance.*", "cli:Naming.*")),
    Mutant("the provenance record lacks the options of stages", "provenance", PIPELINE + "canonical_text.cpp",
           "if (is_preset && presets", "if ((is_preset || !option.name.empty()) && presets", ("cli:Provenance.*",)),
    Mutant("the provenance record leaves out presets that reneighbor needs", "provenance",
           "pointsweep/operators/update_operators.cpp", "option.preset = {};", "option.preset = option.preset;",
           ("cli:Provenance.*",)),
    Mutant("the provenance record lacks the prefix", "provenance", PIPELINE + "provenance_record.cpp",
           "set(\"prefix\", options.prefix);", "", ("cli:Provenance.*", "cli:Naming.*")),
    Mutant("the provenance record does not say that points were dropped", "provenance", PIPELINE + "provenance_record.cpp",
           "set(\"nonfinite\", drops_nonfinite ? \"drop\" : \"\");", "set(\"nonfinite\", drops_nonfinite ? \"\" : \"\");", ("cli:Provenance.*", "cli:NonfinitePoints.*")),

    # Names and types of outputs
    Mutant("moved positions are float32", "outputs", PIPELINE + "output_layout.cpp",
           "moves ? *moved_positions : attribute.type;", "moves ? Type::f32 : attribute.type;", ("pipeline:Run.*", "pipeline:OutputLayout.*")),
    Mutant("moved positions keep the input's type where fields are kept by name", "outputs", PIPELINE + "output_layout.cpp",
           ".type = type->second};", ".type = field.type};", ("pipeline:Keep*", "pipeline:OutputLayout.*")),
    Mutant("attributes of the input are overwritten without --replace", "outputs", PIPELINE + "output_names.cpp",
           "if (!rules_.prefix.empty() || !means_only(old.name, own)) refuse(field, old.name, true);",
           "if (!rules_.prefix.empty() && !means_only(old.name, own)) refuse(field, old.name, true);",
           ("cli:Naming.*", "pipeline:OutputRules.*")),
    Mutant("--replace may name what nothing takes", "outputs", PIPELINE + "output_names.cpp",
           "if (!unused_.empty())\n      fail_usage(\"--replace", "if (unused_.size() > 1)\n      fail_usage(\"--replace",
           ("cli:Naming.*", "pipeline:OutputRules.*")),
    Mutant("a prefix may make a name of the input again", "outputs", PIPELINE + "output_names.cpp",
           "if (!rules_.prefix.empty() || !means_only", "if (!means_only", ("cli:Naming.*", "pipeline:OutputRules.*")),

    # Memory and time
    Mutant("the radius estimate takes the sample for the cloud", "budget", PIPELINE + "radius_estimate.cpp",
           "return static_cast<double>(within) * points_per_sample;", "return static_cast<double>(within);",
           ("pipeline:Radius.*", "pipeline:MemoryPlan.*")),
    Mutant("the memory plan does not count what the radius keeps", "budget", PIPELINE + "run_memory.cpp",
           "demand.slice_points = estimate.slice_points;", "", ("pipeline:Radius.*", "pipeline:MemoryPlan.*")),
    Mutant("the memory plan forgets what threads have in hand", "budget", PIPELINE + "memory_plan.cpp",
           "threads * thread_bytes(plan_, out_.slab_points, budget_, demand_);",
           "0 * threads * thread_bytes(plan_, out_.slab_points, budget_, demand_);", ("pipeline:MemoryPlan.*",)),
    Mutant("a refused budget names one that is refused as well", "budget", PIPELINE + "memory_plan.cpp",
           "return enough * kMega;", "return too_little * kMega;", ("pipeline:MemoryPlan.*",)),

    # The reference engine's audit
    Mutant("the audit ignores what had been written already", "reference", "reference/audit.cpp",
           "return point.written == 0 || reach2 < point.written2;", "return point.written == 0 || reach2 >= 0;",
           ("reference:Reference.*",)),
    Mutant("a batch of suspects is judged again with the next", "reference", "reference/suspects.cpp",
           "return std::exchange(waiting_, {});", "return waiting_;", ("reference:Reference.*",)),
    Mutant("the audit ignores the rule of the neighbourhood", "reference", "reference/audit.cpp",
           "const std::size_t count = shortening_.kept(suspect.point, suspect.exact.ranks());",
           "const std::size_t count = suspect.exact.ranks().size();", ("reference:ReferenceRules.*",)),
    Mutant("the audit looks at one slab too few for written points", "reference", "reference/suspects.cpp",
           "return slab.first < suspect.written &&", "return slab.first + slab.count < suspect.written &&",
           ("reference:Reference.*",)),

    # verify
    Mutant("verify takes equal distances in the order of rows", "verify", "pointsweep/verify/nearest_in_stream.cpp",
           "  if (a.position.x != b.position.x) return a.position.x < b.position.x;\n", "", ("verify",)),
    Mutant("verify does not see that a point is missing", "verify", "pointsweep/verify/verify.cpp",
           "if (a.points_in != a.points_out) differ", "if (a.points_in < a.points_out) differ",
           ("verify:Verify.AMissing*", "cli:VerifyVerb.*")),
    Mutant("verify takes points that are not finite for wherever they stand", "verify", "pointsweep/verify/arrivals.cpp",
           "if (finite && (met_nonfinite_ || p[a] < last_[a]))", "if (finite && p[a] < last_[a])", ("verify",)),

    # The command line
    Mutant("K, M, G of --memory are powers of 1000", "cli", "cli/quantities.cpp",
           "scaled(without_byte(text), 1024)", "scaled(without_byte(text), 1000)", ("cli:Quantities.*",)),

    # Selects
    Mutant("a second select counts the rows that the first left", "selects", PIPELINE + "row_mask.cpp",
           "while (before_ != nullptr && next_ < rows_ && !before_->has(next_)) append_any(false);",
           "while (before_ != nullptr && next_ > rows_ && !before_->has(next_)) append_any(false);",
           ("pipeline:Where.*:Unique.*:Select.*",)),
    Mutant("points without a place keep what a pass over rows made of them", "selects", PIPELINE + "row_pass.cpp",
           "if (!is_finite(Vec3{x[i], y[i], z[i]}))", "if (is_finite(Vec3{x[i], y[i], z[i]}) && size == 0)",
           ("pipeline:Where.*:Unique.*:Select.*",)),
]
