// Any bytes from a Falcon, in any pieces; the answers found are those that a plain search finds in the whole.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "haptics/device/falcon/packet.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using sparsha::haptics::falcon::AnswerStream;
  const std::span<const std::uint8_t> bytes(data, size);
  AnswerStream one_by_one, in_pieces;
  std::size_t found = 0, found_in_pieces = 0;
  for (std::size_t i = 0; i < size; ++i) found += one_by_one.feed(bytes.subspan(i, 1)) ? 1U : 0U;
  for (std::size_t at = 0; at < size;) {
    const std::size_t piece = std::min<std::size_t>(size - at, 1U + data[at] % 16U);
    found_in_pieces += in_pieces.feed(bytes.subspan(at, piece)) ? 1U : 0U;
    at += piece;
  }
  // A piece of up to 16 bytes completes one answer at most, and what is no answer is counted.
  if (found != found_in_pieces || one_by_one.rubbish() != in_pieces.rubbish()) std::abort();
  if (16 * found + one_by_one.rubbish() > size) std::abort();
  return 0;
}
