#include "python/bindings/arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/system.h"

namespace sparsha::python {
namespace py = pybind11;

namespace {

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t d = 0; d < array.ndim(); ++d) text += fmt::format("{}{}", d > 0 ? ", " : "", array.shape(d));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

/// What is given, as an array of any real type that has not been copied yet.
py::array checked(const py::handle& given, const std::string& name, int columns, const char* kinds, const char* what,
                  std::size_t bytes_per_number) {
  if (given.is_none()) throw py::type_error(name + " is None; expected an array of " + what);
  py::array array = py::array::ensure(given);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(name + " cannot be made an array; expected an array of " + what);
  }
  const char kind = array.dtype().kind();
  if (std::string(kinds).find(kind) == std::string::npos && array.size() > 0) {
    throw py::type_error(
        fmt::format("{} holds {}; expected {}", name, py::str(array.dtype()).cast<std::string>(), what));
  }
  const bool fits = columns == 0 ? array.ndim() == 1 : array.ndim() == 2 && array.shape(1) == columns;
  if (!fits) {
    throw usage_error(fmt::format("{} has the shape {}", name, shape_text(array)),
                      columns == 0 ? std::string("(rows,)") : fmt::format("(rows, {})", columns));
  }
  if (array.shape(0) > 1 && array.strides(0) == 0) {
    throw usage_error(fmt::format("{} claims {} rows, which are one row repeated (stride 0)", name, array.shape(0)),
                      "an array with memory for each row, e.g. numpy.array(...)");
  }
  const double bytes = static_cast<double>(array.size()) * static_cast<double>(bytes_per_number);
  const auto memory = static_cast<double>(system::physical_memory_bytes());
  if (memory > 0.0 && bytes > memory) {
    throw usage_error(fmt::format("{} needs {:.3g} GB", name, 1e-9 * bytes),
                      fmt::format("less than this machine's memory, {:.3g} GB", 1e-9 * memory));
  }
  return array;
}

template <typename Array>
Array converted(const py::array& array, const std::string& name) {
  Array result = Array::ensure(array);
  if (result) return result;
  // Not of the type itself: by NumPy's own conversion.
  PyErr_Clear();
  result = Array::ensure(array.attr("astype")(py::dtype::of<typename Array::value_type>()));
  if (!result) throw py::error_already_set();
  static_cast<void>(name);
  return result;
}

template <typename Array>
Array numbers_of(const py::handle& given, const std::string& name, int columns, Numbers numbers) {
  using Value = typename Array::value_type;
  Array result = converted<Array>(checked(given, name, columns, "fiu", "real numbers", sizeof(Value)), name);
  if (numbers == Numbers::any) return result;
  const Value* const data = result.data();
  for (py::ssize_t n = 0; n < result.size(); ++n) {
    if (!std::isfinite(data[n])) {
      throw usage_error(fmt::format("row {} of {} is not finite: {}", n / std::max(1, columns), name, data[n]),
                        "finite numbers");
    }
  }
  return result;
}

}  // namespace

Doubles rows_of(const py::handle& given, const std::string& name, int columns, Numbers numbers) {
  return numbers_of<Doubles>(given, name, columns, numbers);
}

Floats float_rows_of(const py::handle& given, const std::string& name, int columns, Numbers numbers) {
  return numbers_of<Floats>(given, name, columns, numbers);
}

Integers whole_rows_of(const py::handle& given, const std::string& name, int columns, std::int64_t low,
                       std::int64_t high) {
  const py::array array = checked(given, name, columns, "iu", "whole numbers", sizeof(std::int64_t));
  Integers result = converted<Integers>(array, name);
  const std::int64_t* const data = result.data();
  for (py::ssize_t n = 0; n < result.size(); ++n) {
    if (data[n] < low || data[n] > high) {
      throw usage_error(fmt::format("row {} of {} holds {}", n / std::max(1, columns), name, data[n]),
                        fmt::format("{} to {}", low, high));
    }
  }
  return result;
}

Eigen::Vector3d vector_of(const py::handle& given, const std::string& name, Numbers numbers) {
  const Doubles row = rows_of(given, name, 0, numbers);
  if (row.size() != 3) throw usage_error(fmt::format("{} has {} numbers", name, row.size()), "3");
  return {row.data()[0], row.data()[1], row.data()[2]};
}

Eigen::Matrix4d matrix_of(const py::handle& given, const std::string& name) {
  const Doubles rows = rows_of(given, name, 4);
  if (rows.shape(0) != 4) throw usage_error(fmt::format("{} has the shape {}", name, shape_text(rows)), "(4, 4)");
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(rows.data());
}

py::array_t<double> array_of(const Eigen::Vector3d& vector) { return py::array_t<double>(3, vector.data()); }

py::array_t<double> array_of(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = matrix;
  return py::array_t<double>({4, 4}, rows.data());
}

py::array colour_view(const std::vector<std::uint32_t>& rgba, std::vector<py::ssize_t> shape, const py::object& owner) {
  static_assert(std::endian::native == std::endian::little, "red is the first byte of 0xAABBGGRR");
  shape.push_back(4);
  std::vector<py::ssize_t> strides(shape.size(), 1);
  for (std::size_t d = shape.size() - 1; d > 0; --d) strides[d - 1] = strides[d] * shape[d];
  return view(reinterpret_cast<const std::uint8_t*>(rgba.data()), std::move(shape), std::move(strides), owner);
}

}  // namespace sparsha::python
