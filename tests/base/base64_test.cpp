// Bytes as text and back, by the vectors of RFC 4648, and what is no base 64.
#include "base/text/base64.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <random>
#include <string>

namespace sparsha {
namespace {

TEST(Base64, IsThatOfTheStandardsVectors) {
  const std::array<std::array<const char*, 2>, 7> vectors{{{"", ""},
                                                           {"f", "Zg=="},
                                                           {"fo", "Zm8="},
                                                           {"foo", "Zm9v"},
                                                           {"foob", "Zm9vYg=="},
                                                           {"fooba", "Zm9vYmE="},
                                                           {"foobar", "Zm9vYmFy"}}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(to_base64(bytes), text);
    std::string back = "what was there";
    EXPECT_TRUE(from_base64(text, back)) << text;
    EXPECT_EQ(back, bytes);
  }
}

TEST(Base64, BytesOfAnyNumberComeBack) {
  std::mt19937 random(1);
  // Texts go through OpenSSL in parts of 2^24 digits.
  for (const std::size_t size : {255U, 256U, 1000000U, (3U << 22U) - 1, 3U << 22U, (3U << 22U) + 1, (3U << 23U) + 2}) {
    std::string bytes(size, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    std::string back;
    ASSERT_TRUE(from_base64(to_base64(bytes), back)) << size;
    EXPECT_TRUE(back == bytes) << size;
  }
}

TEST(Base64, BlanksAndLinesMayStandAnywhereAndNothingElse) {
  std::string bytes;
  EXPECT_TRUE(from_base64(" Zm\n9v\tYg\r\n= =\n", bytes));
  EXPECT_EQ(bytes, "foob");
  for (const char* wrong : {"Z", "Zg=", "Zg", "Zg===", "Z===", "====", "=Zg=", "Zg==Zg==", "Zm9v!A==", "Zm9-", "Zm9v,"})
    EXPECT_FALSE(from_base64(wrong, bytes)) << wrong;
}

}  // namespace
}  // namespace sparsha
