// SPDX-License-Identifier: MIT
#include "pointsweep/formats/text/text_format.h"

#include "pointsweep/formats/format.h"

namespace pointsweep {
namespace {

constexpr std::string_view kTextExtensions[] = {".xyz", ".txt", ".asc"};
constexpr std::string_view kPtsExtensions[] = {".pts"};
constexpr std::string_view kCsvExtensions[] = {".csv"};

constexpr std::string_view kLayout[] = {"decimals"};

}  // namespace

const Format kTextFormat = {.name = "text",
                            .title = "text",
                            .details = "",
                            .reads = "columns separated by spaces, tabs, commas, semicolons or bars",
                            .writes = "columns separated by spaces",
                            .extensions = kTextExtensions,
                            .fits = fits_text,
                            .open = open_text,
                            .open_columns = open_text_columns,
                            .create = create_text_writer,
                            .holds_provenance = true,
                            .is_sequential = true,
                            .layout = kLayout,
                            .stored_coordinate = text_stored_coordinate};

const Format kPtsFormat = {.name = "text",
                           .title = "PTS",
                           .details = "#ptx-and-pts",
                           .reads = "as text, with the number of points in front, also of several scans",
                           .writes = "the number of points, then columns separated by spaces",
                           .extensions = kPtsExtensions,
                           .create = create_text_writer,
                           .holds_provenance = true,
                           .is_sequential = true,
                           .layout = kLayout,
                           .stored_coordinate = text_stored_coordinate};

const Format kCsvFormat = {.name = "text",
                           .title = "CSV",
                           .details = "",
                           .reads = "as text",
                           .writes = "columns separated by commas",
                           .extensions = kCsvExtensions,
                           .create = create_text_writer,
                           .is_sequential = true,
                           .layout = kLayout,
                           .stored_coordinate = text_stored_coordinate};

}  // namespace pointsweep
