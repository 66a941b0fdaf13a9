#include "python/bindings/running.hpp"

#include <fmt/format.h>

#include <cxxabi.h>
#include <pthread.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <mutex>
#include <new>
#include <set>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"
#include "python/bindings/settings.hpp"

namespace sparsha::python {
namespace py = pybind11;

namespace {

constexpr std::chrono::milliseconds kLook{20};  // between two looks for Ctrl-C

#ifdef __GLIBCXX__
using Unwound = abi::__forced_unwind;  // how pthread_exit() ends a thread
#else
struct Unwound {};
#endif

/// For a thread that Python wants to end since the interpreter is gone.
[[noreturn]] void wait_for_the_end_of_the_process() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// What the work has said and the caller's thread has not handed on yet.
class Inbox {
 public:
  struct Message {
    std::string stage;
    double fraction = 0.0;
  };

  void take(const ProgressUpdate& update) {
    const std::lock_guard lock(mutex_);
    if (update.kind == ProgressUpdate::Kind::warning) {
      warnings_.emplace_back(update.text);
      return;
    }
    fraction_ = update.fraction;
    if (update.kind == ProgressUpdate::Kind::stage) {
      stage_ = update.text;
      messages_.push_back({stage_, 0.0});
    } else if (!messages_.empty() && messages_.back().stage == stage_) {
      messages_.back().fraction = update.fraction;
    } else {
      messages_.push_back({stage_, update.fraction});
    }
  }
  void end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_one();
  }
  /// Waits for the end of the work, or a moment. True once it has ended.
  bool wait() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kLook, [&] { return ended_; });
  }
  /// How far the work has come.
  Message latest() {
    const std::lock_guard lock(mutex_);
    return {stage_, fraction_};
  }
  void hand_over(std::vector<Message>& messages, std::vector<std::string>& warnings) {
    const std::lock_guard lock(mutex_);
    messages.swap(messages_);
    warnings.swap(warnings_);
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  std::string stage_;
  double fraction_ = 0.0;
  std::vector<Message> messages_;
  std::vector<std::string> warnings_;
};

/// Throws error_already_set for what Python raises.
void hand_on(Inbox& inbox, const py::object& listener) {
  std::vector<Inbox::Message> messages;
  std::vector<std::string> warnings;
  inbox.hand_over(messages, warnings);
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (!listener.is_none()) {
    for (const Inbox::Message& message : messages) listener(str_of(message.stage), message.fraction);
  }
  if (warnings.empty()) return;
  const py::object category = py::module_::import("sparsha._errors").attr("Warning");
  for (const std::string& warning : warnings) {
    py::module_::import("warnings").attr("warn")(str_of(warning), category, 1);
  }
}

bool is_cancelled(const std::exception_ptr& thrown) {
  if (!thrown) return false;
  try {
    std::rethrow_exception(thrown);
  } catch (const Cancelled&) {
    return true;
  } catch (...) {
    return false;
  }
}

/// Raises what Python raised, with a note of where the work was that it ended.
[[noreturn]] void raise_with_note(const std::exception_ptr& raised, const Inbox::Message& ended) {
  try {
    std::rethrow_exception(raised);
  } catch (py::error_already_set& error) {
    const py::object& value = error.value();
    if (py::hasattr(value, "add_note")) {  // since Python 3.11
      const std::string where = ended.stage.empty()
                                    ? "before its first stage"
                                    : fmt::format("at {:.0f} % of the stage '{}'", 100.0 * ended.fraction, ended.stage);
      value.attr("add_note")(str_of("sparsha ended its work " + where));
    }
    throw;
  }
}

