// Bytes of a stream that zlib unpacks, in order and never more than are asked for.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace sparsha::pipeline {

class Inflater {
 public:
  enum class Wrapping { gzip, none };

  Inflater(std::string_view packed, Wrapping wrapping);
  ~Inflater();
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// The next `size` bytes; fewer where the stream ends, is cut or damaged. Memory grows with what is there.
  [[nodiscard]] std::string read(std::size_t size);
  /// Whether the stream has ended, with the right checksum where it has one.
  [[nodiscard]] bool whole();

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

}  // namespace sparsha::pipeline
