// Waits for work on other threads, and fails where it never ends.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace sparsha::test {

/// Until `done()`; the test fails when that takes longer than any machine needs.
template <typename Done>
void wait_until(const Done& done) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) FAIL() << "what is waited for does not come";
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

}  // namespace sparsha::test
