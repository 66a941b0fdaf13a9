// Loaded before a program: many of its small blocks begin where a page does, as one in 256 does by chance. What tells
// arrays in files from other memory by their place alone meets them in every run.
#include <cstddef>

extern "C" {

void* __libc_malloc(std::size_t size);                           // NOLINT(bugprone-reserved-identifier): of glibc
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT(bugprone-reserved-identifier): of glibc

void* malloc(std::size_t size) {
  constexpr std::size_t kPageBytes = 4096, kSmall = 1024, kOneOf = 8;
  static thread_local std::size_t calls = 0;
  if (size < 16 || size > kSmall || (size & (size - 1)) != 0 || ++calls % kOneOf != 0) return __libc_malloc(size);
  return __libc_memalign(kPageBytes, size);
}

}  // extern "C"
