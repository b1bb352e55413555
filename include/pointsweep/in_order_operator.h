// SPDX-License-Identifier: MIT
/// Operators that take all points of the cloud in order along an axis: they drop rows, make attributes, or both.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/operator.h"

namespace pointsweep {

class Scratch;

/// A batch of points for an InOrderWork. All batches ascend by place along one axis, then by x, y and z of the place,
/// then by row, so points of one place are consecutive.
struct OrderedPoints {
  std::span<const Vec3> places;         ///< places by which the points ascend (Places)
  std::span<const Vec3> positions;      ///< positions, which are finite
  std::span<const std::uint64_t> rows;  ///< rows in the input, ascending for equal places
  std::span<const double> values;       ///< components of InOrderContract::reads, point after point
  /// The values in the types of their fields, each at the beginning of its 8 bytes. Whole numbers of 64 bits are exact
  /// here.
  std::span<const std::array<std::byte, 8>> words;
};

/// The results of a call to an InOrderWork. All calls of a run together may name each row at most once. A row that is
/// never named is kept, with Attribute::fill as the value of the made attributes.
struct Findings {
  std::vector<std::uint64_t> dropped;    ///< rows that later stages and the output lack
  std::vector<std::uint64_t> rows;       ///< rows that are kept and whose made values are known
  std::vector<std::byte> values;         ///< made attributes of `rows`, row after row
  std::vector<std::uint64_t> undecided;  ///< rows whose result depends on points that may be missing (Reach::is_guess)
};

/// The work of an operator in one run over all points. Its findings depend only on the set of points, not on their
/// division into batches and not on the axis.
class POINTSWEEP_EXPORT InOrderWork {
 public:
  virtual ~InOrderWork() = default;
  /// Returns the number of rounds, in each of which the work takes all points.
  virtual unsigned rounds() const { return 1; }
  /// Takes the next points of round `round`, which counts from 0. Appends all findings that are then known, also
  /// findings about earlier points.
  virtual void add(unsigned round, const OrderedPoints& points, Findings& findings) = 0;
  /// Called after the last point of a round.
  virtual void end(unsigned round, Findings& findings) { (void)round, (void)findings; }
  /// Returns a warning about all points of the cloud, without the name of the operator; empty if there is none. Called
  /// after the last round.
  virtual std::string warning() const { return ""; }
};

/// Makes an empty file in the temporary folder.
using MakeScratch = std::function<std::unique_ptr<Scratch>()>;

/// Finite points of another cloud. They ascend along the axis, then by x, y and z, then by row.
struct OtherPoints {
  std::span<const Vec3> positions;
  std::span<const std::uint64_t> rows;
  std::span<const std::byte> values;  ///< values of InOrderOperator::other_reads(), point after point
};

/// Passes all finite points of another cloud to `take`, in their order.
using GiveOtherPoints = std::function<void(const std::function<void(const OtherPoints&)>& take)>;

/// The setting of an InOrderWork: its axis, its memory, and access to files and to the other cloud.
struct InOrderSetup {
  int axis = 0;                    ///< axis along which places ascend; 0 or 1 for Places::in_plane
  std::uint64_t memory_bytes = 0;  ///< most memory that the work may use
  MakeScratch make_scratch = {};
  GiveOtherPoints other_points = {};  ///< passes on the points of InOrderOperator::other_cloud()
  /// Returns whether points of the cloud within a distance of a position may be missing. Empty: no points are missing.
  /// Called only by operators whose Reach is an estimate (Reach::is_guess).
  std::function<bool(Vec3 position, double distance)> may_lack = {};
};

/// Facts about the cloud that an InOrderWork will take, some of them estimated from a sample of its points.
struct CloudEstimate {
  std::uint64_t points = 0;
  std::span<const Vec3> sample;  ///< positions of a sample of the points, which are finite
  int axis = 0;                  ///< axis along which places will ascend
  unsigned threads = 1;          ///< number of threads of the run
  /// Estimates the largest number of points between two planes across the axis, `thickness` apart.
  std::function<std::uint64_t(double thickness)> slice_points;
};

/// The estimated time of an in-order operator, without the time for reading the points, within a factor of about two.
struct InOrderEffort {
  double seconds = 0;       ///< CPU time on one core of 2.6 GHz
  std::string cause = {};   ///< cause of the effort, for a sentence: "The window"
  std::string text = {};    ///< measure of the cause: "disks of up to 100 cells"
  std::string remedy = {};  ///< advice to the user: "larger cells take less"
};

/// The places by which points ascend.
enum class Places : std::uint8_t {
  positions,    ///< the positions of the points
  of_operator,  ///< InOrderOperator::place_of() of the positions
  in_plane,     ///< InOrderOperator::place_of() of the positions, with z = 0: points ascend along x or y
};

/// The points that an operator needs for its finding about a point, if it does not need all points. The cloud may then
/// be divided into parts.
struct Reach {
  /// With `nearest` = 0, the operator needs all points whose places are within this distance of the place of the point
  /// along each axis. Otherwise, the largest distance at which the operator needs a nearest point.
  double distance = 0;
  std::size_t nearest = 0;  ///< number of nearest points that the operator needs (in the plane with in_plane), or 0
  /// True if the distance does not suffice in all cases. A part that reports Findings::undecided is repeated with twice
  /// the distance.
  bool is_guess = false;
};

struct InOrderContract {
  std::vector<Attribute> reads = {};  ///< attributes of the point itself, in addition to its position
  std::vector<Attribute> makes = {};
  bool drops_rows = false;  ///< true if the operator may drop rows, which later stages and the output then lack
  Places places = Places::positions;
  std::string arrival = {};  ///< order of the points as a phrase for the dry run: "equal ones together"
};

/// An operator that takes all points with finite coordinates in order. Points with non-finite coordinates are kept:
/// their positions, and attributes that the operator both reads and makes, stay unchanged; other made attributes are
/// Attribute::fill.
class POINTSWEEP_EXPORT InOrderOperator : public Operator {
 public:
  virtual InOrderContract in_order_contract() const = 0;
  /// Returns a new work for one run over the cloud.
  virtual std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const = 0;
  /// Returns the place by which a point with this finite position is ordered. Called from many threads at once.
  virtual Vec3 place_of(Vec3 position) const { return position; }
  /// Returns the least memory of a work on `cloud`, in bytes.
  virtual std::uint64_t least_bytes(const CloudEstimate& cloud) const {
    (void)cloud;
    return 0;
  }
  /// Returns the estimated time of a work on `cloud`.
  virtual InOrderEffort effort(const CloudEstimate& cloud) const {
    (void)cloud;
    return {};
  }
  /// Returns the points of the cloud on which the finding about a point depends; nothing if it may depend on any point.
  /// If a Reach is returned, places must ascend along each axis with the positions.
  virtual std::optional<Reach> reach() const { return std::nullopt; }
  /// A function that returns the indices of the points of a batch that other parts of the cloud need; it may return
  /// more. Called from many threads at once.
  using ChoosePoints = std::function<std::vector<std::uint32_t>(const OrderedPoints& points)>;
  /// Returns the function that chooses the points that other parts of the cloud need; empty if other parts need all
  /// points.
  virtual ChoosePoints for_other_parts() const { return {}; }
  /// Returns the path, folder or pattern of the other cloud that the operator reads; empty if it reads none.
  virtual std::string other_cloud() const { return {}; }
  /// Returns the attributes of the points of the other cloud that the operator reads, in addition to their positions.
  /// After bound_to_other(), these attributes have the names and types of the fields of the other cloud.
  virtual std::vector<Attribute> other_reads() const { return {}; }
  /// Returns the points of the other cloud on which the finding about a point depends, like reach().
  virtual std::optional<Reach> other_reach() const { return std::nullopt; }
  /// Returns the operator for another cloud with these fields. Called before bound(), and only if other_reads() is not
  /// empty. Throws UsageError for a name that no field has.
  virtual std::shared_ptr<const InOrderOperator> bound_to_other(const Schema& other) const {
    (void)other;
    return nullptr;
  }
  /// Returns the operator for a cloud with the fields of `input`, after stages that make `made`; null if its contract
  /// does not depend on either.
  virtual std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const {
    (void)input, (void)made;
    return nullptr;
  }

  Contract contract() const final {
    InOrderContract own = in_order_contract();
    if (own.drops_rows) own.makes.push_back(selection_attribute());
    return {.reads = std::move(own.reads), .makes = std::move(own.makes), .default_k = 0};
  }
};

}  // namespace pointsweep
