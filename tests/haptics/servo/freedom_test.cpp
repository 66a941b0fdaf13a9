// Between hand position and force the servo thread allocates nothing, locks nothing and calls nothing of the system:
// counted on the live loop by wrapping the functions, and by the kernel's own hook for system calls.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <new>
#include <thread>

#include "haptics/replay/recorder.h"
#include "haptics/servo/servo.h"
#include "haptics/window/window.h"
#include "tests/support/part_scenes.h"
#include "tests/support/sanitized.h"
#include "tests/support/servo_parts.h"
#include "tests/support/test_folder.h"

namespace {

constexpr char kAllow = 0;  // SYSCALL_DISPATCH_FILTER_ALLOW
constexpr char kBlock = 1;

// Set by the device in read() and cleared in write(): exactly the stretch that is promised free.
thread_local bool watching = false;
std::atomic<std::uint64_t> allocations{0};
std::atomic<std::uint64_t> locks{0};
std::atomic<std::uint64_t> system_calls{0};
volatile char selector = kAllow;

}  // namespace

#if !SPARSHA_SANITIZED
extern "C" {
void* __libc_malloc(std::size_t size);
void __libc_free(void* memory);
void* malloc(std::size_t size) {
  if (watching) allocations.fetch_add(1);
  return __libc_malloc(size);
}
void free(void* memory) {
  if (watching && memory != nullptr) allocations.fetch_add(1);
  __libc_free(memory);
}
int pthread_mutex_lock(pthread_mutex_t* mutex) {
  if (watching) locks.fetch_add(1);
  using Lock = int (*)(pthread_mutex_t*);
  static const auto real = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  return real(mutex);
}
}
#endif

namespace sparsha::haptics {
namespace {

void count_system_call(int, siginfo_t*, void*) {
  system_calls.fetch_add(1);
  selector = kAllow;  // the rest of this tick goes uncounted, one is enough to fail
}

/// A hand that strokes hills, watches itself, and can ask the kernel to trap every system call of the servo's thread.
class WatchingDevice final : public Device {
 public:
  explicit WatchingDevice(bool trap) : trap_(trap) {}
  [[nodiscard]] DeviceInfo info() const override { return {}; }
  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    if (trap_ && !asked_) {
      asked_ = true;
      trapping_.store(prctl(PR_SET_SYSCALL_USER_DISPATCH, PR_SYS_DISPATCH_ON, 0UL, 0UL, &selector) == 0);
    }
    const double t = time_s;
    const DeviceSample sample = sample_at(
        {0.03 * std::sin(2.1 * t), 0.03 * std::cos(1.7 * t), t < 0.1 ? 0.02 : 0.005 * std::sin(6.0 * t)}, time_s);
    ticks_.fetch_add(1);
    watching = true;
    if (trapping_.load()) selector = kBlock;
    return sample;
  }
  void write(const Eigen::Vector3d& force_n) noexcept override {
    selector = kAllow;
    watching = false;
    if (force_n.norm() > 0.0) pushed_.fetch_add(1);
  }
  void zero() noexcept override {}

  [[nodiscard]] std::uint64_t ticks() const { return ticks_.load(); }
  [[nodiscard]] std::uint64_t pushed() const { return pushed_.load(); }
  [[nodiscard]] bool trapping() const { return trapping_.load(); }

