// The loops over all points and all nodes. Plain pointers only; the same source is compiled for baseline x86-64, for
// AVX2 and for AVX-512, and all give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sparsha::pipeline {

/// What nodes are decided from. Arrays may be read up to kReadAhead elements beyond their ends.
struct NodeKernel {
  static constexpr std::size_t kReadAhead = 24;
  static constexpr std::size_t kMostPoints = 65536;  ///< of a window; fuller ones are left to NodeFitter

  static constexpr std::size_t kScratch = 4 * (kMostPoints + kReadAhead);
  static constexpr std::size_t kLeastRadii = 145;  ///< numbers up to those of windows that are fitted eight at a time

  /// About a node: NodeFitter has to look, its height is written, or no points surround it.
  enum Verdict : std::uint8_t { kHard, kMeasured, kUnknown };

  const std::uint32_t* start = nullptr;  ///< first point of each bin, bins_x bins a row
  const float* x = nullptr;              ///< metres
  const float* y = nullptr;
  const float* z = nullptr;
  std::size_t bins_x = 0;
  std::size_t margin = 0;  ///< bins before node 0 in x and y
  std::size_t nx = 0;      ///< nodes per row
  double x0_m = 0.0, y0_m = 0.0, spacing_m = 0.0;
  float band_m = 0.0F;   ///< half height of the band that is searched for the front
  float scale_m = 0.0F;  ///< standard deviation of residuals
  float ridge = 0.0F;    ///< prior of the slopes, see LocalFitRule
  /// 1/R^2 of the weights by the number of front points in a window of 3x3, 5x5, 7x7; more of them count like the most.
  const float* per_r2[3] = {};
  std::size_t most_of[3] = {};  ///< the highest number in each, kLeastRadii - 1 or more
  float* scratch = nullptr;     ///< kScratch floats of the calling thread
};

/// Bands of 2^band_rows_log2 rows of bins each, of a window of bins.
struct BandKernel {
  float x_shift_m = 0.0F, y_shift_m = 0.0F, per_m = 1.0F;      ///< see BinLocator
  float left = 0.0F, right = 0.0F, bottom = 0.0F, top = 0.0F;  ///< the window, in bins
  std::int32_t first_row = 0, row_length = 0;                  ///< bottom, and bins a row
  std::int32_t band_rows_log2 = 0, row_mask = 0;               ///< 2^band_rows_log2 - 1
  std::int32_t nowhere = 0;                                    ///< the band of points beyond the window
};

/// A point on its way to a bin, counted within its band.
struct BandPoint {
  float z, x, y;
  std::uint32_t bin;
};

/// Points with their bands and bins. Those of band b whose number is 4 i + r go to `to` from head[4 b + r] on.
struct BandSend {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
  const std::int32_t* band = nullptr;
  const std::int32_t* bin = nullptr;
  std::uint32_t* head = nullptr;
  BandPoint* to = nullptr;
};

/// Neighbouring bins, the points of bin b at [start[b], start[b + 1]) of the arrays. `start` and `from` may be read up
/// to kReadAhead elements beyond their ends; the others are not written beyond.
struct BinSort {
  static constexpr std::size_t kFew = 8;
  static constexpr std::size_t kReadAhead = 24;

  const std::uint32_t* start = nullptr;
  const BandPoint* from = nullptr;
  float* x = nullptr;
  float* y = nullptr;
  float* z = nullptr;
};

/// Points of one layer, relative to a node; arrays may be read and written up to kReadAhead elements beyond the last.
struct LayerKernel {
  static constexpr std::size_t kReadAhead = 24;

  float* u = nullptr;  ///< spacings
  float* v = nullptr;
  float* z = nullptr;       ///< metres, relative to a height near theirs
  float* w = nullptr;       ///< scratch
  float per_r2 = 0.0F;      ///< 1/R^2 of the weights
  float scale_m = 0.0F;     ///< standard deviation of residuals
  float ridge = 0.0F;       ///< prior of the slopes, see LocalFitRule
  float bend_ridge = 0.0F;  ///< and of coefficients of second order
};

