// Bytes that one process tells another on the same kind of machine: values, texts and lists, one behind the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace sparsha {

class MessageWriter {
 public:
  template <typename T>
  requires(std::is_trivially_copyable_v<T> && !std::is_same_v<T, std::span<const std::byte>>) void put(const T& value) {
    append(&value, sizeof(T));
  }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    append(text.data(), text.size());
  }
  void put(const std::vector<std::string>& texts) {
    put(std::uint64_t{texts.size()});
    for (const std::string& text : texts) put(text);
  }
  void put(std::span<const std::byte> bytes) { append(bytes.data(), bytes.size()); }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void append(const void* from, std::size_t size) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + size);
    if (size > 0) std::memcpy(bytes_.data() + at, from, size);
  }
  std::vector<std::byte> bytes_;
};

/// In the order in which a MessageWriter has put them. Throws std::logic_error behind the end.
class MessageReader {
 public:
  explicit MessageReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T>
  [[nodiscard]] T get() {
    T value;
    std::memcpy(&value, cut(sizeof(T)), sizeof(T));
    return value;
  }
  [[nodiscard]] std::string text() {
    const auto size = get<std::uint64_t>();
    const auto* const from = reinterpret_cast<const char*>(cut(size));
    return {from, static_cast<std::size_t>(size)};
  }
  [[nodiscard]] std::vector<std::string> texts() {
    std::vector<std::string> texts(static_cast<std::size_t>(get<std::uint64_t>()));
    for (std::string& one : texts) one = text();
    return texts;
  }
  [[nodiscard]] std::span<const std::byte> bytes(std::uint64_t size) {
    return {cut(size), static_cast<std::size_t>(size)};
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

 private:
  const std::byte* cut(std::uint64_t size) {
    if (size > bytes_.size()) throw std::logic_error("a message of another process ends too early");
    const std::byte* const from = bytes_.data();
    bytes_ = bytes_.subspan(static_cast<std::size_t>(size));
    return from;
  }
  std::span<const std::byte> bytes_;
};

}  // namespace sparsha
