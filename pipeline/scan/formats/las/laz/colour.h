// Colours, near infrared and further bytes of points.
#pragma once

#include <vector>

#include "pipeline/scan/formats/las/laz/fields.h"
#include "pipeline/scan/formats/las/laz/integers.h"

namespace sparsha::pipeline::laz {

/// RGB12 version 2 and RGB14.
class Colour {
 public:
  void next(Decoder& in, std::uint8_t* item);

 private:
  SymbolModel changed_{128};
  std::vector<SymbolModel> differences_ = models(6, 256);
};

/// RGB12 version 1.
class ColourFirst {
 public:
  void next(Decoder& in, std::uint8_t* item);

 private:
  SymbolModel changed_{64};
  IntegerModel bytes_{8, 6};
};

/// The fourth channel of RGBNIR14.
class NearInfrared {
 public:
  void next(Decoder& in, std::uint8_t* item);

 private:
  SymbolModel changed_{4};
  std::vector<SymbolModel> differences_ = models(2, 256);
};

/// BYTE version 2; BYTE14 has a stream for each byte.
class Bytes {
 public:
  explicit Bytes(std::size_t count) : differences_(models(count, 256)) {}
  void next(Decoder& in, std::uint8_t* item, std::size_t i) {
    item[i] = low_byte(item[i] + std::int64_t{in.symbol(differences_[i])});
  }
  void next(Decoder& in, std::uint8_t* item) {
    for (std::size_t i = 0; i < differences_.size(); ++i) next(in, item, i);
  }

 private:
  std::vector<SymbolModel> differences_;
};

/// BYTE version 1.
class BytesFirst {
 public:
  explicit BytesFirst(std::size_t count) : count_(static_cast<std::uint32_t>(count)), bytes_(8, count_) {}
  void next(Decoder& in, std::uint8_t* item) {
    for (std::uint32_t i = 0; i < count_; ++i) item[i] = low_byte(bytes_.get(in, item[i], i));
  }

 private:
  std::uint32_t count_;
  IntegerModel bytes_;
};

}  // namespace sparsha::pipeline::laz
