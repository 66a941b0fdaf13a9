// Records found by a key: what a map is for, in a fraction of its memory and time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace sparsha {

/// Keeps one `Record` a key, numbered from 0 in the order in which the keys first come; open addressing, at most half
/// full. A record has a member `key` and is otherwise as it is made without arguments; `Hash` gives 64 bits whose lower
/// ones are good. Up to 2^31 records.
template <typename Record, typename Hash>
class KeyTable {
 public:
  using Key = decltype(Record::key);

  /// The number of the key's record; size() before the call when the key is new.
  [[nodiscard]] std::uint32_t number(const Key& key) { return number(key, Hash{}(key)); }
  /// The same for a hash known already.
  [[nodiscard]] std::uint32_t number(const Key& key, std::uint64_t hash) {
    if (records_.size() * 2 >= slots_.size()) grow();
    std::size_t slot = place(hash);
    while (slots_[slot] != kFree && records_[slots_[slot]].key != key) slot = (slot + 1) & (slots_.size() - 1);
    if (slots_[slot] == kFree) {
      slots_[slot] = static_cast<std::uint32_t>(records_.size());
      records_.emplace_back().key = key;
    }
    return slots_[slot];
  }
  /// The number of the key's record, or size() when there is none.
  [[nodiscard]] std::uint32_t find(const Key& key) const {
    std::size_t slot = place(Hash{}(key));
    while (slots_[slot] != kFree && records_[slots_[slot]].key != key) slot = (slot + 1) & (slots_.size() - 1);
    return slots_[slot] == kFree ? static_cast<std::uint32_t>(records_.size()) : slots_[slot];
  }
  [[nodiscard]] Record& operator[](std::uint32_t number) { return records_[number]; }
  [[nodiscard]] const Record& operator[](std::uint32_t number) const { return records_[number]; }
  [[nodiscard]] std::size_t size() const { return records_.size(); }
  /// Ask for the memory that number() will look at, some keys before; the slot first, which tells where the record is.
  void prefetch_slot(std::uint64_t hash) const { prefetch(&slots_[place(hash)]); }
  void prefetch_record(std::uint64_t hash) const {
    const std::uint32_t number = slots_[place(hash)];
    if (number == kFree) return;
    const auto* bytes = reinterpret_cast<const char*>(&records_[number]);
    for (std::size_t at = 0; at < sizeof(Record); at += 64) prefetch(bytes + at);
  }
  /// The records by their numbers; the table is empty then.
  [[nodiscard]] std::vector<Record> take() {
    slots_ = std::vector<std::uint32_t>(kLeastSlots, kFree);
    return std::exchange(records_, {});
  }

 private:
  static constexpr std::uint32_t kFree = ~std::uint32_t{0};
  static constexpr std::size_t kLeastSlots = 1024;

  static void prefetch([[maybe_unused]] const void* memory) {
#if defined(__GNUC__)
    __builtin_prefetch(memory);
#endif
  }
  [[nodiscard]] std::size_t place(std::uint64_t hash) const {
    return static_cast<std::size_t>(hash) & (slots_.size() - 1);
  }
  void grow() {
    slots_.assign(slots_.size() * 2, kFree);
    for (std::size_t i = 0; i < records_.size(); ++i) {
      std::size_t slot = place(Hash{}(records_[i].key));
      while (slots_[slot] != kFree) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = static_cast<std::uint32_t>(i);
    }
  }

  std::vector<std::uint32_t> slots_ = std::vector<std::uint32_t>(kLeastSlots, kFree);
  std::vector<Record> records_;
};

}  // namespace sparsha
