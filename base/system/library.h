// Shared libraries that may or may not be there.
#pragma once

#include <string>

namespace sparsha::system {

/// A shared library, found as the system finds them; null when it is not there. Stays loaded.
[[nodiscard]] void* load_library(const char* name) noexcept;
/// The same; `problem` tells why it is null.
[[nodiscard]] void* load_library(const char* name, std::string& problem);
/// A function of it or of the libraries that it needs; null when there is none.
[[nodiscard]] void* symbol(void* library, const char* name) noexcept;
/// A function of the libraries that this program is linked with; null when there is none.
[[nodiscard]] void* find_symbol(const char* name) noexcept;

}  // namespace sparsha::system
