// Pictures on OBJ meshes: the libraries of materials beside the file, and which vertex lies where on which picture.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/texture/paint.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline::obj {

/// Looks for the names of libraries, and goes through the whole text when one has a picture of diffuse colour (map_Kd).
/// What cannot be read is said in the scan's warnings, a library that is not there in its notes.
[[nodiscard]] Paint paint_of(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline::obj
