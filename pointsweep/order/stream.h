// SPDX-License-Identifier: MIT
/// The ordered stream: the slabs of a cloud in order, made by a pass of distribution.h (paper Sections 3 and 7.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/order/canonical_order.h"
#include "pointsweep/order/local_spacing.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/points/row_box.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// A contiguous piece of the stream, roughly the points between two planes across the axis; the unit of reading.
struct Slab {
  std::uint64_t first = 0;  ///< number of points in the slabs before this slab
  std::uint64_t count = 0;
  Box box;                      ///< tight box of the points, in double precision
  std::uint64_t least_row = 0;  ///< lower bound of the input rows of the points
  bool is_halo = false;         ///< true if the points only serve as neighbours of the points of a part (StoredSlabs)
};

struct StreamOptions {
  int axis = 0;
  std::uint64_t slab_points = 65536;  ///< number of points that a slab should have
  std::uint64_t max_slab_points = 0;  ///< larger slabs are split again; 0: twice slab_points
  /// True for slabs in canonical order, which an output in that order needs. False for slabs in the order in which a
  /// sweep should read them.
  bool canonical = true;
  bool whole_records = false;  ///< working records (working_record.h) contain all fields, not just `payload`
  /// True if the records of the source are working records already, whose last field is the row. False if the row of a
  /// record is its place in the source.
  bool numbered = false;
  std::vector<std::size_t> payload = {};  ///< indices of further source fields in working records
  SpillPlace spill = nullptr;             ///< where records are stored; null: in memory
  std::size_t buffer_bytes = 64 << 20;    ///< bytes of the buffers of the distribution
  std::function<void(std::uint64_t rows_read)> progress = {};
};

/// Options of a stream that makes slabs from the input when they are read.
struct OnDemandOptions {
  std::vector<RowBox> boxes;       ///< no block of rows that are decoded together crosses the end of the rows of a box
  std::uint64_t block_rows = 0;    ///< most rows of a block; 0: chosen by the stream
  std::size_t read_ahead = 1;      ///< number of slabs that are read at once
  std::uint64_t most_waiting = 0;  ///< most points that may be decoded and wait for their slabs
};

/// Slabs of a part of a cloud (part/part_stream.h), which a process sweeps alone. Functions read their records. The
/// first slabs are swept; later slabs are for the recall, which reads slabs again for points that the sweep could not
/// finish (sweep/recall.h).
struct StoredSlabs {
  int axis = 0;
  std::vector<Slab> slabs;
  std::size_t swept_slabs = 0;  ///< Stream::swept_slabs()
  Schema record_schema;         ///< Stream::record_schema()
  std::uint64_t nonfinite_count = 0;
  std::function<void(std::size_t slab, std::span<std::byte> out)> read;  ///< reads a slab like Stream::read()
  std::function<void(std::uint64_t first, std::span<std::byte> out)> read_nonfinite;
};

/// The ordered stream: slabs ascending in canonical order (coordinate along the axis; ties by x, then y, then z, then
/// input row). Every point of slab s precedes every point of slab s+1 in that order; inside a slab points lie in no
/// order. If StreamOptions::canonical is false, slabs keep this order only roughly: large slabs are split along any
/// axis, and points in sparse places have slabs of their own, placed among the other slabs by the least coordinate
/// along the axis. Points with a NaN or infinite coordinate are in no slab; read_nonfinite() reads them.
class Stream {
 public:
  /// Performs the distribution pass on all threads: reads the source once, and the stored records of too large slabs
  /// again to split them. Throws Error if the source or the temporary folder fails.
  Stream(const PointSource& source, const Survey& survey, const StreamOptions& options);
  /// Decodes a stream whose records are in the kept file options.spill (SpillPlace), without reading the source. The
  /// schema and number of points of the source, and the options for records, must equal those of the encoded stream.
  Stream(Decoder& in, const PointSource& source, const StreamOptions& options);
  /// Makes a stream without a distribution pass: reads the source once to count the points of each slab; reads of slabs
  /// decode the source again, twice for a slab that is read twice. Spills nothing. Copies the functions of the source,
  /// which must have for_thread(). Returns an empty optional if a stream on demand is not possible: then `why_not`
  /// holds the reason, as the end of a sentence.
  static std::optional<Stream> on_demand(const PointSource& source, const Survey& survey, const StreamOptions& options,
                                         const OnDemandOptions& how, std::string& why_not);
  explicit Stream(StoredSlabs stored);
  Stream(Stream&&) noexcept;
  ~Stream();
  /// Encodes the slabs and where the kept file has their records. Only for a stream whose records are in a kept file.
  void encode(Encoder& out) const;

  int axis() const { return axis_; }
  const std::vector<Slab>& slabs() const { return slabs_; }
  /// Returns the number of slabs that a sweep reads: all slabs, or the first slabs of a part of a cloud (StoredSlabs).
  std::size_t swept_slabs() const { return swept_slabs_; }
  /// Returns the spacing of the cloud if a slab may have points in sparse places and others; else an object without
  /// sparse places.
  const LocalSpacing& spacing_in_slabs() const { return spacing_; }
  std::uint64_t nonfinite_count() const { return nonfinite_count_; }
  std::uint64_t spilled_bytes() const;
  /// Returns the bytes of memory that the stored records take; 0 for a stream on demand.
  std::uint64_t memory_bytes() const;

  /// Returns the layout of working records: the fields of the source that StreamOptions requests, with their names,
  /// types and scales (x, y, z first, unless whole_records), then the input row as the last field: u32 if all rows fit,
  /// else u64, named "row".
  const Schema& record_schema() const { return record_schema_; }
  /// Reads all working records of a slab. `out.size()` = count * record_schema().stride. Thread-safe.
  void read(std::size_t slab, std::span<std::byte> out) const;
  /// Reads as many working records of the nonfinite points as fill `out`, from number `first` on, ascending by row.
  void read_nonfinite(std::uint64_t first, std::span<std::byte> out) const;

 private:
  int axis_ = 0;
  std::vector<Slab> slabs_;
  std::size_t swept_slabs_ = 0;
  LocalSpacing spacing_;
  std::uint64_t nonfinite_count_ = 0;
  Schema record_schema_;
  struct State;
  Stream(int axis, std::unique_ptr<State> state);
  void number_slabs();

  std::unique_ptr<State> state_;  ///< null for slabs that are stored elsewhere
  StoredSlabs stored_;
};

}  // namespace pointsweep
