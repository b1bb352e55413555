// SPDX-License-Identifier: MIT
#include "python/binding/python_operator.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstring>
#include <exception>
#include <span>
#include <tuple>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/points/schema.h"
#include "python/binding/array_columns.h"
#include "python/binding/point_batch.h"
#include "python/binding/python_threads.h"

namespace nb = nanobind;

namespace pointsweep {

/// A Python function, the threads of the run that call it, and the first exception it raised. In a Python without an
/// interpreter lock, the threads call the function at the same time. The thread that destroys the object may not be
/// attached to the interpreter, so the deleter of function_of() attaches it.
class PythonFunction {
 public:
  explicit PythonFunction(nb::object op) : op_(std::move(op)) {}

  void call_on(PythonThreads& threads) { threads_ = &threads; }
  PythonThreads& threads() const {
    assert(threads_ != nullptr && "a run gives its threads to its operators before it starts");
    return *threads_;
  }

  nb::object call(PointBatch points) {
    require_success();
    const nb::object owned = nb::cast(std::move(points));  // Python may keep it for longer than this call
    PointBatch& batch = nb::cast<PointBatch&>(owned);
    try {
      nb::object results = op_.attr("_call")(owned);
      batch.end();
      return results;
    } catch (const nb::python_error&) {
      batch.end();
      if (!failed_.exchange(true)) raised_ = std::current_exception();
    }
    require_success();
    return {};
  }
  /// Throws the first exception. Must be called when no thread calls the function any more.
  void rethrow() const {
    if (raised_) std::rethrow_exception(raised_);
  }

 private:
  void require_success() const {
    if (failed_) fail("an operator in Python raised an exception.");
  }

  nb::object op_;
  PythonThreads* threads_ = nullptr;
  std::exception_ptr raised_;
  std::atomic<bool> failed_ = false;
};

namespace {

std::shared_ptr<PythonFunction> function_of(nb::handle op) {
  return {new PythonFunction(nb::borrow(op)), [](PythonFunction* function) {
            const nb::gil_scoped_acquire interpreter;
            delete function;
          }};
}

bool is_64_bits(Type type) { return type == Type::i64 || type == Type::u64; }

/// Returns the attribute that an operator reads as `name`: the last attribute of that name in `made`, unless it is the
/// position; else a field of the input, found as in the conditions of where(); else the normal, or the fields name_0,
/// name_1 and so on of the input; else a field that does not exist. Fields are read as float64, except unscaled
/// integers of 64 bits.
Attribute resolved(const std::string& name, const Schema& input, std::span<const Attribute> made) {
  for (std::size_t m = made.size(); m-- > 0;)
    if (made[m].name == name && name != position_attribute().name) return made[m];
  if (const auto at = field_meant(input, name)) {
    const Field& field = input.fields[*at];
    if (field.count != 1)
      fail_usage("'{}' is an array of {} values, which operators in Python cannot read.", name, field.count);
    return scalar(field.name, field.is_plain() && is_64_bits(field.type) ? field.type : Type::f64, "", "");
  }
  if (name == normal_attribute().name) return normal_attribute();
  Attribute list = scalar(name, Type::f64, "", "");
  list.fields.clear();
  while (input.find(name + "_" + std::to_string(list.fields.size())))
    list.fields.push_back(name + "_" + std::to_string(list.fields.size()));
  return list.fields.empty() ? scalar(name, Type::f64, "", "") : list;
}

std::vector<Attribute> all_resolved(const std::vector<std::string>& names, const Schema& input,
                                    std::span<const Attribute> made) {
  std::vector<Attribute> attributes;
  for (const std::string& name : names) attributes.push_back(resolved(name, input, made));
  return attributes;
}

Type type_named(const std::string& name) {
  for (int t = 0; t <= static_cast<int>(Type::f64); ++t)
    if (name_of(static_cast<Type>(t)) == name) return static_cast<Type>(t);
  fail_usage("'{}' is not the name of a type.", name);
}

/// Makes an attribute from (name, type, number of values per point; 0: a single value that is no list). Positions and
/// normals have their own types and fields.
Attribute made_attribute(const std::tuple<std::string, std::string, std::size_t>& made) {
  const auto& [name, type_name, values] = made;
  if (name == position_attribute().name) return position_attribute();
  if (name == normal_attribute().name) return normal_attribute();
  const Type type = type_named(type_name);
  Attribute attribute = scalar(name, type, "", "made by an operator in Python");
  if (values > 0) attribute.fields.clear();
  for (std::size_t v = 0; v < values; ++v) attribute.fields.push_back(name + "_" + std::to_string(v));
  if (type == Type::f32 || type == Type::f64) attribute.fill = std::byte{0xFF};  // NaN
  return attribute;
}

/// The common part of the operators of Python: the declarations of the pointsweep.Operator, and calls of its function.
class PythonCall {
 public:
  PythonCall(nb::handle op, std::shared_ptr<PythonFunction> function)
      : name_(nb::cast<std::string>(op.attr("name"))),
        digest_(nb::cast<std::string>(op.attr("_digest"))),
        reads_(nb::cast<std::vector<std::string>>(op.attr("reads"))),
        reads_neighbors_(nb::cast<std::vector<std::string>>(op.attr("reads_neighbors"))),
        most_places_(nb::cast<std::size_t>(op.attr("_most_places"))),
        function_(std::move(function)) {
    using Made = std::vector<std::tuple<std::string, std::string, std::size_t>>;
    for (const auto& made : nb::cast<Made>(op.attr("_makes"))) contract_.makes.push_back(made_attribute(made));
    if (!nb::cast<bool>(op.attr("sees_neighbors"))) contract_.default_k = 0;
    bind({}, {});
  }

