// Files that are no scan that can be read, told by what is in them: one table, asked before any reader tries.
#pragma once

#include "pipeline/scan/file.h"

namespace sparsha::pipeline {

/// The formats that can be read, for messages.
inline constexpr const char* kKnownFormats =
    "PLY, PCD, OBJ, OFF, STL, XYZ, TXT, ASC, CSV, PTS, PTX, LAS, LAZ, E57, glTF, GLB, splat, SPZ, COLMAP, 3MF, or an "
    "ESRI "
    "or Surfer "
    "grid in "
    "text";

/// Throws Error{input} that names the kind of file and says what to do, when it is a known one that cannot be read: an
/// archive, a picture, a document, a page of a server, another program's model, or a stand-in for a file that was not
/// fetched. What the name ends with counts only for kinds that have no signature of their own.
void refuse_foreign(const ScanFile& file);

}  // namespace sparsha::pipeline
