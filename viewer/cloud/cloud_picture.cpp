// Points are drawn by the processor; the graphics driver shades the picture by its depths (eye-dome lighting: Boucheny
// 2009, with differences of parallel depths).
#include "viewer/cloud/cloud_picture.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <epoxy/gl.h>
#include <Eigen/Geometry>

#include "viewer/gl/shaders.h"
#include "viewer/surface/colour_maps.h"

namespace sparsha::viewer {
namespace {

constexpr double kFrameS = 0.020;    // for the points of one frame
constexpr double kPatienceS = 0.12;  // a view that has not changed for so long gets all points
constexpr double kOverlap = 1.35;    // splats are so much wider than points are apart
constexpr int kLargest = 7;
constexpr std::size_t kMapSteps = 256;

const char* const kShade = R"(#version 330 core
uniform sampler2D colours;
uniform sampler2D heights;    // pixels above the target; far below where there is no point
uniform vec2 origin;
uniform int reach;            // pixels
uniform vec3 upper;
uniform vec3 lower;
uniform float high;           // of the rectangle, pixels
out vec4 colour;
const float kEmpty = -1e29;
const ivec2 kAround[8] = ivec2[8](ivec2(-1, -1), ivec2(0, -1), ivec2(1, -1), ivec2(-1, 0), ivec2(1, 0), ivec2(-1, 1),
                                  ivec2(0, 1), ivec2(1, 1));
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy - origin);
  float h = texelFetch(heights, p, 0).r;
  if (h < kEmpty) {
    colour = vec4(mix(lower, upper, float(p.y) / high), 1.0);
    return;
  }
  ivec2 last = textureSize(heights, 0) - 1;
  float hidden = 0.0;
  for (int k = 0; k < 8; ++k) {
    float n = texelFetch(heights, clamp(p + reach * kAround[k], ivec2(0), last), 0).r;
    if (n > kEmpty) hidden += clamp((n - h) / (4.0 * float(reach)), 0.0, 1.0);
  }
  colour = vec4(texelFetch(colours, p, 0).rgb * exp(-0.42 * hidden), 1.0);
}
)";

std::vector<std::uint32_t> height_map() {
  std::vector<std::uint32_t> map(kMapSteps);
  for (std::size_t k = 0; k < map.size(); ++k) {
    const auto c = colour_of(ColourMap::sequential, static_cast<double>(k) / (kMapSteps - 1.0));
    map[k] = 0xFF000000U | static_cast<std::uint32_t>(c[2]) << 16U | static_cast<std::uint32_t>(c[1]) << 8U | c[0];
  }
  return map;
}

