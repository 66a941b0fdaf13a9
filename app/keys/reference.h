// The table of keys (scene/keys) as people read it.
#pragma once

#include <string>
#include <string_view>

namespace sparsha::app {

/// One key a line: "grid.size: whole number from 2 to 1048576. Nodes along the longer side ...". All of them, or those
/// of one block and below ("grid", "audio.regions"). Throws Error{usage} with the nearest name for a block that is
/// none.
[[nodiscard]] std::string reference_text(std::string_view block);
/// The same as a list of {key, value, unit, default, required, text}.
[[nodiscard]] std::string reference_json(std::string_view block);

}  // namespace sparsha::app
