// SPDX-License-Identifier: MIT
/// The functions that fill the extension module. Each comment ends with the source file that holds the function.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// Adds the functions run, run_to_blocks, plan, canonical_stages, neighbors and radius_neighbors, the class
/// SpilledArrays, and the values default_neighbors and run_options (runs.cpp).
void bind_runs(nanobind::module_& module);
/// Adds list_files and describe, which list point files and read their headers, and extension_of (files.cpp).
void bind_files(nanobind::module_& module);
/// Adds functions about URLs and the objects that they name: reads_urls, known_place, object_state, get_object,
/// put_object, list_objects and remove_object (urls.cpp).
void bind_urls(nanobind::module_& module);
/// Adds generate and shape_names, which make points on known shapes (generated.cpp).
void bind_generate(nanobind::module_& module);
/// Adds wkt_crs, parse_crs, las_crs, short_text and differ, about coordinate reference systems (crs_values.cpp).
void bind_crs(nanobind::module_& module);
/// Adds functions that inspect points: summarize, statistics, render, and verify, which checks the output of a run
/// (checks.cpp).
void bind_checks(nanobind::module_& module);
/// Adds the functions that plan a run of many processes, perform a task of it, join the results of tasks, and remove
/// what tasks left; the tuple left_by_tasks, and the functions with_absolute_files and available_memory (parts.cpp).
void bind_parts(nanobind::module_& module);
/// Adds the class PointBatch (point_batch.cpp).
void bind_point_batch(nanobind::module_& module);

}  // namespace pointsweep
