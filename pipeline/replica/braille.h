// Braille as dots: by liblouis where it is installed, else letter by letter.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sparsha::pipeline {

/// One cell: bit 0 to 5 are dots 1 to 6 (1 2 3 down on the left, 4 5 6 on the right).
using BrailleCell = std::uint8_t;

struct Braille {
  std::vector<BrailleCell> cells;
  bool by_library = false;  ///< by liblouis' rules of the text's language
  bool complete = true;     ///< false: some characters have no cell here and are left out
};

/// `text` is UTF-8. Devanagari follows the rules of Bharati Braille, all else English ones, uncontracted. Without
/// liblouis Latin letters, figures and common signs are known; marks on letters are dropped.
[[nodiscard]] Braille to_braille(const std::string& text, bool use_library = true);

/// Cells into lines of at most `most` cells, between words where there is room.
[[nodiscard]] std::vector<std::vector<BrailleCell>> wrap_braille(const std::vector<BrailleCell>& cells,
                                                                 std::size_t most);

}  // namespace sparsha::pipeline
