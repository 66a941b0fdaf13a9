// Bytes as text, for pictures inside pages.
#pragma once

#include <string>

namespace sparsha::pipeline {

/// Appends `bytes` in base 64 (RFC 4648).
void append_base64(std::string& text, const std::string& bytes);

}  // namespace sparsha::pipeline
