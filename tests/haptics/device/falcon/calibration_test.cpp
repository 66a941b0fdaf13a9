// A Falcon of unknown motor scale, calibrated with a weight; the emulated motors share no code with the driver.
#include "haptics/device/falcon/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/LU>

#include "base/error.h"
#include "emulator/geometry.h"
#include "haptics/device/falcon/effort.h"
#include "haptics/device/falcon/falcon.h"
#include "tests/support/emulated_falcon.h"
#include "tests/support/test_folder.h"

namespace {

using namespace sparsha::haptics;
using namespace sparsha::haptics::falcon;
using namespace sparsha::test;
namespace emulator = sparsha::emulator;
using Eigen::Vector3d;

/// A person who homes the grip, brings it to the middle, lets go when told, and hangs a weight from it when told.
class Curator {
 public:
  /// `restless_s`: for so long does the weight swing before it hangs still.
  explicit Curator(double weight_kg, double restless_s = 0.0) : weight_kg_(weight_kg), restless_s_(restless_s) {}
  void hear(const std::string& words) {
    said.push_back(words);
    if (words.find("middle") != std::string::npos) middle_s_ = time_;
    if (words.find("Hang") != std::string::npos) hang_s_ = time_;
  }
  Vector3d operator()(double time_s, const Vector3d& force_n) {
    constexpr double kStep = 2e-5;
    for (; time_ < time_s; time_ += kStep) {
      // Arms and grip hang a little to the front, as a real grip does.
      Vector3d pull = force_n + Vector3d(0.02, -9.80665 * 0.03, -0.05) - 0.4 * velocity_;
      double mass_kg = 0.12;
      const bool let_go = middle_s_ > 0.0 && time_ > middle_s_ + 2.0;
      if (!let_go) pull += 400.0 * (wanted() - position_) - 8.0 * velocity_;
      if (hang_s_ > 0.0 && time_ > hang_s_ + 1.0) {
        const double share = std::min(1.0, (time_ - hang_s_ - 1.0) / 1.5);
        pull.y() -= share * weight_kg_ * 9.80665;
        if (time_ < hang_s_ + restless_s_) pull.x() += 0.4 * std::sin(5.0 * time_);
        mass_kg += share * weight_kg_;
      }
      velocity_ += kStep / mass_kg * pull;
      position_ += kStep * velocity_;
    }
    return position_;
  }
  [[nodiscard]] double time_s() const { return time_; }

  std::vector<std::string> said;

 private:
  [[nodiscard]] Vector3d wanted() const {
    const double t = time_;
    if (t < 1.0) return {0.0, 0.0, 0.172};
    if (t < 2.0) return {0.0, 0.0, 0.104};
    if (middle_s_ == 0.0) return {0.0, 0.0, 0.165};
    return {0.004, -0.003, 0.142};
  }

  double weight_kg_, restless_s_;
  double time_ = 0.0, middle_s_ = 0.0, hang_s_ = 0.0;
  Vector3d position_{0.0, 0.0, 0.135};
  Vector3d velocity_ = Vector3d::Zero();
};

struct Desk {
  Desk(double counts, double weight_kg, double restless_s = 0.0)
      : curator(std::make_shared<Curator>(weight_kg, restless_s)) {
    EmulatorOptions options;
    options.counts_per_newton_metre = counts;
    emulator = std::make_shared<EmulatedFalcon>(options);
    const std::shared_ptr<Curator> person = curator;
    emulator->set_hand([person](double t, const Vector3d& force) { return (*person)(t, force); });
    device = make_falcon_device(make_wire(*emulator, Clock::virtual_time), {});
  }
  [[nodiscard]] std::optional<Calibration> run(double said_weight_n) const {
    CalibrationOptions options;
    options.weight_n = said_weight_n;
    options.clock_s = [person = curator] { return person->time_s(); };
    return calibrate(*device, options, [person = curator](const std::string& words) { person->hear(words); });
  }

  std::shared_ptr<Curator> curator;
  std::shared_ptr<EmulatedFalcon> emulator;
  std::unique_ptr<Device> device;
};

TEST(FalconCalibration, AKnownWeightGivesTheCountsOfTheMotorsWithinOnePercent) {
  for (const double counts : {3500.0, 6300.0, 10000.0, 18000.0}) {
    const Desk desk(counts, 0.2);
    const auto found = desk.run(0.2 * 9.80665);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->counts_per_newton_metre / counts, 1.0, 0.01) << counts;
    EXPECT_EQ(desk.emulator->command(), (std::array<int, 3>{})) << "no force stays";
  }
}

TEST(FalconCalibration, MotorsThatHaveBecomeWarmAndAreSparedGiveTheSameCounts) {
  const Desk desk(18000.0, 0.15, 45.0);
  const auto found = desk.run(0.15 * 9.80665);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(desk.device->force_share(), 0.95) << "the case that is meant";
  EXPECT_NEAR(found->counts_per_newton_metre / 18000.0, 1.0, 0.015);
}

