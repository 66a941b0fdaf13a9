// Any bytes as the recipe of a scan and its configuration: refused as such, or built, checked, exported and touched.
#include <cstdint>
#include <cstdio>
#include <span>

#include "tests/fuzz/fuzz_file.h"
#include "tests/support/whole_way.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path folder = sparsha::fuzz::as_file(nullptr, 0, "way").parent_path() / "whole";
  try {
    static_cast<void>(sparsha::test::go_whole_way({data, size}, folder));
  } catch (const sparsha::test::Broken& broken) {
    std::fprintf(stderr, "%s\n", broken.what());
    __builtin_trap();
  }
  return 0;
}
