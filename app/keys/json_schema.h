// The table of keys (scene/keys) as a JSON schema, by which editors complete and check a configuration while it is
// typed.
#pragma once

#include <string>

namespace sparsha::app {

/// JSON Schema, draft 7: the one that editors of YAML know.
[[nodiscard]] std::string json_schema_text();

}  // namespace sparsha::app
