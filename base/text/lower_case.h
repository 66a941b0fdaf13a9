// Words and endings of files without regard to case.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sparsha {

/// A to Z become a to z, whatever the locale.
[[nodiscard]] std::string lower_case(std::string_view text);
/// What `file` ends with, in lower case and with its full stop: ".ply"; empty when there is none.
[[nodiscard]] std::string ending_of(const std::filesystem::path& file);

}  // namespace sparsha