 private:
  bool trap_;
  bool asked_ = false;
  std::atomic<bool> trapping_{false};
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<std::uint64_t> pushed_{0};
};

scene::ScenePointer hills() {
  return sparsha::test::scene_of(sparsha::test::hills_m, 201, 0.1, 200, Eigen::Vector3d::Zero(),
                                 [](scene::SceneDescription& d) { d.config.friction = scene::FrictionConfig{}; });
}

/// Over two seconds of stroking with window changes on the way; at least 500 ticks, 100 of them with force.
void run(WatchingDevice& device, const std::function<HapticWindow(std::uint64_t id)>& window) {
  Seqlock<State> state;
  const auto consumer = std::make_shared<ContactQueue>(1024);
  Recorder recorder({}, device.info(), 1000.0);
  recorder.start();
  Servo servo(device, patient(), window(1), state, {consumer}, &recorder);
  servo.start();
  for (std::uint64_t id = 2; id < 6; ++id) {
    Command command;
    command.kind = Command::Kind::swap;
    command.window = window(id);
    command.sequence = id;
    ASSERT_TRUE(servo.post(std::move(command)));
    ASSERT_TRUE(eventually([&] { return state.read().time_s > 0.5 * static_cast<double>(id - 1); }));
    servo.collect();
  }
  ASSERT_TRUE(eventually([&] { return device.ticks() > 500 && device.pushed() > 100; }));
  servo.stop();
  static_cast<void>(recorder.finish());
}

void run(WatchingDevice& device) {
  const auto scene = hills();
  run(device, [&](std::uint64_t id) { return window_on(scene, 0, id); });
}

/// Parts of every shape under the hand, each with all that is felt of a part.
void run_on_parts(WatchingDevice& device) {
  const test::TestFolder folder;
  scene::PartTouch touch;
  touch.stiffness_n_per_m = 500.0;
  touch.mu_dynamic = 0.4;
  touch.material = scene::Material::wood;
  const auto scene = test::els(folder / "labels.png", touch, [&](scene::SceneDescription& d) {
    d.config.friction = scene::FrictionConfig{};
    d.config.haptics.impact = d.config.haptics.grain = true;
    d.config.cues = scene::CuesConfig{};
    auto& star = d.config.parts[0].polygon_m;  // of a thousand corners
    star.clear();
    for (int k = 0; k < 1000; ++k) {
      const double angle = 0.00628318530717958648 * k, radius = k % 2 == 0 ? 0.03 : 0.02;
      star.push_back({0.05 + radius * std::cos(angle), 0.05 + radius * std::sin(angle)});
    }
    d.config.parts.push_back({"box", "box", {0.02, 0.06, 0.05, 0.09}, touch});
  });
  run(device, [&](std::uint64_t id) {
    return load_window(*scene, plan_window(scene->description(), 0, {0.05, 0.05}, 0.1), id);
  });
}

/// Nothing is allocated or locked between the device's read() and write() while `work` runs a servo on it.
template <class Work>
void expect_freedom(const Work& work) {
  allocations.store(0);
  locks.store(0);
  WatchingDevice device(false);
  work(device);
  EXPECT_EQ(allocations.load(), 0U);
  EXPECT_EQ(locks.load(), 0U);
}

TEST(ServoFreedom, PartsOfAnyShapeAllocateAndLockNothingEither) {
  if (SPARSHA_SANITIZED) GTEST_SKIP() << "sanitizers bring their own malloc";
  expect_freedom([](WatchingDevice& device) { run_on_parts(device); });
}

TEST(ServoFreedom, FromHandPositionToForceNothingIsAllocatedOrFreedOrLocked) {
  if (SPARSHA_SANITIZED) GTEST_SKIP() << "sanitizers bring their own malloc";
  expect_freedom([](WatchingDevice& device) { run(device); });
}

TEST(ServoFreedom, TheCountersWouldSeeAnAllocationAndALock) {
  if (SPARSHA_SANITIZED) GTEST_SKIP() << "sanitizers bring their own malloc";
  allocations.store(0);
  locks.store(0);
  pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  watching = true;
  void* volatile memory = std::malloc(100);  // volatile: a pair that nobody uses may be left out
  std::free(memory);
  pthread_mutex_lock(&mutex);
  watching = false;
  pthread_mutex_unlock(&mutex);
  EXPECT_GE(allocations.load(), 1U);
  EXPECT_EQ(locks.load(), 1U);
}

/// Trapped system calls are counted while it lives.
class CountedSystemCalls {
 public:
  CountedSystemCalls() {
    struct sigaction action {};
    action.sa_sigaction = count_system_call;
    action.sa_flags = SA_SIGINFO;
    counting = sigaction(SIGSYS, &action, &before_) == 0;
    system_calls.store(0);
  }
  CountedSystemCalls(const CountedSystemCalls&) = delete;
  CountedSystemCalls& operator=(const CountedSystemCalls&) = delete;
  ~CountedSystemCalls() {
    if (counting) sigaction(SIGSYS, &before_, nullptr);
  }

  bool counting = false;

 private:
  struct sigaction before_ {};
};

TEST(ServoFreedom, FromHandPositionToForceNothingOfTheSystemIsCalled) {
  if (SPARSHA_SANITIZED) GTEST_SKIP() << "sanitizers make system calls of their own";
  const CountedSystemCalls counted;
  ASSERT_TRUE(counted.counting);
  WatchingDevice device(true);
  run(device);
  if (!device.trapping()) GTEST_SKIP() << "this kernel cannot trap system calls for a thread (needs Linux 5.11)";
  EXPECT_EQ(system_calls.load(), 0U);
}

TEST(ServoFreedom, TheTrapWouldSeeASystemCall) {
  if (SPARSHA_SANITIZED) GTEST_SKIP() << "sanitizers make system calls of their own";
  const CountedSystemCalls counted;
  ASSERT_TRUE(counted.counting);
  bool trapping = false;
  std::thread thread([&] {
    trapping = prctl(PR_SET_SYSCALL_USER_DISPATCH, PR_SYS_DISPATCH_ON, 0UL, 0UL, &selector) == 0;
    if (!trapping) return;
    selector = kBlock;
    syscall(SYS_getppid);
    selector = kAllow;
  });
  thread.join();
  if (!trapping) GTEST_SKIP() << "this kernel cannot trap system calls for a thread (needs Linux 5.11)";
  EXPECT_EQ(system_calls.load(), 1U);
}

}  // namespace
}  // namespace sparsha::haptics
