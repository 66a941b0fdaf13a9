// Text that a terminal shows and does not apply.
#pragma once

#include <string>
#include <string_view>

namespace sparsha {

/// `text` with control characters (C0 and C1, DEL, those that turn the direction of writing) and bytes that are no
/// UTF-8 as \u001b or \xff, which JSON, too, reads as the same characters. File names and what files say may hold them.
/// Line feeds and tabs stay where `lines` allows them.
[[nodiscard]] std::string printable(std::string_view text, bool lines = false);

}  // namespace sparsha
