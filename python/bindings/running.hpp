// Long work below Python: the caller's thread waits without the interpreter's lock, hands on progress and looks for
// Ctrl-C; the work itself runs on a thread of its own and never sees Python.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <functional>
#include <optional>
#include <utility>

#include "base/threads/progress.h"

namespace sparsha::python {

/// Runs `work`. `listener`: None, or what is called with (stage: str, fraction: float), on the caller's thread.
/// Warnings become Python's (sparsha.Warning). Whatever Python raises meanwhile, KeyboardInterrupt too, cancels the
/// work and is raised once that has ended, with a note (PEP 678) of where the work was when it was cancelled; without
/// one the work had come to its end by itself. To be called with the interpreter's lock.
void run_without_lock(const pybind11::object& listener, const std::function<void(Progress&)>& work);

/// The same with a result, which must not hold objects of Python.
template <typename Work>
auto run(const pybind11::object& listener, const Work& work) {
  std::optional<decltype(work(std::declval<Progress&>()))> result;
  run_without_lock(listener, [&](Progress& progress) { result.emplace(work(progress)); });
  return std::move(*result);
}

/// Sets Python's exception for one of the core's, where no binding of pybind11 does so.
void raise(const std::exception_ptr& thrown);
/// Makes exceptions of the package of what the core throws.
void translate_errors();

}  // namespace sparsha::python
