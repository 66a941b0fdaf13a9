// A little writer of E57, which shares no code with the reader.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/scan/writer.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline::testing {

/// CRC-32C bit by bit.
inline std::uint32_t slow_crc32c(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1 ^ 0x82F63B78U : crc >> 1;
  }
  return ~crc;
}

/// Bits of one field, least significant first.
class Bits {
 public:
  void add(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) {
      if (filled_ % 8 == 0) bytes_ += '\0';
      if ((value >> i & 1) != 0) bytes_.back() = static_cast<char>(bytes_.back() | (1 << (filled_ % 8)));
      ++filled_;
    }
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t filled_ = 0;
};

struct E57File {
  std::string prototype;
  std::string declarations;   ///< attributes of the root of the first scan's file
  std::string before_points;  ///< XML beside the points: pose, limits
  std::string beside;         ///< XML of the first scan's file, beside the scans
  std::string blob;           ///< of the first scan's file, at byte 48
  std::vector<std::string> streams;
  std::string codecs;  ///< XML
  std::uint64_t records = 0;
  std::size_t per_packet = 1000;  ///< bytes of each stream in a packet

  [[nodiscard]] std::string bytes() const { return bytes_of({*this}); }

  /// The compressed vector that begins at byte `at` of the pages' contents.
  [[nodiscard]] std::string section(std::size_t at) const {
    std::string packets;
    std::size_t longest = 0;
    for (const std::string& s : streams) longest = std::max(longest, s.size());
    for (std::size_t from = 0; from < longest; from += per_packet) {
      std::string body;
      std::string lengths;
      for (const std::string& s : streams) {
        const std::string piece = from < s.size() ? s.substr(from, per_packet) : "";
        put(lengths, static_cast<std::uint16_t>(piece.size()));
        body += piece;
      }
      std::string packet = std::string("\x01\x00", 2);
      std::size_t size = 6 + lengths.size() + body.size();
      const std::size_t padding = (4 - size % 4) % 4;
      size += padding;
      put(packet, static_cast<std::uint16_t>(size - 1));
      put(packet, static_cast<std::uint16_t>(streams.size()));
      packets += packet + lengths + body + std::string(padding, '\0');
    }
    std::string section;
    put(section, std::uint64_t{1});  // section of a compressed vector
    put(section, static_cast<std::uint64_t>(32 + packets.size()));
    put(section, physical(at + 32));  // the packets follow at once
    put(section, std::uint64_t{0});
    return section + packets;
  }
  static std::uint64_t physical(std::size_t logical) { return logical / 1020 * 1024 + logical % 1020; }

  /// A file of several scans.
  static std::string bytes_of(const std::vector<E57File>& scans) {
    std::string logical(48, '\0');
    if (const std::string& blob = scans.front().blob; !blob.empty()) {
      put(logical, std::uint64_t{0});
      put(logical, static_cast<std::uint64_t>(16 + blob.size()));
      logical += blob + std::string((4 - blob.size() % 4) % 4, '\0');
    }
    std::string xml =
        "<?xml version=\"1.0\"?><e57Root type=\"Structure\"" + scans.front().declarations + "><data3D type=\"Vector\">";
    for (const E57File& scan : scans) {
      xml += "<vectorChild type=\"Structure\">" + scan.before_points +
             "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(physical(logical.size())) +
             "\" recordCount=\"" + std::to_string(scan.records) + "\"><prototype type=\"Structure\">" + scan.prototype +
             "</prototype><codecs type=\"Vector\">" + scan.codecs + "</codecs></points></vectorChild>";
      logical += scan.section(logical.size());
    }
    xml += "</data3D>" + scans.front().beside + "</e57Root>";
    const std::size_t xml_at = logical.size();
    logical += xml;
    logical.resize((logical.size() + 1019) / 1020 * 1020, ' ');
    std::string head = "ASTM-E57";
    put(head, std::uint32_t{1});
    put(head, std::uint32_t{0});
    put(head, static_cast<std::uint64_t>(logical.size() / 1020 * 1024));
    put(head, physical(xml_at));
    put(head, static_cast<std::uint64_t>(xml.size()));
    put(head, std::uint64_t{1024});
    logical.replace(0, 48, head);
    return with_checksums(logical);
  }

  static std::string with_checksums(const std::string& logical) {
    std::string physical;
    for (std::size_t at = 0; at < logical.size(); at += 1020) {
      const std::string page = logical.substr(at, 1020);
      physical += page;
      put(physical, slow_crc32c(page), true);
    }
    return physical;
  }
};

inline std::string reals(const std::vector<double>& values, bool single) {
  std::string bytes;
  for (const double v : values) single ? put(bytes, static_cast<float>(v)) : put(bytes, v);
  return bytes;
}

}  // namespace sparsha::pipeline::testing
