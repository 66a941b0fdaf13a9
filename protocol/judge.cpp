#include "protocol/judge.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/files/files.h"
#include "base/numbers/statistics.h"
#include "base/text/csv.h"
#include "base/text/text.h"
#include "protocol/benchmark.h"
#include "protocol/table_reader.h"

namespace sparsha::protocol {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr double kMostForce_n = 1e6;
constexpr double kMostTime = 1e12;  // s and ns
constexpr double kSameTime_s = 1e-6;
constexpr double kMostTicks = 10e6;  // per case
constexpr std::size_t kMostCases = 1000;

struct KnownCase {
  std::string name;
  std::size_t ticks = 0;
  std::string truth_sha256;
};

struct Truth {
  std::vector<double> t_s;
  std::vector<Vector3d> force_n;
  std::size_t first = 0;  ///< judged ticks
  std::size_t last = 0;
};

struct Forces {
  std::vector<Vector3d> force_n;
  std::vector<double> tick_ns;
  int first_line = 0;
};

bool is_name(std::string_view word) {
  return !word.empty() && word.size() <= 64 &&
         word.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string_view::npos;
}

std::vector<KnownCase> read_cases(const fs::path& folder) {
  std::error_code code;
  if (!fs::is_regular_file(folder / "cases.csv", code))
    throw input_error(folder.string(), "no cases.csv in it", "a folder written by `sparsha bench export`");
  TableReader table(folder / "cases.csv", {"case", "ticks", "truth_sha256"});
  std::vector<KnownCase> cases;
  while (table.next()) {
    const std::string name(csv::trimmed(table.word(0)));
    if (!is_name(name))
      throw table.wrong_at(0, csv::in_quotes(name) + " is no name of a case", "small letters, digits and dashes");
    if (std::any_of(cases.begin(), cases.end(), [&](const KnownCase& c) { return c.name == name; }))
      throw table.wrong_at(0, "case " + name + " a second time", "each case once");
    const double ticks = table.number(1, "a number of ticks", kMostTicks);
    if (ticks < 1.0 || ticks != std::floor(ticks))
      throw table.wrong_at(1, csv::in_quotes(table.word(1)) + " is no number of ticks", "1 or more");
    if (cases.size() == kMostCases) throw table.wrong_row("too many cases", "1000 at most");
    cases.push_back({name, static_cast<std::size_t>(ticks), std::string(csv::trimmed(table.word(2)))});
  }
  table.require_whole();
  if (cases.empty()) throw table.wrong_row("no cases", "a row for each case");
  return cases;
}

void require_judged_between(const Truth& truth, const TableReader& table) {
  if (truth.first >= truth.last) throw table.wrong_row("no tick is judged", "a column judged with ones in it");
  for (std::size_t tick = truth.first; tick < truth.last; ++tick)
    if (!(truth.force_n[tick].norm() > 0.0))
      throw table.wrong_row("a judged tick without a true force", "contact at every judged tick");
}

Truth read_truth(const fs::path& folder, const KnownCase& known) {
  const fs::path file = folder / truth_file(known.name);
  {
    const MappedFile mapped(file);
    if (sha256(mapped.bytes()) != known.truth_sha256)
      throw input_error(file.string(), "the file is not the one that was exported",
                        "the SHA-256 that cases.csv names; export the benchmark again");
  }
  TableReader table(file, {"t_s", "force_x_n", "force_y_n", "force_z_n", "judged"});
  Truth truth;
  while (table.next()) {
    if (truth.t_s.size() == known.ticks)
      throw table.wrong_row("more rows than ticks", count_text(known.ticks) + ", as cases.csv says");
    truth.t_s.push_back(table.number(0, "seconds", kMostTime));
    Vector3d force;
    for (int axis = 0; axis < 3; ++axis)
      force[axis] = table.number(static_cast<std::size_t>(axis) + 1, "newtons", kMostForce_n);
    truth.force_n.push_back(force);
    if (table.number(4, "0 or 1", 1.0) != 1.0) continue;
    if (truth.last == 0) truth.first = truth.t_s.size() - 1;
    truth.last = truth.t_s.size();
  }
  table.require_whole();
  if (truth.t_s.size() != known.ticks)
    throw table.wrong_row("the file ends after " + count_text(truth.t_s.size()) + " rows",
                          count_text(known.ticks) + ", as cases.csv says");
  require_judged_between(truth, table);
  return truth;
}

std::string names_of(const std::vector<KnownCase>& cases) {
  std::string text;
  for (const KnownCase& c : cases) text += (text.empty() ? "" : ", ") + c.name;
  return text;
}

Judgement judged(const std::string& name, const Forces& forces, const Truth& truth) {
  Judgement judgement;
  judgement.case_name = name;
  judgement.score = score_forces(forces.force_n, truth.force_n, truth.first, truth.last);
  judgement.ghost = ghost_share(forces.force_n, truth.force_n, truth.first, truth.last);
  judgement.worst_t_s = truth.t_s[judgement.score.worst];
  judgement.worst_line = forces.first_line + static_cast<int>(judgement.score.worst);
  if (!forces.tick_ns.empty()) {
    std::vector<double> times(forces.tick_ns.begin() + static_cast<std::ptrdiff_t>(truth.first),
                              forces.tick_ns.begin() + static_cast<std::ptrdiff_t>(truth.last));
    judgement.p50_ns = median(times);
    judgement.p99_ns = quantile(times, 0.99);
  }
  return judgement;
}

/// Reads results.csv case by case.
class Results {
 public:
  Results(const fs::path& file, const fs::path& folder, const std::vector<KnownCase>& cases)
      : table_(file, {"case", "t_s", "force_x_n", "force_y_n", "force_z_n"}, {"tick_ns"}),
        folder_(folder),
        cases_(cases) {}

