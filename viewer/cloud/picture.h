// Draws the raw cloud: at once as many points as a frame has time for, all of them once the object rests.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "base/threads/thread_pool.h"
#include "viewer/cloud/controller.h"
#include "viewer/gl/objects.h"

namespace sparsha::viewer {

/// Needs a current context for its whole life. One thread.
/// That is shown from black to white.
struct IntensityRange {
  float low = 0.0F, high = 1.0F;
};

class CloudPicture {
 public:
  CloudPicture();

  /// Into a rectangle of the framebuffer, whose origin is at the top left of `window_height` pixels.
  void draw(const CloudFrame& frame, unsigned framebuffer, const Rect& rect, int window_height, bool high_contrast);

  /// The preview's picture, or 0. Its size is the preview's nx * ny.
  [[nodiscard]] unsigned preview_texture() const { return preview_.name(); }
  /// Those of status.sides beside each other, or 0.
  [[nodiscard]] unsigned sides_texture() const { return sides_ ? side_pictures_.name() : 0; }
  /// Share of the visible points in the picture that is there.
  [[nodiscard]] double share_shown() const { return share_; }
  /// True once all visible points are in the picture.
  [[nodiscard]] bool complete() const { return share_ >= 1.0; }

 private:
  void paint(const CloudFrame& frame);
  void show_sides(const std::shared_ptr<const SidePictures>& sides, bool dark);
  void splat(const CloudFrame& frame, bool changed);
  void upload(const Splatter& splatter, const SplatView& view);
  [[nodiscard]] std::vector<std::uint32_t> paint_of(const PointView& points) const;
  void take_detail(const CloudFrame& frame);
  /// use(points, their paint) of the cloud and of each part of its detail.
  template <typename Use>
  void for_each_view(const CloudFrame& frame, const Use& use) const;
  [[nodiscard]] double visible(const Splatter& splatter, const CloudFrame& frame) const;
  [[nodiscard]] SplatColours colours_of(const CloudFrame& frame, const PointView& points,
                                        const std::vector<std::uint32_t>& paint) const;
  std::uint64_t add(Splatter& splatter, const CloudFrame& frame, double from, double to, double density);

  ThreadPool pool_;
  std::vector<std::uint32_t> height_map_;
  Splatter quick_{pool_}, all_{pool_};
  gl::Texture preview_, side_pictures_;
  std::shared_ptr<const SidePictures> sides_;  ///< that side_pictures_ shows
  gl::Target target_;
  std::vector<std::uint32_t> rgba_, picture_;
  std::vector<float> heights_;

  // What the picture that is there was made from.
  const PointView* points_ = nullptr;
  CloudColour painted_ = CloudColour::height;
  std::shared_ptr<const PointDetail> detail_;
  IntensityRange intensity_;
  std::map<const PointView*, std::vector<std::uint32_t>> part_paint_;  ///< as paint_, of the parts of detail_
  std::vector<std::uint32_t> paint_;  ///< one colour per point; empty: the cloud's own or by height
  SplatView view_;
  bool dark_ = false;
  std::optional<scene::CropConfig> crop_;
  std::uint64_t previews_ = 0;
  double share_ = 0.0, refined_ = 0.0, changed_s_ = 0.0;
  double points_per_s_ = 3e7;
};

}  // namespace sparsha::viewer
