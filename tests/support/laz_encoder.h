// Packs points of format 0 (item POINT10, version 2) into chunks. Serves damage by construction: shared misreadings of
// the format are found by the files of LASzip alone.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sparsha::pipeline::testing {

/// Probabilities as LAZ adapts them, without the decoder's tables.
class EncoderModel {
 public:
  explicit EncoderModel(std::uint32_t symbols);

  [[nodiscard]] std::uint32_t below(std::uint32_t symbol) const { return below_[symbol]; }
  [[nodiscard]] bool is_last(std::uint32_t symbol) const { return symbol + 1 == count_.size(); }
  void seen(std::uint32_t symbol);

 private:
  void update();

  std::vector<std::uint32_t> count_, below_;
  std::uint32_t total_ = 0, cycle_, left_ = 0;
};

class Encoder {
 public:
  void symbol(EncoderModel& model, std::uint32_t symbol);
  void raw(std::uint32_t bits, std::uint32_t value);
  /// One bit, 0 and 1 as in `counts` of an adaptive model.
  struct Bit {
    std::uint32_t zeros = 1, count = 2, probability = 4096, cycle = 4, left = 4;
  };
  void bit(Bit& model, std::uint32_t bit);
  [[nodiscard]] std::string finish();

 private:
  void add(std::uint32_t step);
  void renormalise();

  std::string out_;
  std::uint32_t base_ = 0, length_ = 0xFFFFFFFFU;
};

class IntegerEncoder {
 public:
  IntegerEncoder(std::uint32_t bits, std::uint32_t contexts);
  void put(Encoder& out, std::int32_t prediction, std::int32_t value, std::uint32_t context);
  [[nodiscard]] std::uint32_t size() const { return size_; }

 private:
  std::uint32_t bits_, size_ = 0;
  std::vector<EncoderModel> sizes_, differences_;
  Encoder::Bit small_;
};

/// A LAZ 1.2 file. `points`: of each chunk, 20 bytes each; `each`: of a chunk, 0 when the table is to tell.
[[nodiscard]] std::string pack_las(const std::vector<std::vector<std::string>>& points, std::uint32_t each);

}  // namespace sparsha::pipeline::testing
