#include "haptics/outline/line_joins.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

#include "scene/solid/surface_nodes.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;
using scene::SurfaceNode;
using scene::SurfaceNodes;

constexpr double kGap = 3.0;           // spacings between lines that go on in each other
constexpr double kStraightGap = 10.0;  // between those that do so straight on
constexpr double kStraight = 0.87;     // cosine of 30 degrees
constexpr double kShortest = 6.0;      // spacings
constexpr int kSmoothings = 3;

/// An end of a line, and who lies beside it.
struct Meeting {
  double distance_m;
  std::size_t a, b;  // ends: twice the line's number, one more for its last place
};

const LinePlace& end_of(const std::vector<ObjectLine>& lines, std::size_t end) {
  return end % 2 == 0 ? lines[end / 2].front() : lines[end / 2].back();
}

bool is_closed(const ObjectLine& line) { return line.size() > 3 && line.front().place_m == line.back().place_m; }

/// Which way a line leaves at one of its ends: from its place a gap before.
Vector3d outwards(const std::vector<ObjectLine>& lines, std::size_t end, double gap_m) {
  const ObjectLine& line = lines[end / 2];
  const Vector3d& from_m = end_of(lines, end).place_m;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const Vector3d back_m = from_m - line[end % 2 == 0 ? k : line.size() - 1 - k].place_m;
    if (back_m.norm() >= gap_m) return back_m.normalized();
  }
  return Vector3d::Zero();
}

/// Ends of open lines within a gap of each other, or straight on within a wider one; nearest first.
std::vector<Meeting> meetings(const std::vector<ObjectLine>& lines, double spacing_m) {
  const double gap_m = kGap * spacing_m;
  std::vector<SurfaceNode> ends;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    if (is_closed(lines[line])) continue;
    for (const std::size_t end : {2 * line, 2 * line + 1}) {
      const LinePlace& corner = end_of(lines, end);
      ends.push_back({corner.place_m, corner.normal, 1.0, static_cast<double>(end)});
    }
  }
  const SurfaceNodes nodes(ends, kStraightGap * spacing_m);
  std::vector<Meeting> found;
  std::vector<SurfaceNode> about;
  for (const SurfaceNode& end : ends) {
    nodes.near(nodes.cube_of(end.place_m), about);
    for (const SurfaceNode& other : about) {
      if (!(other.value > end.value) || other.normal.dot(end.normal) < SurfaceNode::kSameSide) continue;
      const auto a = static_cast<std::size_t>(end.value);
      const auto b = static_cast<std::size_t>(other.value);
      const Vector3d way_m = other.place_m - end.place_m;
      const double distance_m = way_m.norm();
      // A line meets itself only where it has gone far enough to be a loop.
      if (a / 2 == b / 2 && length_m(lines[a / 2]) < 2.0 * gap_m) continue;
      const bool straight = distance_m <= kStraightGap * spacing_m &&
                            outwards(lines, a, gap_m).dot(way_m) > kStraight * distance_m &&
                            -outwards(lines, b, gap_m).dot(way_m) > kStraight * distance_m;
      if (distance_m <= gap_m || straight) found.push_back({distance_m, a, b});
    }
  }
  std::sort(found.begin(), found.end(), [](const Meeting& x, const Meeting& y) {
    return std::tie(x.distance_m, x.a, x.b) < std::tie(y.distance_m, y.a, y.b);
  });
  return found;
}