  const std::string& name() const { return name_; }
  /// Returns the contract of the operator. The contract of a select makes no attribute.
  const Contract& contract() const { return contract_; }
  Options options() const { return digest_.empty() ? Options{} : Options{{"python", digest_}}; }
  void bind(const Schema& input, std::span<const Attribute> made) {
    contract_.reads = all_resolved(reads_, input, made);
    contract_.reads_neighbors = all_resolved(reads_neighbors_, input, made);
  }

  /// Calls the function with pieces of the batch. put(m, first, size, array) gets the result m of the function for the
  /// `size` points from `first` on.
  template <class Put>
  void call(const Neighborhoods& in, Put put) const {
    function_->threads().call([&] {
      for (std::size_t first = 0, size = 0; first < in.size(); first += size) {
        size = size_at(in, first);
        const nb::object results = function_->call(PointBatch(in, contract_, first, size));
        for (std::size_t m = 0; m < nb::len(results); ++m) put(m, first, size, results[m]);
      }
    });
  }

 private:
  /// Returns the number of points from `first` on, at least 1, whose padded lists have at most most_places_ places.
  std::size_t size_at(const Neighborhoods& in, std::size_t first) const {
    std::size_t width = 1, size = 0;
    for (; first + size < in.size(); ++size) {
      if (contract_.default_k > 0) width = std::max(width, in.count(first + size));
      if (size > 0 && (size + 1) * width > most_places_) break;
    }
    return size;
  }

  std::string name_, digest_;
  std::vector<std::string> reads_, reads_neighbors_;
  std::size_t most_places_;  ///< limit for the padded lists of one call; a single point may have more
  Contract contract_;
  std::shared_ptr<PythonFunction> function_;
};

/// Copies `bytes` bytes from the beginning of `result`, a contiguous array with a column for each field, to `to`.
void copy_values(nb::handle result, const std::vector<std::string>& fields, std::size_t bytes, std::byte* to) {
  std::memcpy(to, borrow_array(result, fields).first, bytes);
}

class PythonLocal final : public LocalOperator {
 public:
  explicit PythonLocal(PythonCall call) : call_(std::move(call)) {}
  std::string name() const override { return call_.name(); }
  Contract contract() const override { return call_.contract(); }
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override {
    auto bound = std::make_shared<PythonLocal>(*this);
    bound->call_.bind(input, made);
    return bound;
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    call_.call(in, [&](std::size_t m, std::size_t first, std::size_t size, nb::handle result) {
      const Attribute& made = call_.contract().makes[m];
      copy_values(result, made.fields, size * made.bytes(), out.column<std::byte>(m).data() + first * made.bytes());
    });
  }

 private:
  Options own_options() const override { return call_.options(); }
  PythonCall call_;
};

class PythonSelect final : public SelectOperator {
 public:
  explicit PythonSelect(PythonCall call) : call_(std::move(call)) {}
  std::string name() const override { return call_.name(); }
  std::vector<Attribute> reads() const override { return call_.contract().reads; }
  std::shared_ptr<const SelectOperator> bound(const Schema& input, std::span<const Attribute> made) const override {
    auto bound = std::make_shared<PythonSelect>(*this);
    bound->call_.bind(input, made);
    return bound;
  }
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override {
    call_.call(points, [&](std::size_t, std::size_t first, std::size_t size, nb::handle result) {
      copy_values(result, selection_attribute().fields, size, std::as_writable_bytes(kept.subspan(first)).data());
    });
  }

 private:
  Options own_options() const override { return call_.options(); }
  PythonCall call_;
};

}  // namespace

ChainStage python_operator(nb::handle op, PythonFunctions& functions) {
  functions.push_back(function_of(op));
  PythonCall call(op, functions.back());
  if (call.contract().makes.empty()) return std::make_shared<const PythonSelect>(std::move(call));
  return std::make_shared<const PythonLocal>(std::move(call));
}

void call_python_on(PythonThreads& threads, const PythonFunctions& functions) {
  for (const auto& function : functions) function->call_on(threads);
}

void rethrow_python_exception(const PythonFunctions& functions) {
  for (const auto& function : functions) function->rethrow();
}

}  // namespace pointsweep
