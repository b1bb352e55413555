// SPDX-License-Identifier: MIT
#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "pointsweep/formats/field_names.h"
#include "pointsweep/formats/records/record_writer.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/formats/text/text_format.h"
#include "pointsweep/points/decimals.h"
#include "pointsweep/points/with_type.h"
#include "pointsweep/storage/local/output_file.h"

namespace pointsweep {
namespace {

constexpr std::size_t kFlushBytes = 1 << 20;

bool are_usual_pts_columns(const std::vector<std::string>& names) {
  using Names = std::vector<std::string>;
  return names == Names{"x", "y", "z"} || names == Names{"x", "y", "z", "intensity"} ||
         names == Names{"x", "y", "z", "intensity", "red", "green", "blue"};
}

class TextWriter final : public Writer {
 public:
  explicit TextWriter(const OutputPlan& plan)
      : plan_(plan),
        separator_(extension_of(plan.path) == ".csv" ? ',' : ' '),
        file_(plan.path, plan.overwrite, plan.temp_folder) {
    for (const Field& field : plan.schema.fields) {
      decimals_.emplace_back(field);
      is_coordinate_.push_back(field.name == "x" || field.name == "y" || field.name == "z");
    }
    const auto names = column_names(plan.schema);
    if (std::string changed = changed_names(plan.path, "text", plan.schema, names); !changed.empty())
      add_warning(std::move(changed));
    const std::string extension = extension_of(plan.path);
    if (extension == ".pts") append(fmt::format("{}\n", plan.count));
    if (extension != ".pts" || !are_usual_pts_columns(names)) {
      if (extension != ".csv") append("# ");
      append(fmt::format("{}\n", fmt::join(names, std::string_view(&separator_, 1))));
    }
    // Programs that read .csv take the first line as names and all other lines as rows.
    if (extension == ".csv") return;
    for (const std::string& line : plan.provenance) append("# " + line + "\n");
  }

  void write(std::span<const std::byte> records) override {
    const std::size_t stride = plan_.schema.stride;
    const std::size_t rows = records.size() / stride;
    require_announced(plan_, rows_written_, rows);
    for (std::size_t i = 0; i < rows; ++i) {
      append_row(records.data() + i * stride);
      if (text_.size() >= kFlushBytes) flush();
    }
    rows_written_ += rows;
  }

  void finish() override {
    require_all(plan_, rows_written_);
    flush();
    if (rounds_)
      add_warning(fmt::format("{}: coordinates are rounded to {} {} after the decimal point.", plan_.path.string(),
                              *plan_.layout.decimals, *plan_.layout.decimals == 1 ? "digit" : "digits"));
    file_.seal();
  }

 private:
  void append(std::string_view text) { text_.append(text); }

  void append_row(const std::byte* record) {
    bool first = true;
    for (std::size_t f = 0; f < plan_.schema.fields.size(); ++f) {
      for (std::uint32_t c = 0; c < plan_.schema.fields[f].count; ++c) {
        if (!first) text_.push_back(separator_);
        first = false;
        append_value(f, record, c);
      }
    }
    text_.push_back('\n');
  }

  void append_value(std::size_t f, const std::byte* record, std::uint32_t component) {
    const Field& field = plan_.schema.fields[f];
    if (plan_.layout.decimals && is_coordinate_[f]) return append_rounded(value_of(field, record, component));
    if (!field.is_plain()) {
      append_number(decimals_[f].of(value_of(field, record, component)));
      return;
    }
    with_type(field.type, [&]<class T>() {
      T value;
      std::memcpy(&value, record + field.offset + component * sizeof value, sizeof value);
      append_number(value);
    });
  }

  template <class T>
  void append_number(T value) {
    if constexpr (std::is_floating_point_v<T>)
      if (std::isnan(value)) value = std::numeric_limits<T>::quiet_NaN();  // NaN has no sign in text
    fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{}"), value);
  }

  void append_rounded(double value) {
    const std::size_t from = text_.size();
    fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{:.{}f}"), value, *plan_.layout.decimals);
    double written = 0;
    if (rounds_ || !std::isfinite(value)) return;
    std::from_chars(text_.data() + from, text_.data() + text_.size(), written);
    // A coordinate that is integer * scale + offset may differ from its decimal number by rounding errors.
    rounds_ = std::abs(written - value) > 4 * std::numeric_limits<double>::epsilon() * std::abs(value);
  }

  void flush() {
    file_.append(std::as_bytes(std::span(text_.data(), text_.size())));
    bytes_written_ += text_.size();
    text_.clear();
  }

  OutputPlan plan_;
  std::vector<GridDecimals> decimals_;  ///< for each field
  std::vector<bool> is_coordinate_;     ///< for each field
  bool rounds_ = false;                 ///< a coordinate has more digits than are written
  char separator_;
  OutputFile file_;
  fmt::memory_buffer text_;
  std::uint64_t rows_written_ = 0;
};

constexpr std::string_view kTextExtensions[] = {".xyz", ".txt", ".asc"};
constexpr std::string_view kPtsExtensions[] = {".pts"};
constexpr std::string_view kCsvExtensions[] = {".csv"};

constexpr std::string_view kLayout[] = {"decimals"};

}  // namespace

StoredCoordinate text_stored_coordinate(const OutputPlan& plan) {
  const PositionFields position = position_fields(plan.schema, plan.path.string());
  const std::array<Field, 3> fields = {position.x, position.y, position.z};
  const auto is_exact = [](const Field& field) { return field.is_plain() && field.type != Type::f32; };
  if (!plan.layout.decimals && std::ranges::all_of(fields, is_exact)) return {};
  const std::array<GridDecimals, 3> decimals = {GridDecimals(fields[0]), GridDecimals(fields[1]),
                                                GridDecimals(fields[2])};
  return [fields, decimals, digits = plan.layout.decimals](std::size_t axis, double value) {
    if (!std::isfinite(value)) return value;
    if (!digits && fields[axis].type != Type::f32) return decimals[axis].of(value);
    const std::string text =
        digits ? fmt::format("{:.{}f}", value, *digits) : fmt::format("{}", static_cast<float>(value));
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  };
}

std::unique_ptr<Writer> create_text_writer(const OutputPlan& plan) { return std::make_unique<TextWriter>(plan); }

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