/// Lines that go on in each other become one.
std::vector<ObjectLine> joined(std::vector<ObjectLine> lines, double spacing_m) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::erase_if(lines, [](const ObjectLine& line) { return line.empty(); });
  std::vector<std::size_t> next(2 * lines.size(), kNone);  // of each end the one that it goes on in
  for (const Meeting& meeting : meetings(lines, spacing_m)) {
    if (next[meeting.a] != kNone || next[meeting.b] != kNone) continue;
    next[meeting.a] = meeting.b;
    next[meeting.b] = meeting.a;
  }
  std::vector<bool> taken(lines.size(), false);
  std::vector<ObjectLine> found;
  const auto take = [&](std::size_t entered, bool loop) {
    ObjectLine whole;
    for (std::size_t end = entered; end != kNone && !taken[end / 2];) {
      taken[end / 2] = true;
      ObjectLine& line = lines[end / 2];
      if (end % 2 == 1) std::reverse(line.begin(), line.end());
      whole.insert(whole.end(), line.begin(), line.end());
      end = next[end ^ 1U];
    }
    if (loop && whole.front().place_m != whole.back().place_m) whole.push_back(whole.front());
    found.push_back(std::move(whole));
  };
  for (std::size_t end = 0; end < next.size(); ++end)
    if (next[end] == kNone && !taken[end / 2]) take(end, false);
  for (std::size_t line = 0; line < lines.size(); ++line)
    if (!taken[line]) take(2 * line, true);
  return found;
}

/// Without short ways back, as where the end of one run lies beside the beginning of the next.
ObjectLine without_returns(const ObjectLine& line, double spacing_m) {
  constexpr double kBack = -0.5;  // cosine of 120 degrees: a corner that is sharper is rounded by kGap
  ObjectLine kept;
  for (const LinePlace& place : line) {
    const auto goes_back = [&] {
      if (kept.size() < 2) return false;
      const Vector3d& last_m = kept.back().place_m;
      const Vector3d before_m = last_m - kept[kept.size() - 2].place_m;
      const Vector3d next_m = place.place_m - last_m;
      return next_m.norm() <= kGap * spacing_m && next_m.dot(before_m) < kBack * next_m.norm() * before_m.norm();
    };
    while (goes_back()) kept.pop_back();
    if (kept.empty() || kept.back().place_m != place.place_m) kept.push_back(place);
  }
  return kept;
}

/// Every place moves to the weighted mean of itself and its neighbours (1 2 1); ends stay. Places of several sheets lie
/// beside each other by their noise.
void smooth(ObjectLine& line) {
  if (line.size() < 3) return;
  const bool closed = is_closed(line);
  for (int pass = 0; pass < kSmoothings; ++pass) {
    const ObjectLine before = line;
    const std::size_t last = line.size() - 1;
    const auto mean = [](const LinePlace& a, const LinePlace& b, const LinePlace& c) {
      const Vector3d normal = a.normal + 2.0 * b.normal + c.normal;
      return LinePlace{0.25 * (a.place_m + 2.0 * b.place_m + c.place_m),
                       normal.norm() > 0.0 ? Vector3d(normal.normalized()) : b.normal};
    };
    for (std::size_t k = 1; k < last; ++k) line[k] = mean(before[k - 1], before[k], before[k + 1]);
    if (closed) line.front() = line.back() = mean(before[last - 1], before[0], before[1]);
  }
}

}  // namespace

double length_m(const ObjectLine& line) {
  double sum_m = 0.0;
  for (std::size_t k = 1; k < line.size(); ++k) sum_m += (line[k].place_m - line[k - 1].place_m).norm();
  return sum_m;
}

std::vector<ObjectLine> finished(std::vector<ObjectLine> lines, double spacing_m) {
  lines = joined(std::move(lines), spacing_m);
  for (ObjectLine& line : lines) {
    for (int pass = 0; pass < 2; ++pass) {  // of a closed line the second begins where the first had its middle
      line = without_returns(line, spacing_m);
      if (!is_closed(line)) continue;
      line.pop_back();
      std::rotate(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(line.size() / 2), line.end());
      line.push_back(line.front());
    }
    smooth(line);
    line = without_returns(line, spacing_m);
  }
  std::erase_if(lines, [&](const ObjectLine& line) { return length_m(line) < kShortest * spacing_m; });
  std::stable_sort(lines.begin(), lines.end(),
                   [](const ObjectLine& a, const ObjectLine& b) { return length_m(a) > length_m(b); });
  return lines;
}

}  // namespace sparsha::haptics
