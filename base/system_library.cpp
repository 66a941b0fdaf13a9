// The dynamic linker of POSIX; nothing on other systems.
#include "base/system_symbol.h"

#if !defined(_WIN32)
#include <dlfcn.h>
#endif

namespace sparsha::system {

void* find_symbol(const char* name) {
#if !defined(_WIN32)
  return dlsym(RTLD_DEFAULT, name);
#else
  static_cast<void>(name);
  return nullptr;
#endif
}

}  // namespace sparsha::system