/// A device of a program that the machine stops now and then. `silences`: it is not heard for 0.15 s every 20 s, its
/// motors as they were.
class Stopped final : public Device {
 public:
  explicit Stopped(Device& device, bool silences = false) : device_(device), silences_(silences) {}
  [[nodiscard]] DeviceInfo info() const override { return device_.info(); }
  void wait(double timeout_s) noexcept override {
    const Steady::time_point now = Steady::now();
    if (ticks_ > 0) longest_s_ = std::max(longest_s_, std::chrono::duration<double>(now - waited_at_).count());
    waited_at_ = now;
    if (++ticks_ % 499 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(4 + (ticks_ / 499) % 3 * 10));
    device_.wait(timeout_s);
  }
  [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
    DeviceSample sample = device_.read(time_s, period_s);
    if (silent()) sample.fresh = false;
    return sample;
  }
  void write(const Vector3d& force_n) noexcept override {
    if (!silent()) device_.write(force_n);
  }
  void zero() noexcept override { device_.zero(); }
  [[nodiscard]] double force_share() const noexcept override { return device_.force_share(); }
  [[nodiscard]] const DeviceAdvice* advice() const noexcept override { return device_.advice(); }
  /// The longest time from one tick to the next.
  [[nodiscard]] double longest_s() const { return longest_s_; }

 private:
  using Steady = std::chrono::steady_clock;
  [[nodiscard]] bool silent() const noexcept { return silences_ && ticks_ % 20000 >= 15000 && ticks_ % 20000 < 15150; }

  Device& device_;
  bool silences_;
  int ticks_ = 0;
  double longest_s_ = 0.0;
  Steady::time_point waited_at_{};
};

TEST(FalconCalibration, AMachineThatStopsTheProgramNowAndThenGivesTheSameCounts) {
  constexpr double kMeant_s = 0.08;  // a busy machine may stop it longer; after 0.1 s the grip is homed anew
  constexpr int kTries = 20;
  for (const double counts : {6300.0, 18000.0}) {
    std::optional<Calibration> found;
    for (int i = 0; i < kTries && !found; ++i) {
      const Desk desk(counts, 0.15);
      Stopped stopped(*desk.device);
      CalibrationOptions options;
      options.weight_n = 0.15 * 9.80665;
      options.clock_s = [person = desk.curator] { return person->time_s(); };
      try {
        found = calibrate(stopped, options, [person = desk.curator](const std::string& words) { person->hear(words); });
      } catch (const sparsha::Error&) {
        if (stopped.longest_s() < kMeant_s) throw;
      }
    }
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->counts_per_newton_metre / counts, 1.0, 0.015) << counts;
  }
}

TEST(FalconCalibration, ASilenceOfTheDeviceIsNoWeightThatIsTooHeavy) {
  const Desk desk(10000.0, 0.15);
  Stopped silent(*desk.device, true);
  CalibrationOptions options;
  options.weight_n = 0.15 * 9.80665;
  options.clock_s = [person = desk.curator] { return person->time_s(); };
  std::optional<Calibration> found;
  EXPECT_NO_THROW(
      found = calibrate(silent, options, [person = desk.curator](const std::string& words) { person->hear(words); }));
  EXPECT_TRUE(found.has_value());
}

TEST(FalconCalibration, TellsWhatToDoInOrderAndNamesTheWeightInGrams) {
  const Desk desk(10000.0, 0.1);
  ASSERT_TRUE(desk.run(0.1 * 9.80665).has_value());
  const std::vector<std::string>& said = desk.curator->said;
  ASSERT_GE(said.size(), 4U);
  EXPECT_NE(said.front().find("Homing"), std::string::npos);
  EXPECT_NE(said[said.size() - 2].find("middle"), std::string::npos);
  EXPECT_NE(said.back().find("100 g"), std::string::npos);
}

TEST(FalconCalibration, NoWeightOrOneTooHeavyIsAnErrorThatSaysSoAndLeavesNoForce) {
  const Desk nothing(10000.0, 0.0);
  EXPECT_THROW(
      {
        try {
          static_cast<void>(nothing.run(1.96));
        } catch (const sparsha::Error& error) {
          EXPECT_NE(error.wrong().find("no weight was felt"), std::string::npos) << error.wrong();
          throw;
        }
      },
      sparsha::Error);
  EXPECT_EQ(nothing.emulator->command(), (std::array<int, 3>{}));
  const Desk heavy(10000.0, 0.7);
  EXPECT_THROW(static_cast<void>(heavy.run(0.7 * 9.80665)), sparsha::Error);
  EXPECT_EQ(heavy.emulator->command(), (std::array<int, 3>{}));
}

