// LAZ against files that LASzip packed and their records as other programs unpack them; then damage of every kind.
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <sstream>

#include "pipeline/scan/formats/las/fields.h"
#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/formats/las/laz/points.h"
#include "tests/support/las_files.h"
#include "tests/support/laz_encoder.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using testing::expect_refused;
using ::testing::HasSubstr;
using testing::set;

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::filesystem::path> corpus(const std::filesystem::path& scans) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(scans / "laz")) {
    if (entry.path().extension() == ".laz") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

las::Header header_of(const std::string& bytes) {
  ScanFile file;
  file.name = "scan.laz";
  file.bytes = bytes;
  return las::parse_header(file);
}

std::string_view laszip_record(const las::Header& header) {
  for (const las::Record& record : header.records) {
    if (record.id == 22204) return record.data;
  }
  throw std::runtime_error("no LASzip record");
}

laz::Source source_of(const std::string& bytes) {
  const las::Header header = header_of(bytes);
  return {bytes, header.first_point, header.points, laz::parse_packing(laszip_record(header), 0, header.record_size)};
}

std::string records_of(const std::string& bytes, laz::Layers layers = laz::kAllLayers, unsigned threads = 1) {
  std::string records;
  ThreadPool pool(threads);
  (void)laz::read_points(source_of(bytes), layers, pool,
                         [&](std::string_view block, std::size_t) { records += block; });
  return records;
}

/// Bytes of the record where the two differ first, or nothing.
std::string difference(const std::string& a, const std::string& b, std::size_t record_size) {
  if (a.size() != b.size()) return "sizes " + std::to_string(a.size()) + ", " + std::to_string(b.size());
  const auto at = static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin());
  if (at == a.size()) return "";
  return "point " + std::to_string(at / record_size) + ", byte " + std::to_string(at % record_size);
}

TEST(RealScanLaz, EveryFormatVersionAndKindOfChunkGivesTheRecordsOfItsPlainTwinBitForBit) {
  SPARSHA_REAL_SCANS_OR_SKIP(scans);
  std::size_t files = 0;
  for (const std::filesystem::path& file : corpus(scans)) {
    SCOPED_TRACE(file.filename().string());
    const std::string plain = bytes_of(std::filesystem::path(file).replace_extension(".las"));
    const las::Header header = header_of(plain);
    const std::string expected = plain.substr(header.first_point, header.points * header.record_size);
    const std::string packed = bytes_of(file);
    EXPECT_EQ(difference(records_of(packed), expected, header.record_size), "");
    EXPECT_EQ(difference(records_of(packed, laz::kAllLayers, 3), expected, header.record_size), "");
    ++files;
  }
  EXPECT_GE(files, 30U);
}

TEST(RealScanLaz, LayersThatAreNotWantedChangeNoneOfTheOthers) {
  SPARSHA_REAL_SCANS_OR_SKIP(scans);
  for (const std::filesystem::path& file : corpus(scans)) {
    SCOPED_TRACE(file.filename().string());
    const std::string packed = bytes_of(file);
    const laz::Source source = source_of(packed);
    const std::size_t size = source.packing.record_size;
    const std::string whole = records_of(packed);
    for (std::size_t byte = 0; byte < size; ++byte) {
      const std::string some = records_of(packed, laz::layers_at(source.packing, byte, byte + 1));
      ASSERT_EQ(some.size(), whole.size());
      std::size_t wrong = 0;
      for (std::size_t at = byte; at < some.size(); at += size) wrong += some[at] != whole[at] ? 1 : 0;
      EXPECT_EQ(wrong, 0U) << "byte " << byte;
    }
  }
}