/// Grey by intensity, from its first to its 99th percentile.
std::vector<std::uint32_t> paint_intensity(const std::vector<float>& intensity) {
  std::vector<float> sample;
  const std::size_t step = std::max<std::size_t>(intensity.size() / 20000, 1);
  for (std::size_t n = 0; n < intensity.size(); n += step)
    if (std::isfinite(intensity[n])) sample.push_back(intensity[n]);
  std::ranges::sort(sample);
  const float low = sample.empty() ? 0.0F : sample[sample.size() / 100];
  const float high = sample.empty() ? 1.0F : sample[sample.size() - 1 - sample.size() / 100];
  const float factor = high > low ? 225.0F / (high - low) : 0.0F;
  std::vector<std::uint32_t> paint(intensity.size());
  for (std::size_t n = 0; n < intensity.size(); ++n) {
    const float value = std::isfinite(intensity[n]) ? intensity[n] : low;
    const auto grey = static_cast<std::uint32_t>(std::clamp(30.0F + (value - low) * factor, 30.0F, 255.0F));
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

bool same(const std::optional<pipeline::CropConfig>& a, const std::optional<pipeline::CropConfig>& b) {
  return a.has_value() == b.has_value() && (!a || (a->min_m == b->min_m && a->max_m == b->max_m));
}

}  // namespace

CloudPicture::CloudPicture()
    : program_(gl::kWholeVertex, kShade), vertex_array_(gl::make_vertex_array()), height_map_(height_map()) {}

void CloudPicture::paint(const CloudFrame& frame) {
  const PointView& points = *frame.status.points;
  painted_ = frame.colour;
  points_ = &points;
  paint_.clear();
  if (frame.colour == CloudColour::intensity) paint_ = paint_intensity(points.intensity);
  if (frame.colour == CloudColour::stations) paint_ = paint_stations(points.station);
}

SplatColours CloudPicture::colours_of(const CloudFrame& frame) const {
  SplatColours colours;
  if (frame.colour == CloudColour::scan) {
    colours.point = frame.status.points->rgba;
  } else if (frame.colour != CloudColour::height) {
    colours.point = paint_;
  }
  colours.heights = height_map_;
  const PointView& points = *frame.status.points;
  const Eigen::Vector3d origin = (frame.setup.scan_to_grid * points.origin_m.homogeneous()).head<3>();
  const double target = frame.view.scan_to_view.row(2).dot(frame.view.target_m);
  colours.low_m = frame.preview.low_m.z() - origin.z() - target;
  colours.high_m = frame.preview.high_m.z() - origin.z() - target;
  return colours;
}

std::uint64_t CloudPicture::add(Splatter& splatter, const CloudFrame& frame, double from, double to, double density) {
  const PointView& points = *frame.status.points;
  const double apart_px =
      points.spacing_m * scale_of(frame.setup.scan_to_grid) * frame.view.pixels_per_m / std::sqrt(density);
  const int size = std::clamp(static_cast<int>(std::ceil(kOverlap * apart_px)), 1, kLargest);
  const auto began = std::chrono::steady_clock::now();
  const std::uint64_t count = splatter.add(points, colours_of(frame), crop_of(frame.setup, points), from, to, size);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  constexpr std::uint64_t kEnough = 20000;  // points that a time says something of
  if (count >= kEnough && seconds > 0.0) points_per_s_ += 0.3 * (static_cast<double>(count) / seconds - points_per_s_);
  return count;
}

void CloudPicture::upload(const Splatter& splatter, const SplatView& view) {
  splatter.read(rgba_, heights_);
  if (colour_texture_.width() != view.width || colour_texture_.height() != view.height) {
    colour_texture_ = gl::Texture(view.width, view.height, gl::Format::rgba8, gl::Filter::nearest, rgba_.data());
    height_texture_ = gl::Texture(view.width, view.height, gl::Format::r32f, gl::Filter::nearest, heights_.data());
    return;
  }
  colour_texture_.upload(rgba_.data());
  height_texture_.upload(heights_.data());
}

void CloudPicture::splat(const CloudFrame& frame, bool changed) {
  if (changed) {
    quick_.clear(frame.view);
    const auto visible = static_cast<double>(std::max<std::uint64_t>(quick_.visible(*frame.status.points), 1));
    share_ = frame.finished ? 1.0 : std::min(1.0, points_per_s_ * kFrameS / visible);
    add(quick_, frame, 0.0, share_, share_);
    upload(quick_, frame.view);
    changed_s_ = frame.time_s;
    refined_ = 0.0;
    return;
  }
  if (share_ >= 1.0 || frame.time_s - changed_s_ < kPatienceS) return;
  if (refined_ == 0.0) all_.clear(frame.view);
  const auto visible = static_cast<double>(std::max<std::uint64_t>(all_.visible(*frame.status.points), 1));
  const double to = std::min(1.0, refined_ + std::max(0.02, points_per_s_ * kFrameS / visible));
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
  const Eigen::Vector3f upper = high_contrast ? Eigen::Vector3f(0, 0, 0) : Eigen::Vector3f(0.150F, 0.145F, 0.142F);
  const Eigen::Vector3f lower = high_contrast ? Eigen::Vector3f(0, 0, 0) : Eigen::Vector3f(0.075F, 0.071F, 0.068F);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.x, bottom, rect.width, rect.height);
  glClearColor(lower.x(), lower.y(), lower.z(), 1.0F);
  glClear(GL_COLOR_BUFFER_BIT);
  glDisable(GL_SCISSOR_TEST);
  if (!any) {
    points_ = nullptr;
    return;
  }
  bool changed = points_ != frame.status.points.get() || !(view_ == frame.view) || !same(crop_, frame.setup.crop) ||
                 (frame.finished && share_ < 1.0);
  if (points_ != frame.status.points.get() || painted_ != frame.colour) {
    paint(frame);
    changed = true;
  }
  view_ = frame.view;
  crop_ = frame.setup.crop;
  if (previews_ != frame.previews && frame.preview.any) {
    previews_ = frame.previews;
    preview_ = gl::Texture(frame.preview.nx, frame.preview.ny, gl::Format::rgba8, gl::Filter::linear,
                           shade(frame.preview).data());
  }
  splat(frame, changed);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(rect.x, bottom, rect.width, rect.height);
  program_.use();
  colour_texture_.bind(0);
  height_texture_.bind(1);
  program_.set("colours", 0);
  program_.set("heights", 1);
  program_.set("origin", Eigen::Vector2f(static_cast<float>(rect.x), static_cast<float>(bottom)));
  program_.set("reach", 2);
  program_.set("upper", upper);
  program_.set("lower", lower);
  program_.set("high", static_cast<float>(rect.height));
  glBindVertexArray(vertex_array_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace sparsha::viewer
