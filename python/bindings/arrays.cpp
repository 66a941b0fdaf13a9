#include "python/bindings/arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/system.h"
#include "python/bindings/running.hpp"

namespace sparsha::python {
namespace py = pybind11;

namespace {

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t d = 0; d < array.ndim(); ++d) text += fmt::format("{}{}", d > 0 ? ", " : "", array.shape(d));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

/// Numbers that came in, and which of them a masked array hides: an array of bool of the same shape, or None.
struct Given {
  py::array numbers;
  py::object mask = py::none();
};

/// The first and the last byte of an array that has elements, and one more.
std::pair<const char*, const char*> bytes_of(const py::array& array) {
  const char* first = static_cast<const char*>(array.data());
  const char* last = first + array.itemsize();
  for (py::ssize_t d = 0; d < array.ndim(); ++d) {
    const py::ssize_t reach = (array.shape(d) - 1) * array.strides(d);
    (reach < 0 ? first : last) += reach;
  }
  return {first, last};
}

/// NumPy's as_strided() believes whatever shape and strides it is given; other views lie within what they are made of.
void require_own_memory(const py::array& array, const std::string& name) {
  if (array.size() == 0) return;
  bool strided = false;
  py::array whole = array;
  py::object base = array.base();
  constexpr int kMostBases = 1000;
  for (int seen = 0; base && !base.is_none(); ++seen) {
    if (seen == kMostBases) {
      throw usage_error(name + " is a view of a view of itself, or of too many others", "an array with its own memory");
    }
    if (py::isinstance<py::array>(base)) {
      whole = base.cast<py::array>();
    } else if (py::hasattr(base, "__array_interface__") && py::hasattr(base, "base")) {  // what as_strided() goes by
      strided = true;
    } else {
      break;
    }
    base = base.attr("base");
  }
  if (!strided) return;
  const auto [first, last] = bytes_of(array);
  const auto [begin, end] = bytes_of(whole);
  if (first >= begin && last <= end) return;
  throw usage_error(name + " reaches beyond the memory of the array that it is a view of",
                    "shape and strides that stay within it");
}

}  // namespace

py::array array_of(const py::handle& given, const std::string& name, const std::string& what) {
  PyObject* const made = py::detail::npy_api::get().PyArray_FromAny_(
      given.ptr(), nullptr, 0, 0, py::detail::npy_api::NPY_ARRAY_ENSUREARRAY_, nullptr);
  if (made != nullptr) return py::reinterpret_steal<py::array>(made);
  const py::error_already_set raised;
  // Of what the object itself raised, only what says that it is no array is told in other words.
  if (!raised.matches(PyExc_Exception) || raised.matches(PyExc_MemoryError)) throw raised;
  throw py::type_error(name + " cannot be made an array; expected an array of " + what);
}