TEST(FalconCalibration, IsStoredReadAgainAndRefusedWhereItIsNoFalcons) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path() / "sparsha" / "falcon.yaml";
  EXPECT_FALSE(stored_calibration(file).has_value());
  store_calibration(6300.4, file);
  EXPECT_NEAR(stored_calibration(file).value(), 6300.4, 0.051);
  std::ofstream(file) << "counts_per_newton_metre: 12\n";
  EXPECT_THROW(static_cast<void>(stored_calibration(file)), sparsha::Error);
  std::ofstream(file) << "counts: 9000\n";
  EXPECT_THROW(static_cast<void>(stored_calibration(file)), sparsha::Error);
}

TEST(FalconCalibration, AFileThatIsEmptyOrAFolderIsNamedAndNotPassedOver) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path() / "falcon.yaml";
  const auto place = [&file] {
    try {
      static_cast<void>(stored_calibration(file));
    } catch (const sparsha::Error& error) {
      return error.place().file;
    }
    return std::string("no error");
  };
  std::ofstream(file) << "";
  EXPECT_EQ(place(), file.string());
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  EXPECT_EQ(place(), file.string());
}

TEST(FalconCalibration, APlaceThatCannotBeWrittenIsRefusedBeforeAnybodyHoldsAWeight) {
  const TestFolder folder;
  EXPECT_NO_THROW(require_calibration_place(folder.path() / "sparsha" / "falcon.yaml"));
  EXPECT_THROW(require_calibration_place({}), sparsha::Error) << "no home";
  std::ofstream(folder.path() / "file") << "in the way";
  EXPECT_THROW(require_calibration_place(folder.path() / "file" / "falcon.yaml"), sparsha::Error);
  EXPECT_THROW(store_calibration(9000.0, folder.path() / "file" / "falcon.yaml"), sparsha::Error);
}

TEST(FalconForce, IsAvailableInEveryDirectionWithin35MillimetresOrSmallerFiguresAreTold) {
  for (const double counts : {6300.0, 10000.0, 18000.0}) {
    FalconOptions options;
    options.counts_per_newton_metre = counts;
    const double told_n = falcon_info(options).limits.max_force_n;
    EXPECT_GT(told_n, 1.0);
    EXPECT_LE(told_n, 5.0);
    // By the emulator's own geometry: some motor of some place and direction is at its limit for more.
    double least_n = 1e9;
    for (int i = 0; i < 4000; ++i) {
      const double z = 1.0 - 2.0 * (i + 0.5) / 4000.0;
      const double turn = 2.399963 * i;
      const Vector3d direction(std::sqrt(1.0 - z * z) * std::cos(turn), std::sqrt(1.0 - z * z) * std::sin(turn), z);
      const Vector3d place = options.centre_m + 0.035 * direction;
      const auto rates = emulator::angle_rates({place.x(), place.y(), place.z()});
      ASSERT_TRUE(rates.has_value());
      Eigen::Matrix3d jacobian;
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
          jacobian(row, column) = (*rates)[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
      const Eigen::Matrix3d per_newton = jacobian.transpose().inverse();
      least_n = std::min(least_n, 4095.0 / (counts * per_newton.rowwise().norm().maxCoeff()));
    }
    EXPECT_NEAR(told_n, std::min(5.0, least_n), 0.02 * least_n) << counts;
  }
}

TEST(FalconEffort, AForceHeldForMinutesShrinksSlowlyAndAShortOneNever) {
  MotorEffort effort;
  for (int i = 0; i < 3000; ++i) effort.add({4095, 0, 0}, 0.001);
  EXPECT_EQ(effort.share(), 1.0) << "three seconds at full force";
  double largest_step = 0.0;
  for (int i = 0; i < 300000; ++i) {
    const double before = effort.share();
    effort.add({static_cast<int>(4095 * effort.share()), 0, 0}, 0.001);
    largest_step = std::max(largest_step, std::abs(effort.share() - before));
  }
  EXPECT_LT(effort.heat(), 0.30) << "five minutes more";
  EXPECT_GT(effort.share(), 0.4) << "half the current may stay for ever";
  EXPECT_LT(5.0 * largest_step, 0.005) << "newtons per millisecond";
  EXPECT_TRUE(effort.reduces());
  for (int i = 0; i < 120000; ++i) effort.add({}, 0.001);
  EXPECT_EQ(effort.share(), 1.0);
  EXPECT_FALSE(effort.reduces());
  MotorEffort touching;
  for (int i = 0; i < 600000; ++i) touching.add({1600, 1600, 1600}, 0.001);
  EXPECT_EQ(touching.share(), 1.0) << "ordinary touch for ten minutes: two fifths of the current";
}

}  // namespace
