// The table of kernels for the instruction set of the file that includes this.
#pragma once

#include "pipeline/projection/simd/bins.h"
#include "pipeline/projection/simd/disc_nodes.h"
#include "pipeline/projection/simd/discs.h"
#include "pipeline/projection/simd/facing.h"
#include "pipeline/projection/simd/group.h"
#include "pipeline/projection/simd/points.h"
#include "pipeline/projection/simd/sort.h"

namespace {

void orient_points(const float* xyz, std::size_t stride, std::size_t count, const double* matrix, float* x, float* y,
                   float* z, float* low, float* high) {
  orient(xyz, stride, count, matrix, x, y, z, low, high);
}
std::size_t draw_points(const float* xyz, std::size_t stride, std::size_t count, std::uint32_t limit,
                        std::uint32_t* drawn) {
  return draw(xyz, stride, count, limit, drawn);
}
std::size_t draw_block_points(const sparsha::pipeline::BlockKernel& kernel, const float* x, const float* y,
                              std::size_t count, std::uint32_t* drawn) {
  return draw_of_blocks(kernel, x, y, count, drawn);
}
std::size_t draw_border_points(const sparsha::pipeline::BorderKernel& kernel, const float* x, const float* y,
                               std::size_t count, std::uint32_t* drawn) {
  return draw_beyond(kernel, x, y, count, drawn);
}
void index_band_points(const sparsha::pipeline::BandKernel& kernel, const float* x, const float* y, std::size_t count,
                       std::int32_t* band, std::int32_t* bin) {
  index(kernel, x, y, count, band, bin);
}
void send_points(const sparsha::pipeline::BandSend& points, std::size_t count) { send(points, count); }
void sort_few_bins(const sparsha::pipeline::BinSort& sort, std::size_t bins) { sort_few(sort, bins); }
void fit_nodes(const sparsha::pipeline::NodeKernel& kernel, std::size_t j_begin, std::size_t j_end, float* height,
               std::uint8_t* verdict) {
  fit_rows(kernel, j_begin, j_end, height, verdict);
}
sparsha::pipeline::LayerFit fit_one_layer(const sparsha::pipeline::LayerKernel& kernel, std::size_t count) {
  sparsha::pipeline::LayerFit fit;
  fit_all_points(kernel, count, fit);
  return fit;
}
bool rank_values(float* value, std::size_t count, std::uint32_t* rank) { return rank_descending(value, count, rank); }
void classify_points(const sparsha::pipeline::ClassifyKernel& kernel, const float* x, const float* y, const float* z,
                     std::size_t count, std::uint8_t* point_class) {
  classify(kernel, x, y, z, count, point_class);
}

void fit_row_of_discs(const sparsha::pipeline::DiscKernel& kernel, std::size_t row) { fit_discs(kernel, row); }
void fit_row_of_disc_nodes(const sparsha::pipeline::DiscNodeKernel& kernel, std::size_t j, float* height,
                           std::uint8_t* verdict) {
  fit_disc_nodes(kernel, j, height, verdict);
}
std::size_t find_layers_of_discs(const sparsha::pipeline::DiscNodeKernel& kernel, std::size_t i, std::size_t j,
                                 sparsha::pipeline::DiscLayer* layers) {
  return find_disc_layers(kernel, i, j, layers);
}

std::size_t list_aligned_samples(const sparsha::pipeline::FacingKernel& kernel, std::size_t row, std::size_t column,
                                 std::size_t sample, std::uint32_t* aligned, float* cosine) {
  return list_aligned(kernel, row, column, sample, aligned, cosine);
}
void find_facing_of_discs(const sparsha::pipeline::FacingKernel& kernel, const float* x, const float* y, float* records,
                          std::size_t begin, std::size_t end) {
  find_facing(kernel, x, y, records, begin, end);
}

constexpr sparsha::pipeline::ProjectionKernels kKernels{
    orient_points,         draw_points,          draw_block_points,    draw_border_points,
    index_band_points,     send_points,          sort_few_bins,        fit_nodes,
    fit_one_layer,         rank_values,          classify_points,      fit_row_of_discs,
    fit_row_of_disc_nodes, find_layers_of_discs, list_aligned_samples, find_facing_of_discs};

}  // namespace