TEST(RealScanLaz, APackedFileIsTheSameScanAsItsPlainTwin) {
  SPARSHA_REAL_SCANS_OR_SKIP(scans);
  for (const std::filesystem::path& file : corpus(scans)) {
    SCOPED_TRACE(file.filename().string());
    ReadOptions options;  // with all that points have, extra bytes as they are described
    for (const las::PointField& field : las::point_fields(header_of(bytes_of(file)))) {
      options.fields.push_back(field_key(field.name));
    }
    const RawScan packed = read_scan(file, nullptr, options);
    const RawScan plain = read_scan(std::filesystem::path(file).replace_extension(".las"), nullptr, options);
    ASSERT_EQ(packed.values.size(), plain.values.size());
    for (std::size_t k = 0; k < plain.values.size(); ++k) {
      const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
      EXPECT_FALSE(plain.values[k].empty() && !plain.points.empty()) << options.fields[k];
      EXPECT_TRUE(std::equal(packed.values[k].begin(), packed.values[k].end(), plain.values[k].begin(),
                             plain.values[k].end(), same))
          << options.fields[k];
    }
    EXPECT_EQ(packed.points, plain.points);
    EXPECT_EQ(packed.rgba, plain.rgba);
    EXPECT_EQ(packed.intensity, plain.intensity);
    EXPECT_EQ(packed.records, plain.records);
    EXPECT_EQ(packed.invalid, plain.invalid);
    EXPECT_EQ(packed.fields, plain.fields);
  }
}

// One file of each compressor.
constexpr std::array kThree = {"pf01_v1_pointwise_x0_calm.laz", "pf03_v2_variable_x5_wild.laz",
                               "pf08_v3_chunk150_x3_wild.laz"};

TEST(RealScanLaz, AFileThatWasCutShortAtAnyByteIsRefusedOrGivesAllItsPointsAndSaysSo) {
  SPARSHA_REAL_SCANS_OR_SKIP(scans);
  for (const char* name : kThree) {
    const std::string bytes = bytes_of(scans / "laz" / name);
    const RawScan whole = read_scan_bytes(bytes, "scan.laz");
    std::size_t refused = 0;
    for (std::size_t size = 4; size < bytes.size(); ++size) {
      try {
        const RawScan cut = read_scan_bytes(bytes.substr(0, size), "scan.laz");
        ASSERT_EQ(cut.points, whole.points) << name << " cut at " << size;
        // The last bytes of a table may be such as the decoder reads ahead only.
        if (std::string(name).find("pointwise") == std::string::npos && size + 8 < bytes.size()) {
          ASSERT_FALSE(cut.warnings.empty()) << size;
        }
      } catch (const Error& error) {
        ++refused;
        ASSERT_EQ(error.kind(), ErrorKind::input);
      }
    }
    EXPECT_GT(refused, bytes.size() * 95 / 100) << name;
  }
}

