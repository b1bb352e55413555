// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <span>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/e57/e57_format.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/records/record_writer.h"
#include "pointsweep/row_error.h"
#include "pointsweep/storage/local/output_file.h"

#if POINTSWEEP_CODECS
#include <pointsweep_codecs.h>
#endif

namespace pointsweep {

#if POINTSWEEP_CODECS

namespace {

constexpr std::size_t kBatchPoints = 4096;
constexpr std::uint64_t kInvalid = 2;  ///< value of cartesianInvalidState for coordinates without meaning

/// Returns a GUID in the notation of E57. The GUID depends only on the number and the fields of the points and on the
/// provenance, so that equal runs give equal bytes.
std::string identifier_of(const OutputPlan& plan) {
  std::uint64_t state[2] = {0xcbf29ce484222325u, 0x84222325cbf29ce4u};  // FNV-1a with two initial values
  const auto add = [&](std::string_view bytes) {
    for (const char c : bytes)
      for (std::uint64_t& s : state) s = (s ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  };
  add(fmt::format("{} {}\n", plan.count, plan.schema.stride));
  for (const Field& field : plan.schema.fields) add(fmt::format("{} {}\n", field.name, static_cast<int>(field.type)));
  for (const std::string& line : plan.provenance) add(line + "\n");
  const std::uint64_t version = (state[0] & ~0xf000ull) | 0x8000, variant = (state[1] & ~(3ull << 62)) | 1ull << 63;
  return fmt::format("{{{:08X}-{:04X}-{:04X}-{:04X}-{:012X}}}", version >> 32, version >> 16 & 0xffff, version & 0xffff,
                     variant >> 48, variant & 0xffffffffffff);
}

psc_e57_attribute codec_attribute(const E57Attribute& a) {
  psc_e57_attribute out{};
  if (a.name.size() >= sizeof out.name)
    fail("the name of attribute '{}' is too long for E57; leave it out by --keep.", a.name);
  std::ranges::copy(a.name, out.name);
  out.kind = static_cast<std::int32_t>(a.kind);
  out.least = a.least;
  out.most = a.most;
  out.scale = a.scale;
  out.offset = a.offset;
  return out;
}

E57Attribute invalid_state() {
  return {.name = "cartesianInvalidState", .kind = E57Attribute::Kind::integer, .least = 0, .most = kInvalid};
}

class E57Writer final : public Writer {
 public:
  explicit E57Writer(const OutputPlan& plan)
      : plan_(plan), columns_(e57_columns(plan.schema)), file_(plan.path, plan.overwrite, plan.temp_folder) {
    if (plan.crs && plan.crs->wkt.empty())
      add_warning(
          fmt::format("{}: E57 holds coordinate reference systems as WKT; {}, which the input states by GeoTIFF "
                      "keys alone, is left out.",
                      plan.path.string(), short_text(*plan.crs)));
    if (std::string changed = changed_e57_names(plan.path, plan.schema); !changed.empty())
      add_warning(std::move(changed));
    std::vector<psc_e57_attribute> attributes;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      attributes.push_back(codec_attribute(columns_[c].attribute));
      if (c == 2) attributes.push_back(codec_attribute(invalid_state()));
    }
    width_ = attributes.size();
    const std::string guid = identifier_of(plan), made = fmt::format("{}", fmt::join(plan.provenance, "\n"));
    const psc_e57_about about{guid.c_str(), made.c_str(), plan.crs ? plan.crs->wkt.c_str() : ""};
    psc_error error;
    require(psc_e57_writer_create(read_back, write_out, this, attributes.data(), width_, &about, &codec_, &error),
            error);
  }
  ~E57Writer() override { psc_e57_writer_free(codec_); }
  E57Writer(const E57Writer&) = delete;
  E57Writer& operator=(const E57Writer&) = delete;

  void write(std::span<const std::byte> records) override {
    const std::size_t stride = plan_.schema.stride, rows = records.size() / stride;
    require_announced(plan_, rows_written_, rows);
    for (std::size_t first = 0; first < rows; first += kBatchPoints) {
      stop_if_cancelled();
      const std::size_t n = std::min(kBatchPoints, rows - first);
      values_.resize(n * width_);
      for (std::size_t i = 0; i < n; ++i)
        put(rows_written_ + first + i, records.data() + (first + i) * stride, values_.data() + i * width_);
      psc_error error;
      require(psc_e57_write(codec_, values_.data(), values_.size(), &error), error);
    }
    rows_written_ += rows;
  }

  void finish() override {
    require_all(plan_, rows_written_);
    psc_error error;
    require(psc_e57_writer_finish(codec_, &error), error);
    psc_e57_writer_free(codec_);
    codec_ = nullptr;
    if (partly_finite_ > 0)
      add_warning(fmt::format(
          "{}: E57 marks a point as invalid as a whole, so {} {} of which only some coordinates are finite {} these "
          "coordinates; PLY keeps them.",
          plan_.path.string(), partly_finite_, partly_finite_ == 1 ? "point" : "points",
          partly_finite_ == 1 ? "loses" : "lose"));
    file_.seal();
  }

 private:
  /// Stores the values of one point.
  void put(std::uint64_t row, const std::byte* record, std::uint64_t* values) {
    int finite_axes = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      finite_axes += std::isfinite(value_of(columns_[axis].field, record)) ? 1 : 0;
    const bool finite = finite_axes == 3;
    if (!finite && finite_axes > 0) ++partly_finite_;
    for (std::size_t axis = 0; axis < 3; ++axis) *values++ = finite ? columns_[axis].stored(record) : 0;
    *values++ = finite ? 0 : kInvalid;
    for (std::size_t c = 3; c < columns_.size(); ++c) {
      const E57Column& column = columns_[c];
      *values = column.stored(record);
      if (column.field.type == Type::u64 && *values > static_cast<std::uint64_t>(column.attribute.most))
        throw RowError(row, {plan_.path.string() + ": row ",
                             fmt::format(": '{}' is {}, but E57 holds integers up to 2^63 - 1; leave it out by --keep.",
                                         column.field.name, *values)});
      ++values;
    }
  }

  /// Throws the exception of a callback, else the error of the codec, unless `status` is 0.
  void require(int status, const psc_error& error) {
    if (status == 0) return;
    if (met_) std::rethrow_exception(std::exchange(met_, nullptr));
    fail("{}: cannot be written: {}.", plan_.path.string(), error.text);
  }

  static std::ptrdiff_t read_back(void* self, std::uint64_t offset, std::uint8_t* into, std::size_t bytes) {
    auto& writer = *static_cast<E57Writer*>(self);
    try {
      writer.file_.read_at(offset, std::as_writable_bytes(std::span(into, bytes)));
      return static_cast<std::ptrdiff_t>(bytes);
    } catch (...) {
      writer.met_ = std::current_exception();
      return -1;
    }
  }

  static int write_out(void* self, std::uint64_t offset, const std::uint8_t* from, std::size_t bytes) {
    auto& writer = *static_cast<E57Writer*>(self);
    try {
      writer.file_.write_at(offset, std::as_bytes(std::span(from, bytes)));
      writer.bytes_written_ = std::max<std::uint64_t>(writer.bytes_written_, offset + bytes);
      return 0;
    } catch (...) {
      writer.met_ = std::current_exception();
      return -1;
    }
  }

  OutputPlan plan_;
  std::vector<E57Column> columns_;  ///< x, y, z first
  OutputFile file_;
  std::size_t width_ = 0;  ///< number of values of a point
  psc_e57_writer* codec_ = nullptr;
  std::exception_ptr met_;  ///< exception of a callback, which must not pass through C code
  std::vector<std::uint64_t> values_;
  std::uint64_t rows_written_ = 0, partly_finite_ = 0;
};

}  // namespace

std::uint64_t e57_encoder_bytes(std::uint64_t, unsigned) {
  return 4 << 20;  // memory for a packet, its points in the codec, and unwritten bytes
}

std::unique_ptr<Writer> create_e57_writer(const OutputPlan& plan) { return std::make_unique<E57Writer>(plan); }

#else

std::uint64_t e57_encoder_bytes(std::uint64_t, unsigned) { return 0; }

std::unique_ptr<Writer> create_e57_writer(const OutputPlan& plan) {
  fail(
      "{}: this pointsweep was built without its codecs (POINTSWEEP_CODECS), which E57 files need; write LAS or PLY, "
      "or install cargo and build again.",
      plan.path.string());
}

#endif

namespace {

constexpr std::string_view kE57Extensions[] = {".e57"};

bool starts_as_e57(std::string_view head) { return head.starts_with("ASTM-E57"); }

/// Returns 0 for the number of the scan and the invalid state, since an output is one scan; nothing for other names.
std::optional<double> own_field(std::string_view name) {
  if (name == "scan" || name == "invalid_state") return 0;
  return std::nullopt;
}

}  // namespace

const Format kE57Format = {.name = "E57",
                           .title = "E57",
                           .details = "#e57",
                           .reads = "all scans as one cloud, poses applied",
                           .writes = "one scan",
                           .extensions = kE57Extensions,
                           .codec = "E57",
                           .is = starts_as_e57,
                           .open = open_e57,
                           .create = create_e57_writer,
                           .holds_crs = true,
                           .holds_provenance = true,
                           .loses_nonfinite = true,
                           .encoder_bytes = e57_encoder_bytes,
                           .name_bytes = 252,
                           .stored_name = e57_name,
                           .own_field = own_field};

}  // namespace pointsweep