/// Height and slopes (metres per spacing) at the node, not set unless good.
struct LayerFit {
  bool good = false;
  float height_m = 0.0F, slope_u_m = 0.0F, slope_v_m = 0.0F;
  float loss = 0.0F;          ///< weighted mean of Tukey's, 0 to 1; 0 when the residuals are noise
  std::uint32_t support = 0;  ///< points with weight
};

/// What classes of points are decided from.
struct ClassifyKernel {
  const float* height = nullptr;  ///< heights of the nodes, NaN where unknown
  std::int32_t nx = 0;
  float x0_m = 0.0F, y0_m = 0.0F, per_m = 1.0F;  ///< node (0, 0) and 1 / spacing
  float last_u = 0.0F, last_v = 0.0F;            ///< nx - 1, ny - 1
  float gap_m = 0.0F;
  std::int32_t occluded = 0, outlier = 0, undecided = 0;  ///< codes; 0 is a used point
};

/// Square blocks of points: block i holds x0_m + [i, i + 1) / per_m, and so in y.
struct BlockKernel {
  float x0_m = 0.0F, y0_m = 0.0F, per_m = 1.0F;
  std::uint32_t limit = 0;  ///< about (limit + 1) / 2^32 of the blocks are drawn
};

/// A rectangle; points in it are not wanted.
struct BorderKernel {
  float left_m = 0.0F, right_m = 0.0F, bottom_m = 0.0F, top_m = 0.0F;
};

/// Points in columns, those of each column the highest first, and what becomes of them: for each the plane through its
/// neighbours in space. Arrays may be read up to kReadAhead elements beyond their ends.
struct DiscKernel {
  static constexpr std::size_t kReadAhead = 24;
  static constexpr std::size_t kMostCandidates = 8192;  ///< of a point's neighbours; others are not looked at
  static constexpr std::size_t kScratch = 8 * (kMostCandidates + kReadAhead);

  const std::uint32_t* start = nullptr;  ///< first point of each column, bins_x columns per row
  const float* x = nullptr;              ///< metres
  const float* y = nullptr;
  const float* z = nullptr;
  std::size_t bins_x = 0;
  std::size_t first_row = 0, last_row = 0;  ///< rows of columns that are there: [first_row, last_row)
  float side_m = 0.0F;                      ///< of a column; neighbours are looked for within one to `rings` of them
  std::size_t rings = 3;
  std::int32_t wanted = 14;         ///< neighbours, about, the point itself among them
  std::int32_t least = 8;           ///< fewer make no disc
  float most_spacing_m = 0.0F;      ///< where points are farther apart, they are no surface
  float dense_spacing_m = 1e9F;     ///< points farther apart must lie in a plane, as those scattered in space do not
  float least_nz = 0.12F;           ///< planes that are steeper cover nothing
  float narrow = 0.1F;              ///< variances of points on one line, the lesser by the greater, are below
  float least_width2 = 0.0F;        ///< or the lesser is below this, m^2; more neighbours are looked at then
  float reach = 2.5F;               ///< radius of a disc, local spacings
  float noise_m = -1.0F;            ///< across the surface; negative: thin sheets are not told apart
  const float* needed_m = nullptr;  ///< of each column; lower points get no disc
  float* scratch = nullptr;         ///< kScratch floats of the calling thread

  float* foot_x = nullptr;  ///< the point, moved onto its plane
  float* foot_y = nullptr;
  float* foot_z = nullptr;
  float* slope_x = nullptr;  ///< of the plane, dz/dx
  float* slope_y = nullptr;
  float* above = nullptr;    ///< the point above its plane, along z
  float* radius2 = nullptr;  ///< square of the disc's radius; negative: there is no disc
};

/// Values of a disc's record: x, y, z of the foot, slopes in x and y, the point above its plane, squared radius, facing
/// (1 towards the viewer, -1 away, 0 unknown).
constexpr std::size_t kDiscRecord = 8;

