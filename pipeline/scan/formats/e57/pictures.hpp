// Pictures of E57 files (images2D), which colour points that have no colour of their own.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <pugixml.hpp>

#include "pipeline/scan/formats/e57/pages.h"
#include "pipeline/scan/formats/texture/picture.h"

namespace sparsha::pipeline::e57 {

/// The finite number in an element; 0 without. Throws Error{input}.
using NumberOf = std::function<double(const pugi::xml_node&)>;

/// Of a scan or of a picture, to the file's frame.
struct Pose {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  bool zero_turn = false;  ///< the quaternion was zero, and is taken as none
};
[[nodiscard]] Pose pose_of(const pugi::xml_node& node, const NumberOf& number_of);

/// The pinhole and spherical pictures that were taken where a scan was made, so that nothing stands between them and
/// its points.
class Pictures {
 public:
  static constexpr double kMostApart = 0.5;                ///< metres between scanner and camera
  static constexpr std::uint64_t kMostPixels = 1U << 26U;  ///< of one scan's pictures together

  /// Those of the scan with this GUID. What is damaged or too much is left out with a warning.
  Pictures(const ScanFile& file, const Pages& pages, const pugi::xml_node& images, std::string_view guid,
           const Eigen::Vector3d& station, const NumberOf& number_of, std::vector<std::string>& warnings);

  [[nodiscard]] std::size_t size() const { return shots_.size(); }
  /// 0xAABBGGRR of a point in the file's frame, of the picture that has it nearest to its axis; kNoColour where none
  /// shows it.
  [[nodiscard]] std::uint32_t colour(const Eigen::Vector3d& point) const;

 private:
  struct Shot {
    ColourPicture picture;
    Pose pose;
    bool spherical = false;
    double width = 0.0, height = 0.0;              ///< pixels
    double pixel_width = 0.0, pixel_height = 0.0;  ///< radians where it is spherical, else metres over focal length
    double middle_x = 0.0, middle_y = 0.0;         ///< where the axis is, pixels from the top left corner
  };
  /// Where a picture shows a direction of its frame: shares of its width and height.
  static std::optional<Eigen::Vector2d> place(const Shot& shot, const Eigen::Vector3d& direction);
  static Shot parse(const pugi::xml_node& image, const pugi::xml_node& form, const NumberOf& number_of);

  std::vector<Shot> shots_;
};

}  // namespace sparsha::pipeline::e57
