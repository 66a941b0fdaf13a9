// What --version prints after the program's name.
#pragma once

#include <string>

namespace sparsha::app {

/// "0.1.0", then a line each with the commit that was built ("unknown" outside a clone) and with what the build can do.
[[nodiscard]] std::string version_text();

}  // namespace sparsha::app
