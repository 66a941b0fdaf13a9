#include "app/version_text.h"

#include <version_text.h>  // made by app/version_text.cmake: commit and features

namespace sparsha::app {

std::string version_text() { return SPARSHA_VERSION "\ncommit: " SPARSHA_COMMIT "\nfeatures: " SPARSHA_FEATURES; }

}  // namespace sparsha::app
