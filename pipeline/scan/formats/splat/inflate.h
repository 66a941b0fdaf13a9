// Bytes of a gzip stream, in order and never more than are asked for.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace sparsha::pipeline {

class GzipReader {
 public:
  explicit GzipReader(std::string_view packed);
  ~GzipReader();
  GzipReader(const GzipReader&) = delete;
  GzipReader& operator=(const GzipReader&) = delete;

  /// The next `size` bytes; fewer where the stream ends, is cut or damaged. Memory grows with what is there.
  [[nodiscard]] std::string read(std::size_t size);
  /// Whether the stream ended where the bytes did, with the right checksum.
  [[nodiscard]] bool whole();

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

}  // namespace sparsha::pipeline
