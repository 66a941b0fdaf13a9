#include "base/files/paths.h"

#include <iterator>
#include <string>
#include <system_error>

#include "base/error.h"

namespace sparsha {
namespace fs = std::filesystem;

fs::path without_dots(const fs::path& path) {
  std::error_code code;
  fs::path result;
  for (const fs::path& part : path) {
    if (part.empty() || part == ".") continue;
    const fs::path last = result.filename();
    if (part != ".." || last == ".." || (result.empty() && !path.is_absolute())) {
      result /= part;
      continue;
    }
    if (fs::is_symlink(result, code)) {
      const fs::path target = fs::canonical(result, code);
      if (code) {
        result /= part;  // leads nowhere: whoever opens it says so
        continue;
      }
      result = target;
    }
    if (result.has_relative_path()) result = result.parent_path();  // above the root is the root
  }
  return result.empty() && !path.empty() ? fs::path(".") : result;
}

void require_possible_name(const fs::path& output) {
  std::error_code code;
  static_cast<void>(fs::symlink_status(output, code));
  if (code != std::errc::filename_too_long) return;
  const std::string bytes = std::to_string(output.filename().string().size());
  throw Error(ErrorKind::usage, {output.string(), 0, 0},
              "the output's name of " + bytes + " bytes or its path is too long", "a shorter one, e.g. by --out");
}

fs::path path_from(const fs::path& folder, const fs::path& file) {
  std::error_code code;
  const fs::path base = fs::weakly_canonical(fs::absolute(folder.empty() ? fs::path(".") : folder, code), code);
  if (code) return file;
  const fs::path absolute = without_dots(fs::absolute(file, code));
  const fs::path parent = fs::weakly_canonical(absolute.parent_path(), code);
  const fs::path by_name = absolute.lexically_relative(base);
  const fs::path by_place = code ? by_name : (parent / absolute.filename()).lexically_relative(base);
  const auto steps = [](const fs::path& p) { return std::distance(p.begin(), p.end()); };
  const fs::path& nearer = steps(by_place) < steps(by_name) ? by_place : by_name;
  return nearer.empty() ? absolute : nearer;
}

}  // namespace sparsha
