// Packs bytes as zlib does, for files that tests write themselves.
#pragma once

#include <string>
#include <string_view>

namespace sparsha::pipeline::testing {

/// `window_bits` as zlib's deflateInit2 takes them: negative for a bare stream, 16 more for gzip.
std::string deflated(std::string_view bytes, int window_bits);

}  // namespace sparsha::pipeline::testing
