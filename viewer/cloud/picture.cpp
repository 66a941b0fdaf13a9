// Points are drawn and shaded by the processor, by differences of depth (eye-dome lighting: Boucheny 2009, here of
// parallel depths); the graphics driver only shows the picture.
#include "viewer/cloud/picture.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <epoxy/gl.h>
#include <Eigen/Geometry>

#include "viewer/surface/colour_maps.h"

namespace sparsha::viewer {
namespace {

constexpr double kFrame_s = 0.016;    // for the points of one frame
constexpr double kPatience_s = 0.12;  // a view that has not changed for so long gets all points
constexpr double kOverlap = 1.35;     // splats are so much wider than points are apart
constexpr int kLargest = 7;
constexpr std::size_t kMapSteps = 256;

/// Darkens what lies below its neighbours, and puts the backdrop where there is no point. First row at the bottom.
void shade(const std::vector<std::uint32_t>& rgba, const std::vector<float>& heights, int width, int height, bool dark,
           ThreadPool& pool, std::vector<std::uint32_t>& picture) {
  constexpr int kReach_px = 2;
  constexpr float kSteep = 1.0F / (4.0F * kReach_px);
  constexpr float kNothing = 0.5F * Splatter::kEmpty;
  const auto columns = static_cast<std::size_t>(width);
  picture.resize(rgba.size());
  const auto rows = [&](std::size_t begin, std::size_t end) {
    std::vector<float> hidden(columns);
    for (std::size_t y = begin; y < end; ++y) {
      const std::size_t below = y < kReach_px ? y : y - kReach_px;
      const std::size_t above = std::min(y + kReach_px, static_cast<std::size_t>(height) - 1);
      const float* here = heights.data() + y * columns;
      std::ranges::fill(hidden, 0.0F);
      for (const std::size_t row : {below, y, above}) {
        const float* other = heights.data() + row * columns;
        for (const int shift : {-kReach_px, 0, kReach_px}) {
          const std::size_t first = shift < 0 ? kReach_px : 0, last = shift > 0 ? columns - kReach_px : columns;
          // An empty neighbour lies so low that it hides nothing.
          for (std::size_t x = first; x < last; ++x)
            hidden[x] += std::clamp((other[static_cast<std::ptrdiff_t>(x) + shift] - here[x]) * kSteep, 0.0F, 1.0F);
        }
      }
      const float up = static_cast<float>(y) / static_cast<float>(height);
      const auto grey = [&](float low, float high) {
        return dark ? 0U : static_cast<std::uint32_t>(255.0F * (low + (high - low) * up));
      };
      const std::uint32_t backdrop =
          0xFF000000U | grey(0.068F, 0.142F) << 16U | grey(0.071F, 0.145F) << 8U | grey(0.075F, 0.150F);
      for (std::size_t x = 0; x < columns; ++x) {
        const std::uint32_t colour = rgba[y * columns + x];
        // exp(-0.42 h) within 3 %.
        const float light = 1.0F / (1.0F + hidden[x] * (0.40F + 0.11F * hidden[x]));
        const auto lit = [&](unsigned bits) {
          return static_cast<std::uint32_t>(static_cast<float>(colour >> bits & 0xFFU) * light) << bits;
        };
        picture[y * columns + x] = here[x] < kNothing ? backdrop : 0xFF000000U | lit(16) | lit(8) | lit(0);
      }
    }
  };
  pool.for_ranges(static_cast<std::size_t>(height), 32, rows);
}

std::vector<std::uint32_t> height_map() {
  std::vector<std::uint32_t> map(kMapSteps);
  for (std::size_t k = 0; k < map.size(); ++k) {
    const auto c = colour_of(ColourMap::sequential, static_cast<double>(k) / (kMapSteps - 1.0));
    map[k] = 0xFF000000U | static_cast<std::uint32_t>(c[2]) << 16U | static_cast<std::uint32_t>(c[1]) << 8U | c[0];
  }
  return map;
}

/// From the first to the 99th percentile.
IntensityRange range_of(const std::vector<float>& intensity) {
  std::vector<float> sample;
  const std::size_t step = std::max<std::size_t>(intensity.size() / 20000, 1);
  for (std::size_t n = 0; n < intensity.size(); n += step)
    if (std::isfinite(intensity[n])) sample.push_back(intensity[n]);
  std::ranges::sort(sample);
  if (sample.empty()) return {};
  return {sample[sample.size() / 100], sample[sample.size() - 1 - sample.size() / 100]};
}

std::vector<std::uint32_t> paint_intensity(const std::vector<float>& intensity, const IntensityRange& range) {
  const float factor = range.high > range.low ? 225.0F / (range.high - range.low) : 0.0F;
  std::vector<std::uint32_t> paint(intensity.size());
  for (std::size_t n = 0; n < intensity.size(); ++n) {
    const float value = std::isfinite(intensity[n]) ? intensity[n] : range.low;
    const auto grey = static_cast<std::uint32_t>(std::clamp(30.0F + (value - range.low) * factor, 30.0F, 255.0F));
    paint[n] = 0xFF000000U | grey << 16U | grey << 8U | grey;
  }
  return paint;
}

/// Colours that are told apart with any colour vision (Okabe and Ito 2008), in turn.
std::vector<std::uint32_t> paint_stations(const std::vector<std::uint8_t>& stations) {
  constexpr std::array<std::uint32_t, 7> kColours{0xFF009FE6U, 0xFFE9B456U, 0xFF739E00U, 0xFF42E4F0U,
                                                  0xFFB27200U, 0xFF005ED5U, 0xFFA779CCU};
  std::vector<std::uint32_t> paint(stations.size());
  for (std::size_t n = 0; n < stations.size(); ++n) paint[n] = kColours[stations[n] % kColours.size()];
  return paint;
}

}  // namespace

CloudPicture::CloudPicture() : height_map_(height_map()) {}

std::vector<std::uint32_t> CloudPicture::paint_of(const PointView& points) const {
  if (painted_ == CloudColour::intensity) return paint_intensity(points.intensity, intensity_);
  if (painted_ == CloudColour::stations) return paint_stations(points.station);
  return {};
}

void CloudPicture::paint(const CloudFrame& frame) {
  const PointView& points = *frame.status.points;
  painted_ = frame.colour;
  points_ = &points;
  if (painted_ == CloudColour::intensity) intensity_ = range_of(points.intensity);
  paint_ = paint_of(points);
  part_paint_.clear();
}

void CloudPicture::take_detail(const CloudFrame& frame) {
  detail_ = frame.status.detail;
  std::map<const PointView*, std::vector<std::uint32_t>> paint;
  if (detail_) {
    for (const auto& part : detail_->parts) {
      const auto painted = part_paint_.find(part.get());
      paint[part.get()] = painted != part_paint_.end() ? std::move(painted->second) : paint_of(*part);
    }
  }
  part_paint_.swap(paint);
}

template <typename Use>
void CloudPicture::for_each_view(const CloudFrame& frame, const Use& use) const {
  use(*frame.status.points, paint_);
  if (!detail_) return;
  for (const auto& part : detail_->parts) use(*part, part_paint_.at(part.get()));
}

double CloudPicture::visible(const Splatter& splatter, const CloudFrame& frame) const {
  std::uint64_t count = 0;
  for_each_view(frame, [&](const PointView& points, const auto&) { count += splatter.visible(points); });
  return static_cast<double>(std::max<std::uint64_t>(count, 1));
}

void CloudPicture::show_sides(const std::shared_ptr<const SidePictures>& sides, bool dark) {
  if (sides_ == sides && dark_ == dark) return;
  sides_ = sides;
  if (!sides || sides->sides.empty() || sides->side_px <= 0) return sides_.reset();
  const auto side = static_cast<std::size_t>(sides->side_px);
  const std::size_t columns = side * sides->sides.size();
  std::vector<std::uint32_t> texels(columns * side);
  const std::uint32_t nothing = dark ? 0xFF000000U : 0xFF262524U;
  for (std::size_t n = 0; n < sides->sides.size(); ++n) {
    for (std::size_t k = 0; k < std::min(side * side, sides->sides[n].grey.size()); ++k) {
      const std::uint32_t grey = sides->sides[n].grey[k];
      texels[(side - 1 - k / side) * columns + n * side + k % side] =
          grey == SidePictures::kNothing ? nothing : 0xFF000000U | grey << 16U | grey << 8U | grey;
    }
  }
  side_pictures_ = gl::Texture(static_cast<int>(columns), static_cast<int>(side), gl::Format::rgba8, gl::Filter::linear,
                               texels.data());
}

SplatColours CloudPicture::colours_of(const CloudFrame& frame, const PointView& points,
                                      const std::vector<std::uint32_t>& paint) const {
  SplatColours colours;
  if (frame.colour == CloudColour::scan) {
    colours.point = points.rgba;
  } else if (frame.colour != CloudColour::height) {
    colours.point = paint;
  }
  colours.heights = height_map_;
  const Eigen::Vector3d origin = (frame.setup.scan_to_grid * points.origin_m.homogeneous()).head<3>();
  const double target = frame.view.scan_to_view.row(2).dot(frame.view.target_m);
  colours.low_m = frame.preview.low_m.z() - origin.z() - target;
  colours.high_m = frame.preview.high_m.z() - origin.z() - target;
  return colours;
}

std::uint64_t CloudPicture::add(Splatter& splatter, const CloudFrame& frame, double from, double to, double density) {
  const bool finer = detail_ && detail_->spacing_m > 0.0;
  const double spacing_m = finer ? detail_->spacing_m : frame.status.points->spacing_m;
  const double apart_px = spacing_m * scale_of(frame.setup.scan_to_grid) * frame.view.pixels_per_m / std::sqrt(density);
  const int size = std::clamp(static_cast<int>(std::ceil(kOverlap * apart_px)), 1, kLargest);
  const auto began = std::chrono::steady_clock::now();
  std::uint64_t count = 0;
  for_each_view(frame, [&](const PointView& points, const std::vector<std::uint32_t>& paint) {
    count += splatter.add(points, colours_of(frame, points, paint), crop_of(frame.setup, points), from, to, size);
  });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  constexpr std::uint64_t kEnough = 20000;  // points that a time says something of
  if (count >= kEnough && seconds > 0.0) points_per_s_ += 0.3 * (static_cast<double>(count) / seconds - points_per_s_);
  return count;
}

void CloudPicture::upload(const Splatter& splatter, const SplatView& view) {
  splatter.read(rgba_, heights_);
  shade(rgba_, heights_, view.width, view.height, dark_, pool_, picture_);
  if (target_.width() != view.width || target_.height() != view.height)
    target_ = gl::Target(view.width, view.height, false, gl::Filter::nearest);
  target_.upload(picture_.data());
}

void CloudPicture::splat(const CloudFrame& frame, bool changed) {
  if (changed) {
    take_detail(frame);
    quick_.clear(frame.view);
    share_ = frame.finished ? 1.0 : std::min(1.0, points_per_s_ * kFrame_s / visible(quick_, frame));
    add(quick_, frame, 0.0, share_, share_);
    upload(quick_, frame.view);
    changed_s_ = frame.time_s;
    refined_ = 0.0;
    return;
  }
  // The picture that is there stays until one with the new detail is whole.
  if (share_ >= 1.0 && detail_ != frame.status.detail) {
    take_detail(frame);
    share_ = 0.99;
    refined_ = 0.0;
  }
  if (share_ >= 1.0 || frame.time_s - changed_s_ < kPatience_s) return;
  if (refined_ == 0.0) all_.clear(frame.view);
  const double to = std::min(1.0, refined_ + std::max(0.02, points_per_s_ * kFrame_s / visible(all_, frame)));
  add(all_, frame, refined_, to, 1.0);
  refined_ = to;
  if (refined_ < 1.0) return;
  share_ = 1.0;
  upload(all_, frame.view);
}

void CloudPicture::draw(const CloudFrame& frame, unsigned framebuffer, const Rect& rect, int window_height,
                        bool high_contrast) {
  const int bottom = window_height - rect.y - rect.height;
  const bool any = frame.status.points != nullptr && !frame.status.points->points.empty();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  if (!any) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(rect.x, bottom, rect.width, rect.height);
    glClearColor(0.068F, 0.068F, 0.068F, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
    points_ = nullptr;
    detail_.reset();
    part_paint_.clear();
    return;
  }
  show_sides(frame.status.sides, high_contrast);
  bool changed = points_ != frame.status.points.get() || !(view_ == frame.view) ||
                 !same_crop(crop_, frame.setup.crop) || dark_ != high_contrast ||
                 (frame.finished && (share_ < 1.0 || detail_ != frame.status.detail));
  if (points_ != frame.status.points.get() || painted_ != frame.colour) {
    paint(frame);
    changed = true;
  }
  view_ = frame.view;
  dark_ = high_contrast;
  crop_ = frame.setup.crop;
  if (previews_ != frame.previews && frame.preview.any) {
    previews_ = frame.previews;
    preview_ = gl::Texture(frame.preview.nx, frame.preview.ny, gl::Format::rgba8, gl::Filter::linear,
                           shade(frame.preview).data());
  }
  splat(frame, changed);
  target_.copy_to(framebuffer, rect.x, bottom);
  glViewport(rect.x, bottom, rect.width, rect.height);
}

}  // namespace sparsha::viewer
