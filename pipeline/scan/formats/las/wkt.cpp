// The little of OGC well-known text that tells units: KEYWORD[value, ..., KEYWORD[...], ...].
#include <algorithm>
#include <vector>

#include "base/text/lower_case.h"
#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::las {
namespace {

struct Element {
  std::string keyword;          ///< lower case
  std::vector<double> numbers;  ///< in order
  std::vector<Element> children;

  [[nodiscard]] const Element* find(std::initializer_list<std::string_view> keywords) const {
    for (const Element& child : children) {
      for (const std::string_view wanted : keywords) {
        if (child.keyword == wanted) return &child;
      }
    }
    return nullptr;
  }
};

class Parser {
 public:
  explicit Parser(std::string_view text) : p_(text.data()), end_(text.data() + text.size()) {}

  /// All elements one behind the other: ESRI writes the system of heights after that of x and y.
  std::vector<Element> parse() {
    std::vector<Element> elements;
    while (p_ < end_) {
      const char* const before = p_;
      elements.push_back(element(0));
      if (p_ == before) ++p_;
      skip();
    }
    return elements;
  }

 private:
  static constexpr int kDeepest = 64;

  void skip() {
    while (p_ < end_ && (is_blank(*p_) || *p_ == '\n' || *p_ == '\r' || *p_ == ',')) ++p_;
  }

  Element element(int depth) {
    Element result;
    skip();
    const char* const begin = p_;
    while (p_ < end_ && *p_ != '[' && *p_ != '(' && *p_ != ']' && *p_ != ')' && *p_ != ',') ++p_;
    result.keyword = lower_case({begin, static_cast<std::size_t>(p_ - begin)});
    while (!result.keyword.empty() && is_blank(result.keyword.back())) result.keyword.pop_back();
    if (p_ == end_ || (*p_ != '[' && *p_ != '(')) return result;
    ++p_;
    if (depth >= kDeepest) {
      p_ = end_;
      return result;
    }
    for (skip(); p_ < end_ && *p_ != ']' && *p_ != ')'; skip()) {
      double number = 0.0;
      if (*p_ == '"') {
        ++p_;
        while (p_ < end_ && *p_ != '"') ++p_;
        if (p_ < end_) ++p_;
      } else if (const char* const stop = parse_number(p_, end_, number); stop != nullptr) {
        result.numbers.push_back(number);
        p_ = stop;
      } else {
        const char* const before = p_;
        result.children.push_back(element(depth + 1));
        if (p_ == before) ++p_;
      }
    }
    if (p_ < end_) ++p_;
    return result;
  }

  const char* p_;
  const char* end_;
};

/// Metres in the unit of a system: its own, else that of its axes (WKT 2); 0 without.
double unit_of(const Element& system) {
  const std::initializer_list<std::string_view> units = {"unit", "lengthunit"};
  if (const Element* unit = system.find(units)) return unit->numbers.empty() ? 0.0 : unit->numbers[0];
  if (const Element* axis = system.find({"axis"})) {
    if (const Element* unit = axis->find(units)) return unit->numbers.empty() ? 0.0 : unit->numbers[0];
  }
  return 0.0;
}

/// Depths: AXIS["Depth",DOWN], or the direction -1 of ESRI.
bool counts_down(const Element& system) {
  return std::any_of(system.children.begin(), system.children.end(), [](const Element& child) {
    if (child.keyword == "axis") return child.find({"down"}) != nullptr;
    return child.keyword == "parameter" && !child.numbers.empty() && child.numbers.front() == -1.0;
  });
}

void read_system(const Element& system, WktUnits& units) {
  const std::string& keyword = system.keyword;
  if (keyword == "compd_cs" || keyword == "compoundcrs" || keyword == "boundcrs" || keyword == "sourcecrs") {
    for (const Element& child : system.children) read_system(child, units);
  } else if (keyword == "projcs" || keyword == "projcrs" || keyword == "projectedcrs" || keyword == "local_cs" ||
             keyword == "engcrs" || keyword == "geoccs") {
    units.horizontal_m = unit_of(system);
  } else if (keyword == "geogcs" || keyword == "geogcrs" || keyword == "geographiccrs") {
    units.geographic = true;
  } else if (keyword == "geodcrs" || keyword == "geodeticcrs") {
    const Element* cs = system.find({"cs"});
    const Element* kind = cs != nullptr && !cs->children.empty() ? &cs->children.front() : nullptr;
    units.geographic = kind == nullptr || kind->keyword == "ellipsoidal";
    if (!units.geographic) units.horizontal_m = unit_of(system);
  } else if (keyword == "vert_cs" || keyword == "vertcs" || keyword == "vertcrs" || keyword == "verticalcrs") {
    units.vertical_m = unit_of(system);
    units.down = counts_down(system);
  }
}

}  // namespace

WktUnits parse_wkt_units(std::string_view text) {
  WktUnits units;
  for (const Element& system : Parser(text.substr(0, text.find('\0'))).parse()) read_system(system, units);
  return units;
}

}  // namespace sparsha::pipeline::las
