// GDAL's VRT format: https://gdal.org/drivers/raster/vrt.html. Names are those of layers, with nothing to escape.
#include "scene/folder/vrt_file.h"

#include <fmt/format.h>

#include "scene/folder/layer_file.h"
#include "scene/scene.h"

namespace sparsha::scene {
namespace {

struct Band {
  std::string name;
  std::string file;
  int of_file = 1;     ///< number of the band in its file
  std::string type;    ///< as GDAL calls it
  std::string inside;  ///< further elements
};

std::vector<Band> bands_of(const std::string& name, double z_m) {
  const std::string file = name + ".tif";
  if (name == "mask") return {{name, file, 1, "Byte", ""}};
  if (name == "colour") {
    std::vector<Band> bands;
    for (const char* const channel : {"Red", "Green", "Blue", "Alpha"}) {
      const int number = static_cast<int>(bands.size()) + 1;
      bands.push_back({name, file, number, "Byte", fmt::format("    <ColorInterp>{}</ColorInterp>\n", channel)});
    }
    return bands;
  }
  std::string inside = "    <NoDataValue>nan</NoDataValue>\n";
  if (name == "height" || name == "envelope")
    inside += fmt::format("    <UnitType>m</UnitType>\n    <Offset>{:.17g}</Offset>\n    <Scale>1</Scale>\n", z_m);
  return {{name, file, 1, "Float32", inside}};
}

}  // namespace

std::string vrt_file(const Lattice& lattice, const SceneDescription& scene, const std::vector<std::string>& names) {
  const RasterPlace place = raster_place(lattice, scene);
  // GDAL's corner is that of the pixel, not its centre.
  std::string text = fmt::format(
      "<VRTDataset rasterXSize=\"{}\" rasterYSize=\"{}\">\n"
      "  <GeoTransform>{:.17g}, {:.17g}, 0, {:.17g}, 0, {:.17g}</GeoTransform>\n",
      lattice.nx, lattice.ny, place.x - place.step / 2, place.step, place.y + place.step / 2, -place.step);
  int number = 0;
  for (const std::string& name : names)
    for (const Band& band : bands_of(name, lattice.origin_m.z())) {
      const std::string rectangle =
          fmt::format("xOff=\"0\" yOff=\"0\" xSize=\"{}\" ySize=\"{}\"", lattice.nx, lattice.ny);
      text += fmt::format(
          "  <VRTRasterBand dataType=\"{}\" band=\"{}\">\n    <Description>{}</Description>\n{}"
          "    <SimpleSource>\n      <SourceFilename relativeToVRT=\"1\">{}</SourceFilename>\n"
          "      <SourceBand>{}</SourceBand>\n      <SrcRect {}/>\n      <DstRect {}/>\n"
          "    </SimpleSource>\n  </VRTRasterBand>\n",
          band.type, ++number, band.name, band.inside, band.file, band.of_file, rectangle, rectangle);
    }
  return text + "</VRTDataset>\n";
}

}  // namespace sparsha::scene
