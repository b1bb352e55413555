// SPDX-License-Identifier: MIT
/// The report of a run, as a page, and the choice of the result that its picture shows. Programs that include this
/// header link pointsweep::report.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/export.h"
#include "pointsweep/program/render.h"
#include "pointsweep/statistics.h"

namespace pointsweep {

/// A summary of the numbers in one field that a run has made: quantiles and a histogram.
struct ValueSummary {
  std::string name = {};        ///< name of the field, e.g. "nx" or "mean_curvature"
  std::string unit = {};        ///< unit of the numbers, e.g. "1/m"; empty if they have none or it is unknown
  std::uint64_t values = 0;     ///< number of values read
  std::uint64_t undefined = 0;  ///< number of NaN and infinite values among them
  /// Least, 5 %, 25 %, 50 %, 75 %, 95 % quantile and greatest of the finite values.
  std::array<double, 7> quantiles{};
  /// Edges and counts of the histogram. Bin i is edges[i] .. edges[i + 1]; the first and the last bin also count values
  /// beyond their outer edges. Both are empty if no value is finite.
  std::vector<double> edges = {}, counts = {};
};

/// Returns a summary of each field named in `fields`, in the order of `schema`; fields with several numbers a point are
/// left out. Bins are equally wide over the middle 99 % of the values. Whole numbers get a bin each if there are few of
/// them. `length`: the unit of the cloud's coordinates, e.g. "m"; if it is empty, "file unit" stands for it.
POINTSWEEP_EXPORT std::vector<ValueSummary> value_summaries(const Schema& schema, std::span<const std::byte> records,
                                                            std::span<const std::string> fields,
                                                            std::string_view length);

struct RunSummary {
  std::string title;           ///< e.g. "normals of scan.ply"
  std::string inputs, output;  ///< names of the input files and of the output file
  std::string crs;             ///< coordinate reference system in words; empty if the cloud states none
  std::string unit;            ///< unit of the cloud's lengths; empty if unknown
  std::string command;         ///< the command line, as a shell takes it
  std::string version;         ///< version of the program, e.g. "0.1.0"
  Statistics statistics;
  std::optional<Rendering> picture;  ///< picture of the result
  double drawing_seconds = 0;        ///< time to read the result and draw the picture
  std::vector<ValueSummary> made;    ///< summary of each field that the run has made
};

/// Returns one self-contained HTML page. The result comes first: inputs and outputs, warnings, a picture, a histogram
/// of each made number with its quantiles, counts. The time by phase follows. The engine comes last: working set over
/// the stream, distances of neighbours (if they were counted), all other statistics.
POINTSWEEP_EXPORT std::string report_of(const RunSummary& summary);

/// Returns the colouring (RenderOptions::color) that shows the result of the last operator of a chain with a visible
/// result: after `curvature`, one of the curvatures; after `normals` and `splats`, "plain" (shading by the normals);
/// after other operators, the first of made_numbers() that is one number a point and no part of a vector. Empty if no
/// operator has a visible result in the output.
POINTSWEEP_EXPORT std::string pictured_attribute(std::span<const std::string> operators, const Schema& input,
                                                 const Schema& output);

/// Returns the fields of the output that the operators have made: fields that the input does not have, and fields of
/// the input that an operator makes again.
POINTSWEEP_EXPORT std::vector<std::string> made_numbers(std::span<const std::string> operators, const Schema& input,
                                                        const Schema& output);

}  // namespace pointsweep
