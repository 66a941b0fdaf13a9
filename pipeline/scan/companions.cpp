#include "pipeline/scan/companions.h"

#include <string>
#include <string_view>
#include <system_error>

#include "base/error.h"
#include "base/files/files.h"

namespace sparsha::pipeline {
namespace fs = std::filesystem;

namespace {

/// The name as it stands, or with its blanks as addresses in glTF have them.
bool names(std::string_view text, const std::string& name) {
  if (text.find(name) != std::string_view::npos) return true;
  std::string address;
  for (const char c : name) address += c == ' ' ? std::string("%20") : std::string(1, c);
  return address != name && text.find(address) != std::string_view::npos;
}

}  // namespace

bool names_companion(const fs::path& scan, const fs::path& file) {
  std::error_code code;
  const fs::path folder = scan.parent_path().empty() ? fs::path(".") : scan.parent_path();
  if (!fs::is_regular_file(file, code) || !fs::is_regular_file(scan, code) || !lies_within(file, folder)) return false;
  const std::string name = file.filename().string();
  try {
    const MappedFile mapped(scan);
    if (names(mapped.text(), name)) return true;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const fs::path& library = entry.path();
      if (library.extension() != ".mtl" && library.extension() != ".MTL") continue;
      if (names(mapped.text(), library.filename().string()) && names(MappedFile(library).text(), name)) return true;
    }
  } catch (const Error&) {  // told of when it is read
  } catch (const fs::filesystem_error&) {
  }
  return false;
}

}  // namespace sparsha::pipeline
