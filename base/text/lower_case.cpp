// ASCII only.
#include "base/text/lower_case.h"

namespace sparsha {

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

std::string ending_of(const std::filesystem::path& file) { return lower_case(file.extension().string()); }

}  // namespace sparsha
