#include "pipeline/report/page.h"

#include <fmt/format.h>

#include "pipeline/report/style.h"

#ifndef SPARSHA_VERSION
#define SPARSHA_VERSION "unknown"
#endif

namespace sparsha::pipeline {

std::string page_head(const std::string& title, const std::string& kind, const std::string& lead) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang='en'>\n<head>\n<meta charset='utf-8'>\n<meta name='viewport' "
      "content='width=device-width, initial-scale=1'>\n<title>{0} \u2013 {1}</title>\n<style>{2}</style>\n</head>\n"
      "<body>\n<a class='skip' href='#main'>Skip to the content</a>\n<header>\n<p "
      "class='kicker'>{1}</p>\n<h1>{0}</h1>\n"
      "<p class='lead'>{3}</p>\n",
      title, kind, kReportStyle, lead);
}

std::string page_end() {
  return fmt::format(
      "</main>\n<footer><p>Made by Sparsha {}. Lengths are in the unit that stands beside them; heights grow "
      "towards the viewer.</p></footer>\n</body>\n</html>\n",
      SPARSHA_VERSION);
}

}  // namespace sparsha::pipeline