  [[nodiscard]] std::vector<Judgement> read() {
    std::vector<Judgement> all;
    bool row = table_.next();
    if (!row) throw table_.wrong_row("no rows", "forces for at least one of " + names_of(cases_));
    while (row) {
      const KnownCase& known = case_of_row(all);
      const Truth truth = read_truth(folder_, known);
      Forces forces;
      forces.first_line = table_.line();
      while (row && csv::trimmed(table_.word(0)) == known.name) {
        add_row(known, truth, forces);
        row = table_.next();
      }
      if (forces.force_n.size() < known.ticks)
        throw table_.wrong_row("case " + known.name + " ends after " + count_text(forces.force_n.size()) +
                                   (forces.force_n.size() == 1 ? " row" : " rows"),
                               count_text(known.ticks) + ", one for each tick of " + path_file(known.name).string());
      all.push_back(judged(known.name, forces, truth));
    }
    table_.require_whole();
    return all;
  }

 private:
  [[nodiscard]] const KnownCase& case_of_row(const std::vector<Judgement>& done) const {
    const std::string name(csv::trimmed(table_.word(0)));
    const auto known = std::find_if(cases_.begin(), cases_.end(), [&](const KnownCase& c) { return c.name == name; });
    if (known == cases_.end())
      throw table_.wrong_at(0, csv::in_quotes(name) + " is no case of the benchmark", "one of " + names_of(cases_));
    if (std::any_of(done.begin(), done.end(), [&](const Judgement& j) { return j.case_name == name; }))
      throw table_.wrong_at(0, "case " + name + " a second time", "the rows of a case together");
    return *known;
  }
  void add_row(const KnownCase& known, const Truth& truth, Forces& forces) const {
    const std::size_t tick = forces.force_n.size();
    if (tick == known.ticks)
      throw table_.wrong_row("case " + known.name + " has more rows than ticks",
                             count_text(known.ticks) + ", one for each tick of " + path_file(known.name).string());
    if (std::abs(table_.number(1, "seconds", kMostTime) - truth.t_s[tick]) > kSameTime_s)
      throw table_.wrong_at(
          1, "time " + csv::in_quotes(csv::trimmed(table_.word(1))) + " out of order",
          value_text(truth.t_s[tick], 7) + ", the time of this row in " + path_file(known.name).string());
    Vector3d force;
    for (int axis = 0; axis < 3; ++axis)
      force[axis] = table_.number(static_cast<std::size_t>(axis) + 2,
                                  "a finite number of newtons; 0 where none was given", kMostForce_n);
    forces.force_n.push_back(force);
    if (!table_.has(5)) return;
    const double ns = table_.number(5, "nanoseconds", kMostTime);
    if (ns < 0.0)
      throw table_.wrong_at(5, csv::in_quotes(csv::trimmed(table_.word(5))) + " is negative", "nanoseconds");
    forces.tick_ns.push_back(ns);
  }

  TableReader table_;
  const fs::path& folder_;
  const std::vector<KnownCase>& cases_;
};

}  // namespace

Verdict judge(const fs::path& folder, const fs::path& results) {
  const std::vector<KnownCase> cases = read_cases(folder);
  Verdict verdict;
  verdict.cases = Results(results, folder, cases).read();
  for (const KnownCase& c : cases)
    if (std::none_of(verdict.cases.begin(), verdict.cases.end(),
                     [&](const Judgement& j) { return j.case_name == c.name; }))
      verdict.absent.push_back(c.name);
  return verdict;
}

}  // namespace sparsha::protocol
