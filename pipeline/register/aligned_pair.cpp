#include "pipeline/register/aligned_pair.h"

#include <algorithm>
#include <cstddef>

namespace sparsha::pipeline {
namespace {

constexpr double kMostMatches = 1e15;  // whole numbers up to there are exact

}  // namespace

void add_numbers(const Eigen::Isometry3d& motion, std::vector<double>& numbers) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) numbers.push_back(motion.matrix()(row, column));
}

Eigen::Isometry3d motion_of(const double* numbers) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) motion.matrix()(row, column) = *numbers++;
  return motion;
}

std::vector<double> numbers_of(const AlignedPair& pair) {
  const PairFit::Fit& before = pair.fit.before;
  const Agreement& agreed = pair.agreement;
  const Hold& hold = pair.hold;
  std::vector<double> numbers = {pair.any_sign ? 1.0 : 0.0,
                                 pair.candidate ? 1.0 : 0.0,
                                 pair.unsure ? 1.0 : 0.0,
                                 static_cast<double>(before.matches),
                                 static_cast<double>(agreed.matches),
                                 static_cast<double>(hold.matches),
                                 before.within_m,
                                 before.overlap,
                                 before.residual_m,
                                 agreed.overlap,
                                 agreed.residual_m,
                                 agreed.least_information,
                                 hold.share,
                                 hold.least_information,
                                 hold.least_share};
  for (const Eigen::Vector3d& vector : {hold.middle, hold.turn, hold.shift_m})
    numbers.insert(numbers.end(), vector.begin(), vector.end());
  add_numbers(pair.aligned, numbers);
  return numbers;
}

bool take_numbers(const std::vector<double>& numbers, AlignedPair& pair) {
  if (numbers.size() != numbers_of({}).size()) return false;
  const auto whole = [](double number) { return number >= 0.0 && number <= kMostMatches; };
  if (!std::all_of(numbers.begin(), numbers.begin() + 6, whole)) return false;
  const double* next = numbers.data();
  const auto flag = [&] { return *next++ != 0.0; };
  const auto count = [&] { return static_cast<std::size_t>(*next++); };
  const auto number = [&] { return *next++; };
  pair.any_sign = flag();
  pair.candidate = flag();
  pair.unsure = flag();
  pair.fit.before.matches = count();
  pair.agreement.matches = count();
  pair.hold.matches = count();
  for (double* value : {&pair.fit.before.within_m, &pair.fit.before.overlap, &pair.fit.before.residual_m,
                        &pair.agreement.overlap, &pair.agreement.residual_m, &pair.agreement.least_information,
                        &pair.hold.share, &pair.hold.least_information, &pair.hold.least_share})
    *value = number();
  for (Eigen::Vector3d* vector : {&pair.hold.middle, &pair.hold.turn, &pair.hold.shift_m})
    for (double& value : *vector) value = number();
  pair.aligned = motion_of(next);
  return true;
}

}  // namespace sparsha::pipeline
