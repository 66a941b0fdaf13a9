#include "bench/report/html.h"

#include <cctype>
#include <fstream>
#include <sstream>

#include "base/text/html.h"

namespace sparsha::bench {
namespace {

constexpr const char* kStyle =
    "body{font:16px/1.5 system-ui,sans-serif;max-width:76rem;margin:2rem auto;padding:0 "
    "1rem;color:#111;background:#fff}"
    "h1{line-height:1.2}h2{margin-top:3rem;border-bottom:2px solid #555;padding-bottom:.2rem}p,li{max-width:48rem}"
    "table{border-collapse:collapse;margin:1rem 0;font-size:.875rem;font-variant-numeric:tabular-nums}"
    "caption{text-align:left;font-weight:bold;padding:.3rem 0}"
    "th,td{border:1px solid #888;padding:.2rem .5rem;text-align:right;vertical-align:top}"
    "tbody th,td.words{text-align:left;font-weight:normal;min-width:9rem}thead "
    "th{background:#eee;vertical-align:bottom}"
    "tbody tr:nth-child(even){background:#f7f7f7}td.fault{font-weight:bold;background:#fdd}"
    "figure{margin:1rem 0}svg{width:100%;max-width:60rem;height:auto}figcaption{max-width:48rem;font-size:.9rem}"
    "div.wide{overflow-x:auto}div.wide:focus,a:focus,summary:focus{outline:3px solid #0072b2}"
    "details{margin:1rem 0;border:1px solid #888;padding:.3rem .8rem}summary{cursor:pointer;font-weight:bold}"
    "nav ol{columns:2;max-width:60rem}a.skip{position:absolute;left:-99rem}a.skip:focus{position:static}"
    "@media print{div.wide{overflow:visible}}";

/// Letters and digits, dashes between words.
std::string id_of(const std::string& title) {
  std::string id;
  for (const char c : title) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) != 0) {
      id += static_cast<char>(std::tolower(letter));
    } else if (!id.empty() && id.back() != '-') {
      id += '-';
    }
  }
  return id;
}

/// Links to the headings of `body`.
std::string contents_of(const std::string& body) {
  static const std::string kBegin = "<h2 id=\"", kEnd = "</h2>";
  std::string list = "<nav aria-label=\"Contents\"><ol>\n";
  for (std::size_t at = body.find(kBegin); at != std::string::npos; at = body.find(kBegin, at)) {
    at += kBegin.size();
    const std::size_t quote = body.find('"', at);
    const std::size_t end = body.find(kEnd, quote);
    if (end == std::string::npos) break;
    list += "<li><a href=\"#" + body.substr(at, quote - at) + "\">" + body.substr(quote + 2, end - quote - 2) +
            "</a></li>\n";
  }
  return list + "</ol></nav>\n";
}

}  // namespace

std::string html_table(const std::string& caption, const std::vector<std::string>& heads,
                       const std::vector<HtmlRow>& rows) {
  std::string html = "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"" + escape_html(caption) +
                     "\"><table><caption>" + escape_html(caption) + "</caption><thead><tr>";
  for (const std::string& head : heads) html += "<th scope=\"col\">" + head + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const HtmlRow& row : rows) {
    html += "<tr>";
    for (std::size_t k = 0; k < row.size(); ++k) {
      const char* plain = row[k].words ? "<td class=\"words\">" : "<td>";
      html += k == 0 ? "<th scope=\"row\">" : row[k].fault ? "<td class=\"fault\">" : plain;
      html += row[k].html + (k == 0 ? "</th>" : "</td>");
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string html_heading(const std::string& title) {
  return "<h2 id=\"" + id_of(title) + "\">" + escape_html(title) + "</h2>\n";
}

std::string html_folded(const std::string& title, const std::string& html) {
  return "<details><summary>" + escape_html(title) + "</summary>\n" + html + "</details>\n";
}

std::string html_figure(const std::filesystem::path& svg, const std::string& caption) {
  const std::string drawing = file_text(svg);
  if (drawing.empty()) return {};
  return "<figure>" + drawing + "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::string file_text(const std::filesystem::path& file) {
  std::ostringstream words;
  words << std::ifstream(file).rdbuf();
  return words.str();
}

std::string html_page(const std::string& title, const std::string& introduction, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width\"><title>" +
         escape_html(title) + "</title>\n<style>" + kStyle +
         "</style></head>\n<body><a class=\"skip\" href=\"#main\">To the figures</a><header><h1>" + escape_html(title) +
         "</h1>\n" + introduction + contents_of(body) + "</header>\n<main id=\"main\">\n" + body +
         "</main></body></html>\n";
}

}  // namespace sparsha::bench