/// The work that goes on in this process. Where the interpreter ends meanwhile, since only daemon threads wait for it,
/// it ends before what is destroyed at the process's end.
class Works {
 public:
  void add(Progress& progress) {
    const std::lock_guard lock(mutex_);
    running_.insert(&progress);
  }
  void remove(Progress& progress) {
    const std::lock_guard lock(mutex_);
    running_.erase(&progress);
    changed_.notify_all();
  }
  void end_all() {
    std::unique_lock lock(mutex_);
    for (Progress* const progress : running_) progress->cancel();
    changed_.wait(lock, [&] { return running_.empty(); });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<Progress*> running_;
};

Works* g_works = nullptr;  // never destroyed

/// Ends the work where its thread would outlive the caller otherwise.
class Joined {
 public:
  explicit Joined(std::thread thread) : thread_(std::move(thread)) {}
  ~Joined() { join(); }
  Joined(const Joined&) = delete;
  Joined& operator=(const Joined&) = delete;
  void join() {
    if (thread_.joinable()) thread_.join();
  }

 private:
  std::thread thread_;
};

/// A thread, or an Error of what the system says.
template <typename Work>
std::thread started(const Work& work) {
  try {
    return std::thread(work);
  } catch (const std::system_error& error) {
    throw Error(ErrorKind::failure, {}, fmt::format("no thread can be started: {}", error.code().message()),
                "a system that allows this process more threads");
  }
}

}  // namespace

Unlocked::~Unlocked() {
  try {
    PyEval_RestoreThread(state_);
  } catch (Unwound&) {
    wait_for_the_end_of_the_process();
  }
}

void run_without_lock(const py::object& listener, const std::function<void(Progress&)>& work) {
  if (!listener.is_none() && PyCallable_Check(listener.ptr()) == 0) {
    throw py::type_error("progress is not callable; expected None or a function of (stage, fraction)");
  }
  Inbox inbox;
  Works& works = *g_works;
  Progress progress([&](const ProgressUpdate& update) { inbox.take(update); });
  std::exception_ptr thrown;
  std::exception_ptr raised;  // by Python, on this thread
  {
    const auto start = [&] {
      works.add(progress);  // before the thread is there: the interpreter may end between the two
      try {
        return started([&] {
          try {
            work(progress);
          } catch (...) {
            thrown = std::current_exception();
          }
          works.remove(progress);
          inbox.end();
        });
      } catch (...) {
        works.remove(progress);
        throw;
      }
    };
    Joined thread(start());
    for (bool ended = false; !ended;) {
      {
        const Unlocked unlocked;
        ended = inbox.wait();
        if (ended) thread.join();
      }
      if (raised) continue;
      try {
        hand_on(inbox, listener);
      } catch (Unwound&) {  // in `listener`
        progress.cancel();
        thread.join();
        wait_for_the_end_of_the_process();
      } catch (...) {
        raised = std::current_exception();
        progress.cancel();
      }
    }
  }
  if (raised && is_cancelled(thrown)) raise_with_note(raised, inbox.latest());
  if (raised) std::rethrow_exception(raised);
  if (thrown) std::rethrow_exception(thrown);
}

namespace {

void set_exception(const Error& error) {
  const Place& place = error.place();
  const py::object made =
      py::module_::import("sparsha._errors")
          .attr("of_core")(static_cast<int>(error.kind()), str_of(error.what()), str_of(place.file), place.line,
                           place.column, str_of(error.wrong()), str_of(error.expected()));
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
}

Error failure_of(const std::filesystem::filesystem_error& error) {
  return {ErrorKind::failure, {error.path1().string(), 0, 0}, error.code().message()};
}

}  // namespace

void raise(const std::exception_ptr& thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    set_exception(error);
  } catch (const std::filesystem::filesystem_error& error) {
    set_exception(failure_of(error));
  } catch (const py::builtin_exception& exception) {
    exception.set_error();
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  } catch (const std::exception& exception) {
    PyErr_SetString(PyExc_RuntimeError, exception.what());
  }
}

void end_work_with_the_interpreter() {
  g_works = new Works;
  pthread_atfork(nullptr, nullptr, [] { g_works = new Works; });  // a child has none of the threads
  Py_AtExit([] { g_works->end_all(); });
}

void translate_errors() {
  py::register_exception_translator([](std::exception_ptr pointer) {
    if (!pointer) return;
    try {
      std::rethrow_exception(std::move(pointer));
    } catch (const Error& error) {
      set_exception(error);
    } catch (const std::filesystem::filesystem_error& error) {
      set_exception(failure_of(error));
    }
  });
}

}  // namespace sparsha::python
