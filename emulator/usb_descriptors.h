// What the emulated chip says of itself: as bytes of control transfers and in sysfs.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace sparsha::emulator {

inline constexpr std::string_view kProduct = "FALCON HAPTIC";
inline constexpr std::uint8_t kProductString = 1;
/// 2.0, 64 bytes, 0403:cb48.
inline constexpr std::array<std::uint8_t, 18> kDeviceDescriptor{
    18, 1, 0x00, 0x02, 0, 0, 0, 64, 0x03, 0x04, 0x48, 0xCB, 0x00, 4, 0, kProductString, 0, 1};
/// One interface, bulk IN 0x81 and bulk OUT 0x02 of 64 bytes.
inline constexpr std::array<std::uint8_t, 32> kConfigurationDescriptor{
    9, 2, 32,   0, 1,  1,   0,   0x80, 45,  // configuration
    9, 4, 0,    0, 2,  255, 255, 255,  0,   // interface
    7, 5, 0x81, 2, 64, 0,   0,              // endpoints
    7, 5, 0x02, 2, 64, 0,   0};

}  // namespace sparsha::emulator