namespace {

/// A list of masked arrays becomes one of them; NumPy would forget their masks.
py::object with_masks(const py::handle& given, const py::object& masked_array) {
  const bool list = py::isinstance<py::list>(given);
  if (!list && !py::isinstance<py::tuple>(given)) return py::reinterpret_borrow<py::object>(given);
  for (const py::handle& item : given) {
    if (!py::isinstance(item, masked_array)) continue;
    try {
      return masked_array(given);
    } catch (py::error_already_set&) {  // of no shape, as is said of other lists
      break;
    }
  }
  return py::reinterpret_borrow<py::object>(given);
}

/// What is given, as an array of any real type that has not been copied yet.
Given checked(const py::handle& argument, const std::string& name, int columns, const char* kinds, const char* what,
              std::size_t bytes_per_number) {
  if (argument.is_none()) throw py::type_error(name + " is None; expected an array of " + what);
  const py::object masked_array = py::module_::import("numpy.ma").attr("MaskedArray");
  const py::object given = with_masks(argument, masked_array);
  const bool may_hide = py::isinstance(given, masked_array);
  const py::array array = array_of(may_hide ? given.attr("data") : given, name, what);
  const char kind = array.dtype().kind();
  const bool none_of_a_list = array.size() == 0 && kind == 'f';  // [] is one of doubles
  if (std::string(kinds).find(kind) == std::string::npos && !none_of_a_list) {
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
  if (array.shape(0) > 1 && std::abs(array.strides(0)) < array.itemsize()) {
    throw usage_error(fmt::format("{} has rows {} bytes apart, whose numbers have {} bytes", name, array.strides(0),
                                  array.itemsize()),
                      "rows that begin with different numbers");
  }
  const double bytes = static_cast<double>(array.size()) * static_cast<double>(bytes_per_number);
  const auto memory = static_cast<double>(system::physical_memory_bytes());
  if (memory > 0.0 && bytes > memory) {
    throw usage_error(fmt::format("{} needs {:.3g} GB", name, 1e-9 * bytes),
                      fmt::format("less than this machine's memory, {:.3g} GB", 1e-9 * memory));
  }
  require_own_memory(array, name);
  const py::object mask = may_hide ? py::module_::import("numpy.ma").attr("getmaskarray")(given) : py::none();
  return {array, may_hide && mask.attr("any")().cast<bool>() ? mask : py::none()};
}

void refuse_masked(const Given& given, const std::string& name, int columns) {
  if (given.mask.is_none()) return;
  const auto first = given.mask.attr("argmax")().cast<py::ssize_t>();
  throw usage_error(fmt::format("row {} of {} is masked", first / std::max(1, columns), name),
                    "numbers that are known, e.g. the rows without masked ones");
}

/// Masked numbers become NaN, in a copy.
template <typename Array>
void forget_masked(Array& numbers, const Given& given) {
  if (given.mask.is_none()) return;
  numbers = Array(numbers.attr("copy")());
  numbers[given.mask] = std::numeric_limits<double>::quiet_NaN();
}

template <typename Array>
Array converted(const py::array& array) {
  Array result = Array::ensure(array);
  if (result) return result;
  // Not of the type itself: by NumPy's own conversion.
  PyErr_Clear();
  result = Array::ensure(array.attr("astype")(py::dtype::of<typename Array::value_type>()));
  if (!result) throw py::error_already_set();
  return result;
}

template <typename Array>
Array numbers_of(const py::handle& given, const std::string& name, int columns, Numbers numbers) {
  using Value = typename Array::value_type;
  const auto row = static_cast<std::size_t>(std::max(1, columns));
  const Given real = checked(given, name, columns, "fiu", "real numbers", sizeof(Value));
  if (numbers == Numbers::finite) refuse_masked(real, name, columns);
  Array result = converted<Array>(real.numbers);
  if (numbers == Numbers::any) {
    forget_masked(result, real);
    return result;
  }
  const Value* const data = result.data();
  const auto count = static_cast<std::size_t>(result.size());
  run_items(count, [&](Progress& progress) {
    in_pieces(count, progress, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        if (std::isfinite(data[n])) continue;
        throw usage_error(fmt::format("row {} of {} is not finite: {}", n / row, name, data[n]), "finite numbers");
      }
    });
  });
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
  const Given whole = checked(given, name, columns, "iu", "whole numbers", sizeof(std::int64_t));
  refuse_masked(whole, name, columns);
  Integers result = converted<Integers>(whole.numbers);
  const std::int64_t* const data = result.data();
  const auto count = static_cast<std::size_t>(result.size());
  const auto row = static_cast<std::size_t>(std::max(1, columns));
  run_items(count, [&](Progress& progress) {
    in_pieces(count, progress, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        if (data[n] >= low && data[n] <= high) continue;
        throw usage_error(fmt::format("row {} of {} holds {}", n / row, name, data[n]),
                          fmt::format("{} to {}", low, high));
      }
    });
  });
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
