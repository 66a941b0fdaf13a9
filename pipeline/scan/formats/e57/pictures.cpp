// ASTM E2807-11, section 8.4: the axis of a pinhole camera is its -z, x goes right and y up; a spherical picture has
// azimuth 0 (+x) and elevation 0 in its middle, azimuths grow to the left and elevations upwards.
#include "pipeline/scan/formats/e57/pictures.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "pipeline/scan/cloud.h"
#include "pipeline/scan/formats/texture/texture.h"

namespace sparsha::pipeline::e57 {
namespace {

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text.substr(0, text.find_last_not_of(" \t\r\n") + 1);
}

/// The bytes of a blob.
std::string blob(const ScanFile& file, const Pages& pages, const pugi::xml_node& node) {
  constexpr std::uint64_t kHeader = 16;
  const std::uint64_t offset = node.attribute("fileOffset").as_ullong();
  const std::uint64_t length = node.attribute("length").as_ullong();
  const std::uint64_t begin = pages.logical(offset, "picture");
  if (length == 0 || begin > pages.size() || pages.size() - begin < kHeader ||
      length > pages.size() - begin - kHeader) {
    throw file.error(fmt::format("a picture of {} bytes at byte {} is not in the file", length, offset),
                     "an undamaged E57 file");
  }
  std::string bytes(static_cast<std::size_t>(length), '\0');
  pages.read(begin + kHeader, bytes.data(), bytes.size());
  return bytes;
}

}  // namespace

Pose pose_of(const pugi::xml_node& node, const NumberOf& number_of) {
  const pugi::xml_node rotation = node.child("pose").child("rotation");
  const pugi::xml_node translation = node.child("pose").child("translation");
  const Eigen::Quaterniond turn(number_of(rotation.child("w")), number_of(rotation.child("x")),
                                number_of(rotation.child("y")), number_of(rotation.child("z")));
  Pose pose;
  pose.zero_turn = rotation && !(turn.norm() > 0.0);
  if (rotation && !pose.zero_turn) pose.turn = turn.normalized().toRotationMatrix();
  pose.shift = {number_of(translation.child("x")), number_of(translation.child("y")),
                number_of(translation.child("z"))};
  return pose;
}

Pictures::Shot Pictures::parse(const pugi::xml_node& image, const pugi::xml_node& form, const NumberOf& number_of) {
  const auto number = [&](const char* name) { return number_of(form.child(name)); };
  Shot shot;
  shot.pose = pose_of(image, number_of);
  shot.spherical = std::string_view(form.name()) == "sphericalRepresentation";
  shot.width = number("imageWidth");
  shot.height = number("imageHeight");
  const double focal = shot.spherical ? 1.0 : number("focalLength");
  shot.pixel_width = number("pixelWidth") / focal;
  shot.pixel_height = number("pixelHeight") / focal;
  shot.middle_x = shot.spherical ? 0.5 * shot.width : number("principalPointX");
  shot.middle_y = shot.spherical ? 0.5 * shot.height : number("principalPointY");
  return shot;
}

Pictures::Pictures(const ScanFile& file, const Pages& pages, const pugi::xml_node& images, std::string_view guid,
                   const Eigen::Vector3d& station, const NumberOf& number_of, std::vector<std::string>& warnings) {
  guid = trimmed(guid);
  if (guid.empty()) return;
  std::uint64_t pixels = 0;
  std::size_t number = 0;
  for (const pugi::xml_node& image : images.children("vectorChild")) {
    ++number;
    if (trimmed(image.child_value("associatedData3DGuid")) != guid) continue;
    pugi::xml_node form = image.child("pinholeRepresentation");
    if (!form) form = image.child("sphericalRepresentation");
    if (!form) continue;
    const std::string name = fmt::format("{}: picture {}", file.name, number);
    try {
      Shot shot = parse(image, form, number_of);
      if (!((shot.pose.shift - station).norm() <= kMostApart)) continue;
      if (!(shot.width >= 1.0 && shot.height >= 1.0 && shot.pixel_width > 0.0 && shot.pixel_height > 0.0)) {
        throw file.error("a picture without the size of its pixels", "pixelWidth and pixelHeight above 0");
      }
      const pugi::xml_node jpeg = form.child("jpegImage");
      if (static_cast<std::uint64_t>(std::min(shot.width, 1e9)) *
              static_cast<std::uint64_t>(std::min(shot.height, 1e9)) >
          kMostPixels - pixels) {
        throw file.error("a picture beyond the 67 million pixels of a scan that are kept", "smaller pictures");
      }
      shot.picture = decode_picture(blob(file, pages, jpeg ? jpeg : form.child("pngImage")), name);
      pixels += std::uint64_t{shot.picture.width} * shot.picture.height;
      if (pixels > kMostPixels) throw file.error("a picture larger than its sizes say", "an undamaged E57 file");
      shots_.push_back(std::move(shot));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      pixels = std::min(pixels, kMostPixels);
      warnings.push_back(fmt::format("picture {} of the file is not used: {}", number, error.wrong()));
    }
    file.throw_if_cancelled();
  }
}

std::optional<Eigen::Vector2d> Pictures::place(const Shot& shot, const Eigen::Vector3d& direction) {
  Eigen::Vector2d pixel;
  if (shot.spherical) {
    pixel = {shot.middle_x - std::atan2(direction.y(), direction.x()) / shot.pixel_width,
             shot.middle_y - std::atan2(direction.z(), std::hypot(direction.x(), direction.y())) / shot.pixel_height};
  } else {
    if (!(direction.z() < 0.0)) return std::nullopt;
    pixel = {shot.middle_x - direction.x() / direction.z() / shot.pixel_width,
             shot.middle_y + direction.y() / direction.z() / shot.pixel_height};
  }
  const bool inside = pixel.x() >= 0.0 && pixel.x() <= shot.width && pixel.y() >= 0.0 && pixel.y() <= shot.height;
  if (!inside) return std::nullopt;
  return Eigen::Vector2d(pixel.x() / shot.width, pixel.y() / shot.height);
}

std::uint32_t Pictures::colour(const Eigen::Vector3d& point) const {
  const Shot* best = nullptr;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double nearest = -1.0;
  for (const Shot& shot : shots_) {
    const Eigen::Vector3d direction = shot.pose.turn.transpose() * (point - shot.pose.shift);
    const std::optional<Eigen::Vector2d> where = place(shot, direction);
    if (!where) continue;
    const double along = shot.spherical ? 0.0 : -direction.z() / direction.norm();
    if (along <= nearest) continue;
    nearest = along;
    best = &shot;
    at = *where;
  }
  if (best == nullptr) return kNoColour;
  const Light light = sample(best->picture, at.x(), at.y(), Wrap::clamp, Wrap::clamp);
  return light[3] < 0.5 ? kNoColour : colour_of({light[0], light[1], light[2], 1.0});
}

}  // namespace sparsha::pipeline::e57
