// What is plugged in again while the servo runs: a thread of its own closes what is of no use any more, looks for
// another, and hands it over.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <thread>
#include <utility>

namespace sparsha::haptics {

/// `Wire`: what a driver talks through. This thread alone opens and closes those that come later than the first.
template <typename Wire>
class HotPlug {
 public:
  /// Asked at once and then twice a second while one is wanted, on this thread; null, or an exception: none yet.
  using Find = std::function<std::unique_ptr<Wire>()>;

  explicit HotPlug(Find find) : find_(std::move(find)), thread_([this] { run(); }) {}
  ~HotPlug() {
    stopping_.store(true);
    thread_.join();
    close(given_back_.exchange(nullptr));
    close(offered_.exchange(nullptr));
  }
  HotPlug(const HotPlug&) = delete;
  HotPlug& operator=(const HotPlug&) = delete;

  // One thread, the servo's; no lock, no allocation.
  /// Ownership of one that is of no use any more, or null where there was none: another one is wanted.
  void give_back(Wire* wire) noexcept {
    given_back_.store(wire);
    wanted_.store(true);
  }
  /// Ownership of another one, or null.
  [[nodiscard]] Wire* take() noexcept {
    if (offered_.load(std::memory_order_relaxed) == nullptr) return nullptr;
    return offered_.exchange(nullptr);
  }

  /// A further thread uses one only between enter() and leave(): none is closed meanwhile.
  void enter() noexcept { users_.fetch_add(1); }
  void leave() noexcept { users_.fetch_sub(1); }

 private:
  static constexpr std::chrono::milliseconds kLook{20};
  static constexpr int kLooksBetweenTries = 25;

  void run() {
    int looks = 0;
    while (!stopping_.load()) {
      if (wanted_.load()) {
        close(given_back_.exchange(nullptr));
        if (looks-- <= 0) {
          looks = kLooksBetweenTries;
          if (std::unique_ptr<Wire> wire = find()) {
            wanted_.store(false);
            looks = 0;
            offered_.store(wire.release());
          }
        }
      }
      std::this_thread::sleep_for(kLook);
    }
  }

  [[nodiscard]] std::unique_ptr<Wire> find() {
    try {
      return find_();
    } catch (const std::exception&) {  // it is tried again
      return nullptr;
    }
  }

  void close(Wire* wire) const {
    if (wire == nullptr) return;
    while (users_.load() != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    delete wire;
  }

  Find find_;
  std::atomic<Wire*> given_back_{nullptr}, offered_{nullptr};
  std::atomic<int> users_{0};
  std::atomic<bool> wanted_{false}, stopping_{false};
  std::thread thread_;
};

}  // namespace sparsha::haptics
