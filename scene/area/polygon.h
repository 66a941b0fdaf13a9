// A polygon made ready for fast questions: is this place inside, and how far away is the border.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace sparsha::scene {

/// The area that corners enclose, positive when they run against the clock; of a line that crosses itself the areas to
/// its left less those to its right.
[[nodiscard]] double signed_area_m2(const std::vector<std::array<double, 2>>& corners_m);

/// A closed line of corners, metres, one plane; concave ones and ones that cross themselves too: inside is what lies
/// behind an odd number of its edges (even-odd rule). Edges that are gone along twice, to a hole and back, are no
/// border. Immutable; any thread. Questions allocate nothing and take some 0.1 us, of a thousand corners less than 1
/// us.
class Polygon {
 public:
  /// A configuration has no more.
  static constexpr std::size_t kMostCorners = 1000;

  /// Finite corners in their order, with or without the first once more at the end. Fewer than three hold nothing.
  /// Takes some 0.1 s for a thousand corners whose edges all run from one end to the other, else a millisecond.
  explicit Polygon(std::vector<std::array<double, 2>> corners_m);

  /// False for a place that is not a number.
  [[nodiscard]] bool holds(double x_m, double y_m) const noexcept;
  /// From a place, inside or outside, to the nearest point of the border; `farthest_m` when there is none within it.
  [[nodiscard]] double to_border_m(double x_m, double y_m, double farthest_m) const noexcept;
  /// The place inside that lies deepest, of those half-way between the edges to its left and right; empty when nothing
  /// is inside.
  [[nodiscard]] const std::optional<std::array<double, 2>>& deepest_m() const noexcept { return deepest_m_; }
  [[nodiscard]] const std::vector<std::array<double, 2>>& corners_m() const noexcept { return corners_m_; }
  /// xmin ymin xmax ymax.
  [[nodiscard]] const std::array<double, 4>& bounds_m() const noexcept { return bounds_m_; }

 private:
  struct Edge {
    double ax, ay, bx, by;
    double inverse_per_m2;  ///< of its squared length, or 0
  };
  /// Between the heights of two corners that follow each other: always the same edges.
  struct Row {
    std::uint32_t first = 0;  ///< of row_edges_
    std::uint32_t count = 0;
    bool sorted = false;      ///< they do not cross: from left to right at every height of the row
    std::uint32_t loose = 0;  ///< of edges that cross, the first so many are in no order; the others by their middles
    double reach_m = 0.0;     ///< of these, from a middle to an end at most
  };
  /// Of an edge, or a part of a long one.
  struct Piece {
    std::array<double, 4> box_m{};
    std::uint32_t edge = 0;
  };
  /// Of a tree over pieces; the left child of a node follows it.
  struct Node {
    std::array<double, 4> box_m{};
    std::uint32_t first = 0;  ///< of node_edges_
    std::uint32_t count = 0;  ///< 0: not a leaf
    std::uint32_t right = 0;
  };
  [[nodiscard]] static double crossing_m(const Edge& edge, double y_m) noexcept;
  void leave_out_pairs();
  void make_rows();
  void put_in_order(Row& row, double low_m, double high_m);
  [[nodiscard]] bool holds_among(const Row& row, double x_m, double y_m, double middle_m) const noexcept;
  void make_tree();
  std::uint32_t make_nodes(std::vector<Piece>& pieces, std::uint32_t first, std::uint32_t count);
  void find_deepest();

  std::vector<std::array<double, 2>> corners_m_;
  std::array<double, 4> bounds_m_{};
  std::vector<Edge> edges_;
  std::vector<double> heights_m_;  ///< of the corners, each once, upwards
  std::vector<Row> rows_;          ///< one fewer
  std::vector<std::uint32_t> row_edges_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> node_edges_;
  std::optional<std::array<double, 2>> deepest_m_;
};

}  // namespace sparsha::scene
