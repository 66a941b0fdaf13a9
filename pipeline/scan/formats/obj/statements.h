// Lines of an OBJ file or of a library of its materials, as statements.
#pragma once

#include <string>
#include <string_view>

#include "pipeline/scan/text.h"

namespace sparsha::pipeline::obj {

/// Statements of the text: comments and blank lines left out, continued lines joined.
class Statements {
 public:
  explicit Statements(std::string_view text) : lines_(text) {}

  bool next(std::string_view& statement) {
    std::string_view line;
    while (lines_.next(line)) {
      number_ = lines_.number();
      if (!line.empty() && line.back() == '\\') {
        joined_.assign(line.substr(0, line.size() - 1));
        while (lines_.next(line)) {
          joined_ += ' ';
          const bool more = !line.empty() && line.back() == '\\';
          joined_.append(more ? line.substr(0, line.size() - 1) : line);
          if (!more) break;
        }
        line = joined_;
      }
      const char* const end = line.data() + line.size();
      const char* const begin = skip_blanks(line.data(), end);
      if (begin == end || *begin == '#') continue;
      statement = {begin, static_cast<std::size_t>(end - begin)};
      return true;
    }
    return false;
  }
  /// Line on which the statement began.
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] std::size_t offset() const { return lines_.offset(); }

 private:
  LineReader lines_;
  std::string joined_;
  int number_ = 0;
};

[[nodiscard]] inline bool is_vertex(std::string_view statement) {
  return statement.size() > 1 && statement[0] == 'v' && is_blank(statement[1]);
}

/// "f", "vt" and such, and a blank behind it.
[[nodiscard]] inline bool begins_with(std::string_view statement, std::string_view keyword) {
  return statement.size() > keyword.size() && statement.starts_with(keyword) && is_blank(statement[keyword.size()]);
}

/// "f", and "fo" as the first files of Wavefront's own programs have it; 0 for others, else the keyword's length.
[[nodiscard]] inline std::size_t face_keyword(std::string_view statement) {
  return begins_with(statement, "f") ? 1 : begins_with(statement, "fo") ? 2 : 0;
}

}  // namespace sparsha::pipeline::obj
