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

/// Points on their way into an InOrderWork. They ascend by place along one axis, then by x, y and z of the place, then
/// by row: points of one place follow one another.
struct OrderedPoints {
  std::span<const Vec3> places;
  std::span<const Vec3> positions;      ///< finite
  std::span<const std::uint64_t> rows;  ///< input rows, ascending for equal places
  std::span<const double> values;       ///< the components of InOrderContract::reads, of one point after another
  /// The same components, each as a value of its type in the first of 8 bytes: whole numbers of 64 bits are exact.
  std::span<const std::array<std::byte, 8>> words;
};

/// The results of a call to an InOrderWork. A run names each row at most once. A row that is named nowhere stays, and
/// has Attribute::fill of what the operator makes.
struct Findings {
  std::vector<std::uint64_t> dropped;    ///< rows that are left out from here on
  std::vector<std::uint64_t> rows;       ///< rows whose values are known
  std::vector<std::byte> values;         ///< what the operator makes of `rows`, of one row after another
  std::vector<std::uint64_t> undecided;  ///< rows about which points decide that may be missing (Reach::is_guess)
};

/// One run of an operator over all points. Its findings depend only on the set of points, not on how they are divided
/// into calls, nor on the axis.
class POINTSWEEP_EXPORT InOrderWork {
 public:
  virtual ~InOrderWork() = default;
  /// Number of times that the points come.
  virtual unsigned rounds() const { return 1; }
  /// Takes the next points of round `round`, which counts from 0, and appends what is known by now, also of points that
  /// came before.
  virtual void add(unsigned round, const OrderedPoints& points, Findings& findings) = 0;
  /// Follows the last point of a round.
  virtual void end(unsigned round, Findings& findings) { (void)round, (void)findings; }
};

/// Makes an empty file in the temporary folder.
using MakeScratch = std::function<std::unique_ptr<Scratch>()>;

/// Finite points of another cloud. They ascend along the axis, then by x, y and z, then by row.
struct OtherPoints {
  std::span<const Vec3> positions;
  std::span<const std::uint64_t> rows;
  std::span<const std::byte> values;  ///< of InOrderOperator::other_reads(), of one point after another
};

/// Gives all finite points of another cloud in their order.
using GiveOtherPoints = std::function<void(const std::function<void(const OtherPoints&)>& take)>;

/// The setting of an InOrderWork: its axis, its memory, and access to files and to the other cloud.
struct InOrderSetup {
  int axis = 0;                    ///< along which places ascend; with Places::in_plane 0 or 1
  std::uint64_t memory_bytes = 0;  ///< that the work may hold
  MakeScratch make_scratch = {};
  GiveOtherPoints other_points = {};  ///< of InOrderOperator::other_cloud()
  /// Returns whether points of the cloud within a distance of a position may be missing; empty: none is. For operators
  /// whose Reach is a guess.
  std::function<bool(Vec3 position, double distance)> may_lack = {};
};

/// An estimate of the cloud that an InOrderWork will take, from a survey.
struct CloudEstimate {
  std::uint64_t points = 0;
  std::span<const Vec3> sample;  ///< finite positions
  int axis = 0;                  ///< along which places will ascend
  /// Estimates the most points between two planes across the axis, which are so far apart.
  std::function<std::uint64_t(double thickness)> slice_points;
};

/// Estimate, within a factor of about two, of the time that an in-order operator takes apart from reading the points.
struct InOrderEffort {
  double seconds = 0;       ///< CPU time on one core of 2.6 GHz
  std::string cause = {};   ///< "The window"
  std::string text = {};    ///< what the cause means: "disks of up to 100 cells"
  std::string remedy = {};  ///< "larger cells take less"
};

/// The places by which points ascend.
enum class Places : std::uint8_t {
  positions,    ///< the positions of the points
  of_operator,  ///< InOrderOperator::place_of() of the positions
  in_plane,     ///< InOrderOperator::place_of() of the positions, with z = 0: points ascend along x or y
};

/// Which points an operator has to know for what it finds about a point, where these are not all of the cloud: then the
/// cloud may be divided into parts.
struct Reach {
  double distance = 0;      ///< all points whose places differ by no more along any axis from the place of the point,
  std::size_t nearest = 0;  ///< or, if not 0, so many nearest ones no farther away, in the plane with Places::in_plane
  /// The distance is only likely to do: a part with Findings::undecided about its rows is done again with twice as
  /// much.
  bool is_guess = false;
};

struct InOrderContract {
  std::vector<Attribute> reads = {};  ///< of the point itself, in addition to its position
  std::vector<Attribute> makes = {};
  bool drops_rows = false;  ///< later stages and the output have the other rows alone
  Places places = Places::positions;
  std::string arrival = {};  ///< how points come, for the dry run: "equal ones together"
};

/// Takes all points with a finite place in order. A point without one stays, keeps its position and what the operator
/// reads of it and makes again, and has Attribute::fill of all else.
class POINTSWEEP_EXPORT InOrderOperator : public Operator {
 public:
  virtual InOrderContract in_order_contract() const = 0;
  /// Returns a new work for one run over the cloud.
  virtual std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const = 0;
  /// Returns where a point with a finite position comes in the order. Called from many threads at once.
  virtual Vec3 place_of(Vec3 position) const { return position; }
  /// Returns the least memory of a work on such a cloud.
  virtual std::uint64_t least_bytes(const CloudEstimate& cloud) const {
    (void)cloud;
    return 0;
  }
  /// Returns the effort for such a cloud.
  virtual InOrderEffort effort(const CloudEstimate& cloud) const {
    (void)cloud;
    return {};
  }
  /// Returns the reach of the operator among the points of the cloud; empty: it may have to know any of them. Places
  /// then ascend along each axis with the positions.
  virtual std::optional<Reach> reach() const { return std::nullopt; }
  /// Returns the numbers of those of some points that parts of the cloud have to know where they do not hold them,
  /// rather too many than too few; empty: all of them. Called from many threads at once.
  using ChoosePoints = std::function<std::vector<std::uint32_t>(const OrderedPoints& points)>;
  virtual ChoosePoints for_other_parts() const { return {}; }
  /// Returns the path, folder or pattern of the other cloud that the operator reads; empty: it reads none.
  virtual std::string other_cloud() const { return {}; }
  /// Returns the attributes that the operator reads of the points of the other cloud, beside their positions: after
  /// bound_to_other() with the names and types of its fields.
  virtual std::vector<Attribute> other_reads() const { return {}; }
  /// Returns the reach of the operator among the points of the other cloud; see reach().
  virtual std::optional<Reach> other_reach() const { return std::nullopt; }
  /// Returns the operator for another cloud with these fields. It is called before bound(), and only where
  /// other_reads() names attributes. Throws UsageError for a name that no field has.
  virtual std::shared_ptr<const InOrderOperator> bound_to_other(const Schema& other) const {
    (void)other;
    return nullptr;
  }
  /// Returns the operator for such a cloud, or null; see LocalOperator::bound().
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
