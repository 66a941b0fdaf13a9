// Values as they are written into YAML text.
#pragma once

#include <string>
#include <string_view>

namespace sparsha::yaml {

/// A scalar in double quotes that reads back as the same bytes whatever they are. Text that is no UTF-8, as names of
/// files may be, is written as YAML's !!binary (base64).
[[nodiscard]] std::string quoted(std::string_view text);

/// What may stand behind a comment's sign: on one line, control characters and bytes that are no UTF-8 as '?'.
[[nodiscard]] std::string comment(std::string_view text);

}  // namespace sparsha::yaml
