// What an E57 file says of itself beside its points.
#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "pipeline/scan/formats/e57/notes.hpp"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::e57 {
namespace {

std::string text_of(const pugi::xml_node& node, const char* child) {
  std::string_view text = node.child_value(child);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return printable(text.substr(0, text.find_last_not_of(" \t\r\n") + 1));
}

/// Pictures by the way that they were projected.
std::string pictures(const pugi::xml_node& images, std::size_t used) {
  std::map<std::string, std::size_t> kinds;
  std::size_t count = 0;
  for (const pugi::xml_node& image : images.children("vectorChild")) {
    ++count;
    for (const char* kind : {"pinhole", "spherical", "cylindrical"}) {
      if (image.child((std::string(kind) + "Representation").c_str())) ++kinds[kind];
    }
  }
  if (count == 0) return {};
  std::string text = used == 0 ? fmt::format("{} pictures, which are not read", count)
                               : fmt::format("{} pictures, of which {} give points their colour", count, used);
  for (const auto& [kind, number] : kinds) text += fmt::format(", {} {}", number, kind);
  return text;
}

/// Of the first scan that is a raster of rows and columns.
std::string raster(const pugi::xml_node& scans) {
  for (const pugi::xml_node& scan : scans.children("vectorChild")) {
    const pugi::xml_node bounds = scan.child("indexBounds");
    if (!bounds.child("rowMaximum") && !bounds.child("columnMaximum")) continue;
    return fmt::format("rows {} to {}, columns {} to {}", text_of(bounds, "rowMinimum"), text_of(bounds, "rowMaximum"),
                       text_of(bounds, "columnMinimum"), text_of(bounds, "columnMaximum"));
  }
  return {};
}

}  // namespace

std::vector<std::string> notes_of(const pugi::xml_node& root, std::size_t used) {
  std::vector<std::string> notes;
  const auto add = [&](const char* what, const std::string& text) {
    if (!text.empty()) notes.push_back(fmt::format("E57: {}{}", what, text));
  };
  std::set<std::string> scanners;
  std::size_t posed = 0;
  for (const pugi::xml_node& scan : root.child("data3D").children("vectorChild")) {
    posed += scan.child("pose") ? 1 : 0;
    const std::string vendor = text_of(scan, "sensorVendor"), model = text_of(scan, "sensorModel");
    const std::string scanner = vendor.empty() || model.empty() ? vendor + model : vendor + " " + model;
    if (!scanner.empty()) scanners.insert(scanner);
  }
  add("written by ", text_of(root, "e57LibraryVersion"));
  if (!scanners.empty()) add("scanned by ", fmt::format("{}", fmt::join(scanners, ", ")));
  if (posed > 0) add("", fmt::format("{} scan positions", posed));
  add("coordinates of ", text_of(root, "coordinateMetadata"));
  add("", raster(root.child("data3D")));
  add("", pictures(root.child("images2D"), used));
  return notes;
}

}  // namespace sparsha::pipeline::e57
