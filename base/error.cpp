// Text of places and errors.
#include "base/error.h"

#include <utility>

namespace sparsha {
namespace {

std::string message(const Place& place, const std::string& wrong, const std::string& expected) {
  std::string text = to_string(place);
  if (!text.empty()) text += ": ";
  text += "error: " + wrong;
  // What libraries say of themselves ends with one.
  if (!expected.empty() && text.ends_with('.') && !text.ends_with("..")) text.pop_back();
  if (!expected.empty()) text += "; " + expected;
  return text;
}

}  // namespace

std::string to_string(const Place& place) {
  if (place.file.empty()) return {};
  std::string text = place.file;
  if (place.line > 0) text += ":" + std::to_string(place.line);
  if (place.line > 0 && place.column > 0) text += ":" + std::to_string(place.column);
  return text;
}

Error::Error(ErrorKind kind, Place place, std::string wrong, std::string expected)
    : std::runtime_error(message(place, wrong, expected)),
      kind_(kind),
      place_(std::move(place)),
      wrong_(std::move(wrong)),
      expected_(std::move(expected)) {}

Error input_error(std::string file, std::string wrong, std::string expected) {
  return {ErrorKind::input, {std::move(file), 0, 0}, std::move(wrong), std::move(expected)};
}

Error input_error_at(std::string file, int line, std::string wrong, std::string expected) {
  return {ErrorKind::input, {std::move(file), line, 0}, std::move(wrong), std::move(expected)};
}

Error usage_error(std::string wrong, std::string expected) {
  return {ErrorKind::usage, {}, std::move(wrong), std::move(expected)};
}

}  // namespace sparsha
