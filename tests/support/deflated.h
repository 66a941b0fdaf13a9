// Packs bytes as zlib does, for files that tests write themselves.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sparsha::pipeline::testing {

/// `window_bits` as zlib's deflateInit2 takes them: negative for a bare stream, 16 more for gzip.
std::string deflated(std::string_view bytes, int window_bits);

/// A ZIP archive of files, names and contents; stored as they are unless `packs`.
std::string zipped(const std::vector<std::pair<std::string, std::string>>& parts, bool packs = true);

}  // namespace sparsha::pipeline::testing
