// What all pages of a report have around their sections: style, heading and end.
#pragma once

#include <string>

namespace sparsha::pipeline {

/// Up to and with the lead. `title` and `lead` are HTML, `kind` is what the page is ("Scan report"). The header stays
/// open: a page may add its navigation, and closes it.
[[nodiscard]] std::string page_head(const std::string& title, const std::string& kind, const std::string& lead);

/// After the last section.
[[nodiscard]] std::string page_end();

}  // namespace sparsha::pipeline