/// Discs in columns, and the nodes that they may cover.
struct DiscNodeKernel {
  static constexpr std::size_t kReadAhead = 24;
  static constexpr std::size_t kMostDiscs = 2048;  ///< over a node; others are not looked at
  static constexpr std::size_t kLeastDiscs = 3;
  static constexpr std::size_t kMostLayers = 64;  ///< of a node, where all are wanted
  static constexpr std::size_t kScratch = 13 * (kMostDiscs + kReadAhead);

  /// What was found at a node, one bit each.
  enum Verdict : std::uint8_t {
    kUnknown = 0,
    kMeasured = 1,
    kAway = 2,      ///< the highest layer faces away, and nothing near faces the viewer: its front was not scanned
    kDoubtful = 4,  ///< another layer follows so closely that the two were hard to tell apart
    kUnsure = 8,    ///< nothing tells which way the layer faces
    kEdge = 16,     ///< the highest layer faces away, and one that faces the viewer comes near: below a silhouette
  };

  const std::uint32_t* start = nullptr;  ///< first disc of each column, bins_x + 1 values per row
  const float* x = nullptr;              ///< the discs, as DiscKernel has them
  const float* y = nullptr;
  const float* slope_x = nullptr;
  const float* slope_y = nullptr;
  const float* radius2 = nullptr;
  const float* records = nullptr;       ///< kDiscRecord values a disc: all of the above and z, point, facing
  const std::uint8_t* rings = nullptr;  ///< columns to each side of one whose discs may cover its nodes
  std::size_t bins_x = 0;
  std::size_t first_row = 0, last_row = 0;         ///< rows of columns that are there: [first_row, last_row)
  float columns_x0_m = 0.0F, columns_y0_m = 0.0F;  ///< corner of column (0, 0)
  float per_side = 1.0F;                           ///< one over the side of a column
  double x0_m = 0.0, y0_m = 0.0, spacing_m = 0.0;  ///< node (0, 0)
  std::size_t nx = 0;
  float per_reach = 0.4F;      ///< local spacings a disc's radius
  float link_noise_m = 0.0F;   ///< discs whose heights differ by less than this and
  float link_spacings = 0.5F;  ///< so many local spacings are one layer
  float most_away = 0.3F;      ///< a layer of which more faces away is no front
  bool lines = false;          ///< what surrounds a node hides what is below, even if it is no layer
  float* scratch = nullptr;    ///< kScratch floats of the calling thread
};

/// A layer of discs that surrounds a node.
struct DiscLayer {
  float height = 0.0F;                   ///< at the node, metres
  float slope_x = 0.0F, slope_y = 0.0F;  ///< of the surface there
  float spacing = 0.0F;                  ///< of the points about it, metres
};

/// A sample of the cloud in columns, with votes on the side of the surface that is outside. Arrays may be read up to
/// kReadAhead elements beyond their ends.
struct FacingKernel {
  static constexpr std::size_t kReadAhead = 24;

  const std::uint32_t* start = nullptr;  ///< first sample of each column, columns + 1 values per row
  std::size_t columns = 0, rows = 0;
  float x_shift_m = 0.0F, y_shift_m = 0.0F, per_m = 1.0F;  ///< see BinLocator
  const float* x = nullptr;                                ///< metres
  const float* y = nullptr;
  const float* z = nullptr;
  const float* normal_x = nullptr;  ///< unit normals, upwards
  const float* normal_y = nullptr;
  const float* normal_z = nullptr;
  const float* votes = nullptr;       ///< positive: the normal points outwards
  const float* away_top_m = nullptr;  ///< of each column: what is higher faces the viewer
  float reach2 = 0.0F;                ///< samples beside a place are nearer than this, squared
  float sheet_m = 0.0F;               ///< and no farther from its tangent plane
  float aligned = 0.6F;               ///< cosine of their normals, at least
  float sure = 0.5F;                  ///< mean vote, at least, of a side that is known
};

