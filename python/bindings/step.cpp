#include <pybind11/numpy.h>

#include <cmath>
#include <cstring>

#include "base/error.h"
#include "python/bindings/arrays.hpp"
#include "python/bindings/renderer.hpp"
#include "python/bindings/running.hpp"

namespace sparsha::python {
namespace py = pybind11;

Renderer::Tick Renderer::step(const Eigen::Vector3d& hip_m) noexcept {
  return object ? step_around(hip_m) : step_on_view(hip_m);
}

Renderer::Tick Renderer::step_on_view(const Eigen::Vector3d& hip_m) noexcept {
  const Eigen::Vector3d& origin = surface->lattice.origin_m;
  const Eigen::Vector3d in_grid = haptics::in_grid_frame(hip_m, frame, grid_from_scan, *surface);
  const Eigen::Vector3d hip = in_grid - origin;
  if (!started && hip.allFinite()) {
    proxy = haptics::start_proxy(*surface, hip);
    started = true;
  }
  const haptics::ProxyUpdate found = haptics.solver == scene::HapticsConfig::Solver::paper
                                         ? haptics::update_paper(*surface, hip, proxy, options)
                                         : haptics::update_exact(*surface, hip, proxy, options);
  contact = found.contact;
  if (!found.contact && found.position == hip) return {in_grid, Eigen::Vector3d::Zero()};
  return {found.position + origin,
          found.contact ? Eigen::Vector3d(haptics.stiffness_n_per_m * surface->scale * (found.position - hip))
                        : Eigen::Vector3d::Zero()};
}

Renderer::Tick Renderer::step_around(const Eigen::Vector3d& hip_m) noexcept {
  const Eigen::Vector3d hip = (grid_from_scan * hip_m.homogeneous()).head<3>() - object->origin_m;
  const haptics::AroundUpdate found = haptics::update_around(*object, hip, around, options);
  contact = found.contact;
  if (found.position_m == hip) return {hip_m, Eigen::Vector3d::Zero()};
  const Eigen::Matrix4d& scan_from_grid = scene->scene->description().scan_from_grid;
  return {scan_from_grid.topLeftCorner<3, 3>() * (found.position_m + object->origin_m) +
              scan_from_grid.topRightCorner<3, 1>(),
          found.contact ? Eigen::Vector3d(haptics.stiffness_n_per_m * (force_from_grid * (found.position_m - hip)))
                        : Eigen::Vector3d::Zero()};
}

void Renderer::reset() noexcept {
  proxy = {};
  around = {};
  started = false;
  contact = false;
}

namespace {

/// NumPy's functions and types, looked up once.
struct NumPy {
  py::detail::npy_api* api = &py::detail::npy_api::get();
  PyObject* doubles = py::dtype::of<double>().release().ptr();  // kept for good
};

NumPy& numpy() {
  static NumPy* const kNumPy = new NumPy;  // never destroyed: the interpreter may be gone by then
  return *kNumPy;
}

/// Whether the numbers lie in an array's own memory; of views of other kinds the slow way knows.
bool owns(const NumPy& np, const PyObject* array) {
  const auto* const proxy = reinterpret_cast<const py::detail::PyArray_Proxy*>(array);
  return Py_TYPE(array) == np.api->PyArray_Type_ && (proxy->flags & py::detail::npy_api::NPY_ARRAY_OWNDATA_) != 0;
}

/// Three doubles in a row with the machine's byte order, in an array's own memory.
bool read_array(PyObject* given, Eigen::Vector3d& vector) {
  const NumPy& np = numpy();
  if (Py_TYPE(given) != np.api->PyArray_Type_) return false;
  const py::detail::PyArray_Proxy* const array = py::detail::array_proxy(given);
  if (array->nd != 1 || array->dimensions[0] != 3 || array->descr != np.doubles) return false;
  if (array->strides[0] != sizeof(double)) return false;
  if (!owns(np, given) && (array->base == nullptr || !owns(np, array->base))) return false;
  std::memcpy(vector.data(), array->data, 3 * sizeof(double));
  return true;
}

bool read_numbers(PyObject* given, Eigen::Vector3d& vector) {
  const bool tuple = PyTuple_CheckExact(given);
  if (!tuple && !PyList_CheckExact(given)) return false;
  if (Py_SIZE(given) != 3) return false;
  for (int k = 0; k < 3; ++k) {
    PyObject* const item = tuple ? PyTuple_GET_ITEM(given, k) : PyList_GET_ITEM(given, k);
    if (!PyFloat_CheckExact(item)) return false;
    vector[k] = PyFloat_AS_DOUBLE(item);
  }
  return true;
}

PyObject* array_of_three(const Eigen::Vector3d& vector) {
  const NumPy& np = numpy();
  const Py_intptr_t shape = 3;
  Py_INCREF(np.doubles);  // which the array takes
  PyObject* const array =
      np.api->PyArray_NewFromDescr_(np.api->PyArray_Type_, np.doubles, 1, &shape, nullptr, nullptr, 0, nullptr);
  if (array != nullptr) std::memcpy(py::detail::array_proxy(array)->data, vector.data(), 3 * sizeof(double));
  return array;
}

/// What `step` does with anything but three doubles of Python or NumPy; false: an exception is set.
bool read_slowly(PyObject* given, Eigen::Vector3d& vector) {
  try {
    vector = vector_of(given, "hip", Numbers::any);
    return true;
  } catch (py::error_already_set& raised) {
    raised.restore();
  } catch (...) {
    raise(std::current_exception());
  }
  return false;
}

PyObject* refuse_unrolled() {
  raise(std::make_exception_ptr(
      usage_error("single steps are not there for an unrolled object in the frame of its scans",
                  "trace(path) of a whole path, or frame='grid': the unrolled surface itself")));
  return nullptr;
}

PyObject* step(PyObject* self, PyObject* const* arguments, Py_ssize_t count) {
  if (count != 1) {
    PyErr_Format(PyExc_TypeError, "step() takes one place of the hand, (3,); %zd arguments are given", count);
    return nullptr;
  }
  auto* const instance = reinterpret_cast<py::detail::instance*>(self);
  auto* const renderer = static_cast<Renderer*>(instance->simple_layout ? instance->simple_value_holder[0] : nullptr);
  if (renderer == nullptr) {
    PyErr_SetString(PyExc_TypeError, "the Renderer was never made: its __init__ was not called");
    return nullptr;
  }
  if (renderer->unrolled) return refuse_unrolled();
  Eigen::Vector3d hip_m;
  if (!read_array(arguments[0], hip_m) && !read_numbers(arguments[0], hip_m) && !read_slowly(arguments[0], hip_m)) {
    return nullptr;
  }
  const Renderer::Tick tick = renderer->step(hip_m);
  PyObject* const proxy = array_of_three(tick.proxy_m);
  PyObject* const force = proxy != nullptr ? array_of_three(tick.force_n) : nullptr;
  PyObject* const pair = force != nullptr ? PyTuple_New(2) : nullptr;
  if (pair == nullptr) {
    Py_XDECREF(proxy);
    Py_XDECREF(force);
    return nullptr;
  }
  PyTuple_SET_ITEM(pair, 0, proxy);
  PyTuple_SET_ITEM(pair, 1, force);
  return pair;
}

PyMethodDef step_method{"step", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(&step)), METH_FASTCALL,
                        R"(step($self, hip, /)
--

One tick: a place of the hand to (proxy, force), two arrays (3,) float64.

hip: (3,) metres, in the frame that the Renderer was made for; a hand that is not a number is rendered as `trace` does.
proxy: metres, grid frame (scan frame of a whole object). force: newtons, zero where the hand is free. The first tick
starts the proxy above or at the hand; each goes on from the one before. Raises TypeError, UsageError.)"};

}  // namespace

void add_step(const py::class_<Renderer>& renderer) {
  static_cast<void>(numpy());
  PyObject* const method = PyDescr_NewMethod(reinterpret_cast<PyTypeObject*>(renderer.ptr()), &step_method);
  if (method == nullptr) throw py::error_already_set();
  py::setattr(renderer, "step", py::reinterpret_steal<py::object>(method));
}

}  // namespace sparsha::python
