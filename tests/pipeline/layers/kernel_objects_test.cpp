// The AVX law: an object compiled for a newer processor must not lend inline functions to the rest of the program.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <regex>
#include <string>

#include "tests/support/sanitized.h"

namespace {

std::string output_of(const std::string& command) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> buffer{};
  while (pipe && std::fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) text += buffer.data();
  return text;
}

TEST(KernelObjects, DefineNoWeakSymbol) {
#if SPARSHA_SANITIZED
  GTEST_SKIP() << "sanitizers add weak symbols of their own";
#endif
  const std::regex kernel("[a-z0-9_]*kernels?(_avx[0-9]*)?\\.cpp\\.o");
  int kernels = 0;
  for (const char* library : {SPARSHA_LAYERS_LIBRARY, SPARSHA_PROJECTION_LIBRARY}) {
    const std::string symbols = output_of("nm -A -C '" + std::string(library) + "' 2>/dev/null");
    if (symbols.empty()) GTEST_SKIP() << "nm is not installed";
    for (std::size_t begin = 0; begin < symbols.size();) {
      const std::size_t end = std::min(symbols.find('\n', begin), symbols.size());
      const std::string line = symbols.substr(begin, end - begin);
      begin = end + 1;
      if (!std::regex_search(line, kernel)) continue;
      ++kernels;
      for (const char* weak : {" W ", " V ", " u ", " w ", " v "}) {
        EXPECT_EQ(line.find(weak), std::string::npos) << line;
      }
    }
  }
  EXPECT_GT(kernels, 0);
}

}  // namespace
