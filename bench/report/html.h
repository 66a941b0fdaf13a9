// Pieces of the benchmarks' page: one file that needs no other, for eyes and for screen readers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/report/figure_text.h"

namespace sparsha::bench {

struct HtmlCell {
  std::string html;
  bool fault = false;  ///< beyond a limit: bold and coloured
  bool words = false;  ///< text, which begins at the left; else a number
};
using HtmlRow = std::vector<HtmlCell>;

/// The first cell of a row is its header. Wide tables scroll, by keyboard too.
[[nodiscard]] std::string html_table(const std::string& caption, const std::vector<std::string>& heads,
                                     const std::vector<HtmlRow>& rows);
/// A heading that the page's contents lead to.
[[nodiscard]] std::string html_heading(const std::string& title);
/// Text in a box that is closed until it is asked for.
[[nodiscard]] std::string html_folded(const std::string& title, const std::string& html);
/// An SVG file in the page itself; empty when there is none.
[[nodiscard]] std::string html_figure(const std::filesystem::path& svg, const std::string& caption);

[[nodiscard]] std::string file_text(const std::filesystem::path& file);

/// The whole page; `introduction` stands before the contents, which name the headings of `body` in their order.
[[nodiscard]] std::string html_page(const std::string& title, const std::string& introduction, const std::string& body);

}  // namespace sparsha::bench
