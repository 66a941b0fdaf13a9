// Text on HTML pages.
#pragma once

#include <string>
#include <string_view>

namespace sparsha {

/// Text as HTML: & < > " ' are escaped, bytes that are no valid UTF-8 become U+FFFD.
[[nodiscard]] std::string escape_html(std::string_view text);

}  // namespace sparsha
