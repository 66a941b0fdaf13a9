// Arrays of NumPy that come in, checked, and views of the core's own buffers that go out.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <typeinfo>
#include <vector>

#include <Eigen/Core>

namespace sparsha::python {

using Doubles = pybind11::array_t<double, pybind11::array::c_style>;
using Floats = pybind11::array_t<float, pybind11::array::c_style>;
using Integers = pybind11::array_t<std::int64_t, pybind11::array::c_style>;

/// What is allowed of an array beside its shape.
enum class Numbers : std::uint8_t { finite, any };

/// An array of any type and shape. Raises TypeError where nothing can make one of it; what ends a program, e.g.
/// KeyboardInterrupt, and MemoryError pass through.
[[nodiscard]] pybind11::array array_of(const pybind11::handle& given, const std::string& name, const std::string& what);

/// Rows of `columns` numbers (0: one number a row, an array of one dimension), as doubles in C order, copied where they
/// are not so already. `name` is what messages call it. Numbers that a masked array hides are NaN. Raises TypeError for
/// what is no array of real numbers; UsageError for another shape, for rows that are one row repeated (stride 0) or
/// begin within one number, for more memory than the machine has or the array is made of, and for a number that is
/// hidden or not finite, with its row.
[[nodiscard]] Doubles rows_of(const pybind11::handle& given, const std::string& name, int columns,
                              Numbers numbers = Numbers::finite);
/// The same in single precision.
[[nodiscard]] Floats float_rows_of(const pybind11::handle& given, const std::string& name, int columns,
                                   Numbers numbers = Numbers::finite);
/// The same of whole numbers from `low` to `high`.
[[nodiscard]] Integers whole_rows_of(const pybind11::handle& given, const std::string& name, int columns,
                                     std::int64_t low, std::int64_t high);

[[nodiscard]] Eigen::Vector3d vector_of(const pybind11::handle& given, const std::string& name,
                                        Numbers numbers = Numbers::finite);
[[nodiscard]] Eigen::Matrix4d matrix_of(const pybind11::handle& given, const std::string& name);

[[nodiscard]] pybind11::array_t<double> array_of(const Eigen::Vector3d& vector);
[[nodiscard]] pybind11::array_t<double> array_of(const Eigen::Matrix4d& matrix);

/// Makes members raise TypeError for objects of a bound class that __new__ made and __init__ did not, e.g. copies; what
/// pybind11 takes for their values is memory that nobody has set.
template <typename Bound>
void require_made() {
  pybind11::detail::get_type_info(typeid(Bound), true)->operator_new = [](std::size_t) -> void* {
    throw pybind11::type_error("the object was never made: its __init__ was not called");
  };
}

/// A read-only array over a buffer that `owner` keeps alive.
template <typename Value>
[[nodiscard]] pybind11::array view(const Value* data, std::vector<pybind11::ssize_t> shape,
                                   std::vector<pybind11::ssize_t> strides, const pybind11::object& owner) {
  pybind11::array_t<Value> array(std::move(shape), std::move(strides), data, owner);
  array.attr("setflags")(false);
  return array;
}

/// Keeps what `pointer` shares alive as long as Python's object lives.
template <typename Kept>
[[nodiscard]] pybind11::capsule keeper_of(std::shared_ptr<const Kept> pointer) {
  return pybind11::capsule(new std::shared_ptr<const Kept>(std::move(pointer)),
                           [](void* p) { delete static_cast<std::shared_ptr<const Kept>*>(p); });
}

/// Of a lattice: rows from the bottom, one value a node.
template <typename Value>
[[nodiscard]] pybind11::array node_view(const std::vector<Value>& values, int nx, int ny,
                                        const pybind11::object& owner) {
  const auto step = static_cast<pybind11::ssize_t>(sizeof(Value));
  return view(values.data(), {ny, nx}, {nx * step, step}, owner);
}

/// Colours 0xAABBGGRR as four bytes: red, green, blue, alpha.
[[nodiscard]] pybind11::array colour_view(const std::vector<std::uint32_t>& rgba, std::vector<pybind11::ssize_t> shape,
                                          const pybind11::object& owner);

}  // namespace sparsha::python
