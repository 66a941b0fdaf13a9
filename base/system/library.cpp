// The dynamic linker of POSIX; nothing on other systems.
#include "base/system/library.h"

#if !defined(_WIN32)
#include <dlfcn.h>
#endif

namespace sparsha::system {

#if defined(_WIN32)

void* load_library(const char*) noexcept { return nullptr; }
void* load_library(const char*, std::string& problem) {
  problem = "this system loads no shared libraries";
  return nullptr;
}
void* symbol(void*, const char*) noexcept { return nullptr; }
void* find_symbol(const char*) noexcept { return nullptr; }

#else

void* load_library(const char* name) noexcept { return ::dlopen(name, RTLD_NOW | RTLD_LOCAL); }
void* load_library(const char* name, std::string& problem) {
  void* const library = load_library(name);
  const char* const why = library == nullptr ? ::dlerror() : nullptr;
  if (library == nullptr) problem = why == nullptr ? "it cannot be loaded" : why;
  return library;
}
void* symbol(void* library, const char* name) noexcept { return ::dlsym(library, name); }
void* find_symbol(const char* name) noexcept { return ::dlsym(RTLD_DEFAULT, name); }

#endif

}  // namespace sparsha::system
