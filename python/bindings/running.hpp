// Long work below Python: the caller's thread waits without the interpreter's lock, hands on progress and looks for
// Ctrl-C; the work itself runs on a thread of its own and never sees Python.
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <utility>

#include "base/threads/progress.h"

namespace sparsha::python {

/// Without the interpreter's lock while it lives. A thread that outlives the interpreter (a daemon) waits in the
/// destructor for the end of the process: Python would end such a thread by an unwinding that C++ does not survive.
class Unlocked {
 public:
  Unlocked() : state_(PyEval_SaveThread()) {}
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

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

/// Runs `work(progress)`, which is over at once for few items and is done right here then, without being listened to.
template <typename Work>
void run_items(std::size_t items, const Work& work) {
  constexpr std::size_t kFew = std::size_t{1} << 16;
  if (items >= kFew) return run_without_lock(pybind11::none(), work);
  Progress unheard;
  work(unheard);
}

/// body(begin, end) for all of [0, count), in pieces between which the work may be cancelled.
template <typename Body>
void in_pieces(std::size_t count, Progress& progress, const Body& body) {
  constexpr std::size_t kPiece = std::size_t{1} << 18;
  for (std::size_t begin = 0; begin < count; begin += kPiece) {
    progress.throw_if_cancelled();
    body(begin, std::min(count, begin + kPiece));
  }
}

/// Work that nobody waits for any more ends when the interpreter does. To be called once, before run_without_lock().
void end_work_with_the_interpreter();

/// Sets Python's exception for one of the core's, where no binding of pybind11 does so.
void raise(const std::exception_ptr& thrown);
/// Makes exceptions of the package of what the core throws.
void translate_errors();

}  // namespace sparsha::python
