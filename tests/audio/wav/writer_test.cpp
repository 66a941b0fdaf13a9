// Files of sound as other programs read them: chunk by chunk, by a reader of our own.
#include "audio/wav/writer.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "tests/audio/audio_scene.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;

/// What the first bytes of a file say: its kind, and each chunk's content up to 64 bytes, its length and its place.
struct Header {
  struct Chunk {
    std::string content;
    std::uint64_t length = 0;
    std::uint64_t begin = 0;
  };
  std::string kind;
  std::uint64_t length = 0;
  std::map<std::string, Chunk> chunks;
};

std::uint64_t number(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + at, count);
  return value;
}

Header header_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const auto take = [&in](std::uint64_t count) {
    std::string bytes(count, '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(count));
    return bytes;
  };
  Header header;
  const std::string first = take(12);
  header.kind = first.substr(0, 4) + first.substr(8, 4);
  header.length = number(first, 4, 4);
  while (!header.chunks.contains("data") && in) {
    const std::string head = take(8);
    Header::Chunk chunk;
    chunk.length = number(head, 4, 4);
    chunk.begin = static_cast<std::uint64_t>(in.tellg());
    if (head.substr(0, 4) != "data") chunk.content = take(chunk.length);
    header.chunks[head.substr(0, 4)] = chunk;
  }
  return header;
}

TEST(WavWriter, WritesAFileThatEveryProgramReadsWhereItIsBelow4Gigabytes) {
  for (const int bits : {16, 24}) {
    const audio_scene::Folder folder;
    const auto file = folder / "run.wav";
    WavWriter writer(file, 44100, bits);
    const std::vector<float> frames{0.5F, -0.25F, 0.0F, 0.125F};
    writer.write(frames);
    writer.commit();
    const Header header = header_of(file);
    EXPECT_EQ(header.kind, "RIFFWAVE");
    EXPECT_EQ(header.length, std::filesystem::file_size(file) - 8);
    ASSERT_TRUE(header.chunks.contains("fmt "));
    const std::string& format = header.chunks.at("fmt ").content;
    ASSERT_EQ(format.size(), 16U) << "no extension";
    EXPECT_EQ(number(format, 0, 2), 1U) << "integers";
    EXPECT_EQ(number(format, 2, 2), 2U) << "channels";
    EXPECT_EQ(number(format, 4, 4), 44100U);
    EXPECT_EQ(number(format, 8, 4), 44100U * 2U * static_cast<unsigned>(bits) / 8U);
    EXPECT_EQ(number(format, 12, 2), 2U * static_cast<unsigned>(bits) / 8U);
    EXPECT_EQ(number(format, 14, 2), static_cast<unsigned>(bits));
    EXPECT_EQ(header.chunks.at("data").length, 4U * static_cast<unsigned>(bits) / 8U);
    std::ifstream in(file, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(header.chunks.at("data").begin));
    for (const float value : frames) {
      std::int32_t sample = 0;
      const int bytes = bits / 8;
      in.read(reinterpret_cast<char*>(&sample) + 4 - bytes, bytes);
      const double step = 1.0 / static_cast<double>(1 << (bits - 1));
      EXPECT_NEAR(sample / 2147483648.0, value, 2.0 * step) << "a step of rounding and one of dither";
    }
  }
}

TEST(WavWriter, AFileOfMoreThan4GigabytesIsWholeAndSaysHowLongItIs) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "writes 4.3 GB: only with SPARSHA_NIGHTLY=1";
  const audio_scene::Folder folder;
  const auto file = folder / "long.wav";
  constexpr std::uint64_t kFrames = std::uint64_t{1080} << 20U;  // of 4 bytes
  if (std::filesystem::space(std::filesystem::temp_directory_path()).available < (std::uint64_t{6} << 30U))
    GTEST_SKIP() << "no room for a file of 4.3 GB";
  WavWriter writer(file, 48000, 16);
  const std::vector<float> silence(2U << 20U, 0.0F);
  for (std::uint64_t frames = 0; frames < kFrames; frames += silence.size() / 2) writer.write(silence);
  EXPECT_EQ(writer.frames(), kFrames);
  writer.commit();
  const Header header = header_of(file);
  EXPECT_EQ(header.kind, "RF64WAVE");
  ASSERT_TRUE(header.chunks.contains("ds64"));
  EXPECT_EQ(number(header.chunks.at("ds64").content, 0, 8), std::filesystem::file_size(file) - 8);
  EXPECT_EQ(number(header.chunks.at("ds64").content, 8, 8), 4 * kFrames);
  EXPECT_GE(std::filesystem::file_size(file), header.chunks.at("data").begin + 4 * kFrames);
}

}  // namespace
