// Work that goes on beside the caller's, where the system gives a thread for it.
#pragma once

#include <future>
#include <system_error>
#include <type_traits>

namespace sparsha {

/// Runs work() in a thread of its own; where none can be started, in the thread that asks for the result.
template <typename Work>
[[nodiscard]] std::future<std::invoke_result_t<Work&>> in_background(const Work& work) {
  try {
    return std::async(std::launch::async, work);
  } catch (const std::system_error&) {
    return std::async(std::launch::deferred, work);
  }
}

}  // namespace sparsha
