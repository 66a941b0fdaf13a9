#include "pipeline/scan/formats/threemf/xml.h"

#include <algorithm>
#include <utility>

#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view without_prefix(std::string_view name) { return name.substr(name.find(':') + 1); }

}  // namespace

int XmlTags::line() const {
  return 1 + static_cast<int>(std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(tag_), '\n'));
}

Error XmlTags::error(std::string wrong, std::string expected) const {
  return file_.error("line " + std::to_string(line()) + " of its model: " + std::move(wrong), std::move(expected));
}

bool XmlTags::skip_to(std::string_view mark) {
  const std::size_t end = text_.find(mark, at_);
  if (end == std::string_view::npos) throw error("a part of the text is not closed", "'" + std::string(mark) + "'");
  at_ = end + mark.size();
  return true;
}

bool XmlTags::next() {
  for (;;) {
    tag_ = text_.find('<', at_);
    if (tag_ == std::string_view::npos) {
      tag_ = at_ = text_.size();
      return false;
    }
    at_ = tag_;
    const std::string_view rest = text_.substr(tag_);
    if (rest.starts_with("<!--")        ? skip_to("-->")
        : rest.starts_with("<![CDATA[") ? skip_to("]]>")
        : rest.starts_with("<?")        ? skip_to("?>")
        : rest.starts_with("<!")        ? skip_to(">")
                                        : false) {
      continue;
    }
    // Values may hold '>'.
    char quote = 0;
    std::size_t end = tag_ + 1;
    for (; end < text_.size() && (quote != 0 || text_[end] != '>'); ++end) {
      const char c = text_[end];
      if (quote != 0 ? c == quote : c == '"' || c == '\'') quote = quote != 0 ? '\0' : c;
    }
    if (end == text_.size()) throw error("a tag is not closed", "a complete file");
    at_ = end + 1;
    read_attributes(text_.substr(tag_ + 1, end - tag_ - 1));
    return true;
  }
}

void XmlTags::read_attributes(std::string_view tag) {
  attributes_.clear();
  opens_ = !tag.starts_with('/');
  if (!opens_) tag.remove_prefix(1);
  closes_ = !opens_ || tag.ends_with('/');
  if (opens_ && closes_) tag.remove_suffix(1);
  const std::size_t end = std::min(tag.find_first_of(kBlanks), tag.size());
  name_ = without_prefix(tag.substr(0, end));
  tag.remove_prefix(end);
  for (;;) {
    tag.remove_prefix(std::min(tag.find_first_not_of(kBlanks), tag.size()));
    if (tag.empty()) return;
    const std::size_t equals = tag.find('=');
    const std::size_t begin = equals == std::string_view::npos ? equals : tag.find_first_of("\"'", equals);
    const std::size_t stop = begin == std::string_view::npos ? begin : tag.find(tag[begin], begin + 1);
    if (stop == std::string_view::npos) throw error("an attribute has no value in quotes", "name=\"value\"");
    std::string_view name = tag.substr(0, equals);
    name = name.substr(0, name.find_last_not_of(kBlanks) + 1);
    const bool declares = name.starts_with("xmlns:");
    (declares ? namespaces_ : attributes_).emplace_back(without_prefix(name), tag.substr(begin + 1, stop - begin - 1));
    tag.remove_prefix(stop + 1);
  }
}

std::optional<std::string_view> XmlTags::value(std::string_view attribute) const {
  for (const auto& [name, value] : attributes_) {
    if (name == attribute) return value;
  }
  return std::nullopt;
}

std::optional<std::string_view> XmlTags::namespace_of(std::string_view prefix) const {
  const auto found = std::find_if(namespaces_.rbegin(), namespaces_.rend(),
                                  [&](const auto& declared) { return declared.first == prefix; });
  if (found == namespaces_.rend()) return std::nullopt;
  return found->second;
}

double XmlTags::number(std::string_view attribute) const {
  const std::optional<std::string_view> text = value(attribute);
  if (!text) throw error("element " + in_quotes(name_) + " has no " + in_quotes(attribute), "a number");
  double number = 0.0;
  const char* const end = text->data() + text->size();
  const char* const p = skip_blanks(text->data(), end);
  const char* const stop = parse_number(p, end, number);
  if (stop == nullptr || skip_blanks(stop, end) != end) throw error(in_quotes(*text) + " is no number", "a number");
  return number;
}

}  // namespace sparsha::pipeline
