// The pictures of a report: layers of level 0 as pixels with a palette, and what their legends say.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/report/colour.h"
#include "pipeline/report/report.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// One picture. Top row first; a pixel covers `nodes_per_pixel` nodes each way.
struct Picture {
  std::string
      name;  ///< file name without ending: relief, around, sides, height, texture, friction, coverage, error, filters
  std::string title;
  std::string caption;      ///< what is seen and how to read it
  std::string alternative;  ///< for those who do not see it
  ColourMap map = ColourMap::relief;
  std::string unit;          ///< of the legend's values
  double low = 0, high = 0;  ///< values of the legend's ends, in `unit`
  bool clipped = false;      ///< values beyond the ends exist and have the ends' colours
  enum class Legend { none, ramp, states, entries } legend = Legend::ramp;
  struct Entry {
    std::string label;
    Rgb colour;
  };
  std::vector<Entry> entries;  ///< with Legend::entries
  double width_m = 0;          ///< of the picture, where it is not the grid's
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  Palette palette{};
};

/// The pictures that the scene and the report have data for, in the order of the page. At most 1024 pixels a side.
[[nodiscard]] std::vector<Picture> make_pictures(const scene::Layers& base, const scene::SceneDescription& scene,
                                                 const Report& report, ThreadPool& pool);

/// Nodes that one pixel stands for, along each side.
[[nodiscard]] int nodes_per_pixel(const scene::Lattice& lattice);

}  // namespace sparsha::pipeline