TEST(RealScanLaz, ChangedBytesGiveRecordsOrAnErrorAndNeverTakeLong) {
  SPARSHA_REAL_SCANS_OR_SKIP(scans);
  const int rounds = std::getenv("SPARSHA_NIGHTLY") != nullptr ? 3334 : 10;
  std::mt19937 random(20);
  double longest = 0.0;
  for (const std::filesystem::path& file : corpus(scans)) {
    const std::string bytes = bytes_of(file);
    const std::size_t head = header_of(bytes).first_point;
    for (int i = 0; i < rounds; ++i) {
      std::string changed = bytes;
      for (unsigned k = 0; k <= random() % 4; ++k) {
        const std::size_t from = random() % 3 == 0 ? 94 : head;
        changed[from + random() % (changed.size() - from)] = static_cast<char>(random());
      }
      const auto begin = std::chrono::steady_clock::now();
      try {
        const RawScan scan = read_scan_bytes(changed, "scan.laz");
        EXPECT_EQ(scan.points.size() + scan.invalid, scan.records);
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
      }
      longest = std::max(longest, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
  }
  RecordProperty("longest_s", std::to_string(longest));
}

TEST(RealScanLaz, CountsThatDisagreeAreErrorsWithTheirPlace) {
  SPARSHA_REAL_SCANS_OR_SKIP(scans);
  const std::string layered = bytes_of(scans / "laz/pf08_v3_chunk150_x3_wild.laz");
  const std::string chunked = bytes_of(scans / "laz/pf00_v2_chunk150_x0_calm.laz");
  const std::string variable = bytes_of(scans / "laz/pf03_v2_variable_x5_wild.laz");
  const auto with_count = [](std::string bytes, std::uint32_t count) {
    set(bytes, 107, count);
    if (bytes[25] >= 4) set(bytes, 247, std::uint64_t{count});
    return bytes;
  };
  expect_refused("a.laz", with_count(layered, 400), "LAZ chunk 3 of 3: the chunk has 120 points");
  expect_refused("a.laz", with_count(chunked, 400), "LAZ chunk 3 of 3: the points end after");
  expect_refused("a.laz", with_count(chunked, 450), "LAZ chunk 3 of 3: the stream ends before its points do, at byte");
  expect_refused("a.laz", with_count(chunked, 300), "300 points are not in 3 LAZ chunks of 150, at byte");
  expect_refused("a.laz", with_count(variable, 421), "1 points fewer than the header");
  expect_refused("a.laz", with_count(variable, 419), "where the header leaves");
  expect_refused("a.laz", with_count(chunked, 1'000'000'000), "not in 3 LAZ chunks");
  expect_refused("a.laz", with_count(bytes_of(scans / "laz/pf01_v1_pointwise_x0_calm.laz"), 1'000'000'000),
                 "the stream ends before its points do");
}

TEST(RealScanLaz, ATableOfZerosIsAnErrorAndATableThatWasNeverWrittenIsDoneWithout) {
  SPARSHA_REAL_SCANS_OR_SKIP(scans);
  for (const char* name : {"pf00_v2_chunk150_x0_calm.laz", "pf08_v3_chunk150_x3_wild.laz"}) {
    const std::string bytes = bytes_of(scans / "laz" / name);
    const std::size_t first = header_of(bytes).first_point;
    const auto table = load<std::int64_t>(bytes.data() + first);
    std::string zeros = bytes;
    std::fill(zeros.begin() + table + 8, zeros.end(), '\0');
    expect_refused("zeros.laz", zeros, "0 bytes for 150 points");
    std::string none = bytes;
    set(none, first, static_cast<std::int64_t>(first));
    const RawScan scan = read_scan_bytes(none, "none.laz");
    EXPECT_EQ(scan.points, read_scan_bytes(bytes, "scan.laz").points);
    EXPECT_THAT(scan.warnings, ::testing::Contains(HasSubstr("never written")));
    // Written as a stream: the place stands in the last bytes.
    std::string streamed = bytes;
    set(streamed, first, std::int64_t{-1});
    testing::put(streamed, table);
    EXPECT_EQ(read_scan_bytes(streamed, "streamed.laz").points, scan.points);
  }
  std::string variable = bytes_of(scans / "laz/pf03_v2_variable_x5_wild.laz");
  const std::size_t first = header_of(variable).first_point;
  set(variable, first, static_cast<std::int64_t>(first));
  expect_refused("variable.laz", variable, "cannot be read without it");
}

/// A LAZ file of chunks of one point, which stand as they are. No table: `place` says why.
std::string raw_chunks(int count, std::uint16_t compressor = 2, std::uint16_t version = 2) {
  testing::LasFile file;
  file.record_user = "laszip encoded";
  file.record_id = 22204;
  testing::put(file.record, compressor);
  file.record += std::string(10, '\0');
  testing::put(file.record, std::uint32_t{1});
  file.record += std::string(16, '\0');
  testing::put(file.record, std::uint16_t{1});
  for (const std::uint16_t number : {std::uint16_t{6}, std::uint16_t{20}, version}) testing::put(file.record, number);
  for (int i = 0; i < count; ++i) {
    std::string point = testing::las_point(0, i * 1000003, -i * 77, 2147483647 - i, static_cast<std::uint16_t>(i));
    if (i % 7 == 3) point[15] = static_cast<char>(128);
    file.points.push_back(point);
  }
  const std::string plain = file.bytes();
  const std::size_t first = plain.size() - static_cast<std::size_t>(count) * 20;
  std::string packed = plain.substr(0, first);
  packed[104] = static_cast<char>(128);
  testing::put(packed, static_cast<std::int64_t>(first));
  return packed + plain.substr(first);
}

/// The same of format 2, the first `dark` of which have colours of `low`, those behind them of `high`.
std::string raw_coloured_chunks(int count, int dark, std::uint16_t low, std::uint16_t high) {
  testing::LasFile file;
  file.format = 2;
  file.record_user = "laszip encoded";
  file.record_id = 22204;
  testing::put(file.record, std::uint16_t{2});
  file.record += std::string(10, '\0');
  testing::put(file.record, std::uint32_t{1});
  file.record += std::string(16, '\0');
  testing::put(file.record, std::uint16_t{2});
  for (const int number : {6, 20, 2, 8, 6, 2}) testing::put(file.record, static_cast<std::uint16_t>(number));
  for (int i = 0; i < count; ++i) {
    std::string point = testing::las_point(2, i, i % 100, i % 7);
    for (std::size_t k = 0; k < 3; ++k) set(point, 20 + 2 * k, i < dark ? low : high);
    file.points.push_back(point);
  }
  const std::string plain = file.bytes();
  const std::size_t first = plain.size() - static_cast<std::size_t>(count) * 26;
  std::string packed = plain.substr(0, first);
  packed[104] = static_cast<char>(128 + 2);
  testing::put(packed, static_cast<std::int64_t>(first));
  return packed + plain.substr(first);
}

TEST(Laz, TheScaleOfColoursWithoutATableOfChunksIsThatOfAllPoints) {
  constexpr int kDark = (1 << 16) + 100;
  const RawScan words = read_scan_bytes(raw_coloured_chunks(kDark + 10, kDark, 200, 65535), "scan.laz");
  EXPECT_EQ(words.rgba.front(), 0xFF010101U);
  EXPECT_EQ(words.rgba.back(), 0xFFFFFFFFU);
  const RawScan bytes = read_scan_bytes(raw_coloured_chunks(kDark + 10, kDark, 100, 255), "scan.laz");
  EXPECT_EQ(bytes.rgba.front(), 0xFF646464U);
  EXPECT_EQ(bytes.rgba.back(), 0xFFFFFFFFU);
}

TEST(Laz, PointsThatAreWithheldAreCountedAsInvalid) {
  const RawScan scan = read_scan_bytes(raw_chunks(1500), "scan.laz");
  EXPECT_EQ(scan.records, 1500U);
  EXPECT_EQ(scan.invalid, 214U);
  ASSERT_EQ(scan.points.size(), 1286U);
  EXPECT_DOUBLE_EQ(scan.points[1].x(), 1000003 * 0.01 + 100.0);
  EXPECT_EQ(scan.intensity[2], 2.0F);
  EXPECT_EQ(scan.format, "LAZ 1.2 pf0");
}

/// Single returns on a wavy surface, with extremes now and then.
std::vector<std::string> some_points(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::string> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<std::int32_t>(i);
    const bool extreme = random() % 50 == 0;
    std::string point =
        testing::las_point(0, extreme ? static_cast<std::int32_t>(random()) : n * 13, extreme ? INT32_MIN : n % 100 * 7,
                           static_cast<std::int32_t>(random() % 500), static_cast<std::uint16_t>(random() % 3000));
    point[14] = 1 | 1 << 3;
    point[17] = static_cast<char>(random() % 4 == 0 ? random() : 7);
    points.push_back(point);
  }
  return points;
}

TEST(Laz, ChunksOfOneNumberOfPointsAndOfAnyGiveThePointsThatWerePacked) {
  for (const std::uint32_t each : {0U, 700U}) {
    std::vector<std::vector<std::string>> chunks;
    const std::vector<std::size_t> sizes =
        each == 0 ? std::vector<std::size_t>{5000, 1, 2, 12'000} : std::vector<std::size_t>{700, 700, 700, 33};
    std::string expected;
    for (const std::size_t size : sizes) {
      chunks.push_back(some_points(size, static_cast<unsigned>(size)));
      for (const std::string& point : chunks.back()) expected += point;
    }
    const std::string packed = testing::pack_las(chunks, each);
    EXPECT_LT(packed.size(), expected.size());
    for (const unsigned threads : {1U, 2U, 5U}) {
      EXPECT_EQ(difference(records_of(packed, laz::kAllLayers, threads), expected, 20), "") << each;
    }
  }
}

TEST(Laz, AFileThatWasCutShortAtAnyByteIsRefusedOrGivesAllItsPoints) {
  const std::string bytes = testing::pack_las({some_points(40, 1), some_points(40, 2), some_points(9, 3)}, 40);
  const RawScan whole = read_scan_bytes(bytes, "scan.laz");
  ASSERT_EQ(whole.records, 89U);
  std::size_t refused = 0;
  for (std::size_t size = 4; size < bytes.size(); ++size) {
    try {
      const RawScan cut = read_scan_bytes(bytes.substr(0, size), "scan.laz");
      ASSERT_EQ(cut.points, whole.points) << "cut at " << size;
    } catch (const Error& error) {
      ++refused;
      ASSERT_EQ(error.kind(), ErrorKind::input);
    }
  }
  EXPECT_GT(refused, bytes.size() - 40);
}

TEST(Laz, ATableThatDisagreesWithHeaderOrFileIsRefused) {
  const std::string bytes = testing::pack_las({some_points(40, 1), some_points(17, 2)}, 0);
  std::string more = bytes;
  set(more, 107, std::uint32_t{58});
  expect_refused("scan.laz", more, "1 points fewer than the header");
  std::string fewer = bytes;
  set(fewer, 107, std::uint32_t{56});
  expect_refused("scan.laz", fewer, "LAZ chunk 2 of 2 17 points where the header leaves 16");
  const std::size_t first = header_of(bytes).first_point;
  const auto table = static_cast<std::size_t>(load<std::int64_t>(bytes.data() + first));
  std::string many = bytes;
  set(many, table + 4, 0xFFFFFFFFU);
  expect_refused("scan.laz", many, "4294967295 LAZ chunks cannot be in");
  std::string zeros = bytes;
  std::fill(zeros.begin() + static_cast<std::ptrdiff_t>(table) + 8, zeros.end(), '\0');
  expect_refused("scan.laz", zeros, "points fewer than the header");
  std::string negative = bytes;
  set(negative, first, std::int64_t{-5});
  expect_refused("scan.laz", negative, "should be at byte -5");
}

TEST(Laz, AChunkThatEndsBeforeOrBehindItsPointsIsRefusedWithItsNumber) {
  std::string bytes = testing::pack_las({some_points(40, 1), some_points(17, 2)}, 40);
  set(bytes, 107, std::uint32_t{50});
  expect_refused("scan.laz", bytes, "LAZ chunk 2 of 2: the points end after");
  set(bytes, 107, std::uint32_t{80});
  expect_refused("scan.laz", bytes, "LAZ chunk 2 of 2: the stream ends before its points do");
}

TEST(Laz, APackingThatNobodyKnowsIsRefusedByName) {
  expect_refused("scan.laz", raw_chunks(3, 4), "packed by compressor 4");
  expect_refused("scan.laz", raw_chunks(3, 2, 3), "a LAZ item of type 6, version 3");
  std::string trial = raw_chunks(3);
  trial[104] = static_cast<char>(192);
  expect_refused("scan.laz", trial, "a trial version of LASzip");
  std::string longer = raw_chunks(3);
  set(longer, 105, std::uint16_t{21});
  expect_refused("scan.laz", longer, "the LAZ items make 20 bytes of a point, the header 21");
}

TEST(Laz, APromiseOfPointsTakesNoMemory) {
  std::string bytes = raw_chunks(30);
  set(bytes, 107, std::uint32_t{1'000'000'000});
  expect_refused("scan.laz", bytes, "LAZ chunk 31: the chunk ends within its first point");
}

TEST(Laz, LasPointsOfVersion14ThatAreKeptAsOlderOnesAreReadAndSaid) {
  std::string bytes = raw_chunks(3);
  bytes[227 + 54 + 8] = 1;
  const RawScan scan = read_scan_bytes(bytes, "scan.laz");
  EXPECT_EQ(scan.points.size(), 3U);
  EXPECT_THAT(scan.warnings, ::testing::Contains(HasSubstr("made as LAS 1.4 points")));
}

}  // namespace
}  // namespace sparsha::pipeline
