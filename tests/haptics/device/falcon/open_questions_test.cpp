// Delays on links that are late or lose answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>
#include <vector>

#include "haptics/device/falcon/open_questions.h"

namespace {

using sparsha::haptics::falcon::OpenQuestions;

TEST(OpenQuestions, AnAnswerIsThatToTheOldestQuestion) {
  OpenQuestions questions;
  questions.ask(1.0);
  questions.ask(1.0035);
  EXPECT_NEAR(questions.answer(1.010), 0.010, 1e-12);
  EXPECT_NEAR(questions.answer(1.011), 0.0075, 1e-12);
  EXPECT_EQ(questions.answer(1.012), 0.0) << "no question is open";
}

TEST(OpenQuestions, OneOfMoreThanFiftyMillisecondsAgoIsForgotten) {
  OpenQuestions questions;
  questions.ask(1.0);
  questions.ask(1.051);
  EXPECT_NEAR(questions.answer(1.052), 0.001, 1e-12);
}

TEST(OpenQuestions, MoreThanFitLoseTheOldest) {
  OpenQuestions questions;
  for (int i = 0; i < 1000; ++i) questions.ask(i * 1e-5);
  EXPECT_LT(questions.answer(999e-5), 64 * 1e-5);
}

TEST(OpenQuestions, ThatStayOpenHoldBackNewOnesUntilTheyAreAnsweredOrLost) {
  OpenQuestions questions;
  double time_s = 1.0;
  questions.ask(time_s);
  static_cast<void>(questions.answer(time_s));
  questions.ask(time_s);
  EXPECT_FALSE(questions.holds(time_s + 0.9 * OpenQuestions::kFirstLook_s));
  EXPECT_TRUE(questions.holds(time_s += 1.1 * OpenQuestions::kFirstLook_s));
  EXPECT_GT(questions.answer(time_s), 0.0);
  EXPECT_FALSE(questions.holds(time_s));
  questions.ask(time_s);
  EXPECT_FALSE(questions.holds(time_s + 1.9 * OpenQuestions::kFirstLook_s)) << "it was only late";
  EXPECT_TRUE(questions.holds(time_s += 2.1 * OpenQuestions::kFirstLook_s));
  questions.stays_silent(time_s);
  EXPECT_FALSE(questions.holds(time_s));
  EXPECT_EQ(questions.answer(time_s), 0.0) << "lost";
  questions.ask(time_s);
  EXPECT_FALSE(questions.holds(time_s + 2.0 * OpenQuestions::kFirstLook_s)) << "each look costs a tick";
  questions.ask(time_s + 0.99 * OpenQuestions::kNextLook_s);
  EXPECT_TRUE(questions.holds(time_s + 1.01 * OpenQuestions::kNextLook_s));
}

/// A device that answers in turn, seen each millisecond, and a driver that asks when it is answered, asks again after
/// 3.5 ms, and gives up a tick after 7 ms.
class Link {
 public:
  Link(double least_s, double most_s, int lose_every = 0) : delay_s_(least_s, most_s), lose_every_(lose_every) {}

  void run(std::size_t answers) {
    while (measured_s.size() < answers) tick();
  }
  std::vector<double> measured_s, true_s;
  int silent_ticks = 0;

 private:
  struct Answer {
    double asked_s, at_s;
  };
  void tick() {
    constexpr double kNever_s = 1e9, kAgain_s = 0.0035, kPatience_s = 0.007;
    const double until_s = time_s_ + kPatience_s;
    for (;;) {
      if (!waits_ && !questions_.holds(time_s_)) ask();
      const double comes_s = coming_.empty() ? kNever_s : coming_.front().at_s;
      const double again_s = waits_ ? asked_s_ + kAgain_s : kNever_s;
      time_s_ = std::max(time_s_, std::min({comes_s, again_s, until_s}));
      if (comes_s <= time_s_) return take();
      if (time_s_ >= until_s) {
        questions_.stays_silent(time_s_);
        ++silent_ticks;
        return;
      }
      ask();
    }
  }
  void ask() {
    questions_.ask(time_s_);
    asked_s_ = time_s_;
    waits_ = true;
    if (lose_every_ > 0 && ++asked_ % lose_every_ == 0) return;
    constexpr double kWire_s = 1e-4, kFrame_s = 1e-3;
    line_s_ = std::max(line_s_ + kWire_s, time_s_ + delay_s_(random_));
    coming_.push_back({time_s_, std::ceil(line_s_ / kFrame_s - 1e-9) * kFrame_s});
  }
  void take() {
    for (; !coming_.empty() && coming_.front().at_s <= time_s_; coming_.pop_front()) {
      measured_s.push_back(questions_.answer(time_s_));
      true_s.push_back(time_s_ - coming_.front().asked_s);
    }
    waits_ = false;
  }

  OpenQuestions questions_;
  std::mt19937 random_{1};
  std::uniform_real_distribution<double> delay_s_;
  std::deque<Answer> coming_;
  double time_s_ = 0.0, asked_s_ = 0.0, line_s_ = 0.0;
  bool waits_ = false;
  int lose_every_, asked_ = 0;
};

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values.at(static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

TEST(OpenQuestions, OfASteadyLinkGiveItsDelayHoweverLateItIs) {
  for (const double delay_s : {0.001, 0.003, 0.004, 0.006, 0.009, 0.012, 0.030}) {
    Link link(delay_s, delay_s);
    link.run(20000);
    for (const double share : {0.5, 0.95})
      EXPECT_NEAR(quantile(link.measured_s, share), quantile(link.true_s, share), 1e-9) << delay_s;
  }
}

TEST(OpenQuestions, OfAnUnsteadyLinkGiveTheDelaysThatCount) {
  for (const double most_s : {0.002, 0.006, 0.010, 0.020}) {
    Link link(0.001, most_s);
    link.run(20000);
    // Pauses longer than a driver waits are taken for losses, and what comes after them is credited too early.
    EXPECT_NEAR(quantile(link.measured_s, 0.95), quantile(link.true_s, 0.95), 0.05 * most_s) << most_s;
  }
}

TEST(OpenQuestions, LostAnswersNeverMakeALinkLookFasterAndSoonNoSlower) {
  for (const int lose_every : {17, 100, 1000}) {
    Link link(0.0009, 0.0009, lose_every);
    link.run(50000);
    for (std::size_t i = 0; i < link.measured_s.size(); ++i)
      ASSERT_GE(link.measured_s[i], link.true_s[i] - 1e-9) << lose_every;
    if (lose_every == 1000) {
      EXPECT_NEAR(quantile(link.measured_s, 0.95), 0.001, 1e-9) << "a good link";
    }
    // Repeated after 3.5 ms, each loss within the first look and the silence after it adds one such step.
    const double losses = 1.0 + (OpenQuestions::kFirstLook_s + 0.007) / (lose_every * 0.001);
    EXPECT_LE(quantile(link.measured_s, 0.95), 0.001 + 0.0035 * losses) << lose_every;
  }
}

}  // namespace
