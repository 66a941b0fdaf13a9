// Functions of libraries that may or may not be loaded.
#pragma once

namespace sparsha::system {

/// The address of a function of this program's libraries by its name; null where there is none.
[[nodiscard]] void* find_symbol(const char* name);

}  // namespace sparsha::system