/// The kernels for one instruction set.
struct ProjectionKernels {
  /// out = matrix (row-major 3x4) * point in double, each coordinate rounded once; `stride` in floats. low[3] and
  /// high[3] are the points' box.
  void (*orient)(const float* xyz, std::size_t stride, std::size_t count, const double* matrix, float* x, float* y,
                 float* z, float* low, float* high);
  /// A sample of the points, about (limit + 1) / 2^32 of them, chosen by a hash of the coordinates: writes their
  /// numbers and returns how many.
  std::size_t (*draw)(const float* xyz, std::size_t stride, std::size_t count, std::uint32_t limit,
                      std::uint32_t* drawn);
  /// Points in a sample of square blocks, chosen by a hash of the block: writes their numbers and returns how many.
  std::size_t (*draw_blocks)(const BlockKernel& kernel, const float* x, const float* y, std::size_t count,
                             std::uint32_t* drawn);
  /// Points that are not inside the rectangle: writes their numbers and returns how many.
  std::size_t (*draw_border)(const BorderKernel& kernel, const float* x, const float* y, std::size_t count,
                             std::uint32_t* drawn);
  /// Band of each point, and bin within the band.
  void (*index_bands)(const BandKernel& kernel, const float* x, const float* y, std::size_t count, std::int32_t* band,
                      std::int32_t* bin);
  /// Copies points to their bands and moves the heads on.
  void (*send_to_bands)(const BandSend& send, std::size_t count);
  /// Copies the points of bins, the highest first, equal heights by x, then y. What it leaves of bins with more than
  /// kFew points is not to be used.
  void (*sort_bins)(const BinSort& sort, std::size_t bins);
  /// Nodes that need no slow path: one layer in front, all around, with residuals of noise or a bend; or a window whose
  /// one layer is not all around. Heights of rows [j_begin, j_end) into height, and NodeKernel::Verdict into verdict,
  /// nx a row.
  void (*fit_rows)(const NodeKernel& kernel, std::size_t j_begin, std::size_t j_end, float* height,
                   std::uint8_t* verdict);
  /// Robust plane or quadric through all points of a layer.
  LayerFit (*fit_layer)(const LayerKernel& kernel, std::size_t count);
  /// rank[k] = how many values are greater than value k; false when two are equal. `value` is read, and may be written,
  /// up to kReadAhead elements beyond the last.
  bool (*rank_descending)(float* value, std::size_t count, std::uint32_t* rank);
  /// Points in cells with a measured node; `undecided` for the others and for the last few.
  void (*classify)(const ClassifyKernel& kernel, const float* x, const float* y, const float* z, std::size_t count,
                   std::uint8_t* point_class);
  /// The discs of the points in a row of columns.
  void (*fit_discs)(const DiscKernel& kernel, std::size_t row);
  /// Heights of row j of nodes, and DiscNodeKernel::Verdict of each; heights of nodes that are not measured are not
  /// set.
  void (*fit_disc_nodes)(const DiscNodeKernel& kernel, std::size_t j, float* height, std::uint8_t* verdict);
  /// Every layer of node (i, j) that surrounds it, the highest first; returns how many, at most
  /// DiscNodeKernel::kMostLayers. Facing is not looked at.
  std::size_t (*find_disc_layers)(const DiscNodeKernel& kernel, std::size_t i, std::size_t j, DiscLayer* layers);
  /// The samples on the same surface as one of a column, itself among them, and the cosines of their normals with its
  /// own; returns how many. There is room for kReadAhead more than the columns around hold.
  std::size_t (*list_aligned)(const FacingKernel& kernel, std::size_t row, std::size_t column, std::size_t sample,
                              std::uint32_t* aligned, float* cosine);
  /// Sets the facing in the records of discs [begin, end) that stand at x and y.
  void (*find_facing)(const FacingKernel& kernel, const float* x, const float* y, float* records, std::size_t begin,
                      std::size_t end);
};

[[nodiscard]] const ProjectionKernels& baseline_kernels();
[[nodiscard]] const ProjectionKernels& avx2_kernels();
[[nodiscard]] const ProjectionKernels& avx512_kernels();
[[nodiscard]] bool has_avx512();  ///< all that avx512_kernels() need

/// The fastest that this machine runs.
[[nodiscard]] const ProjectionKernels& fastest_kernels();

}  // namespace sparsha::pipeline
