#include "laszip_double.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <set>

#include <laszip/laszip_api.h>

namespace sparsha::pipeline::testing {

namespace {

LaszipBooks& shared_books() {
  void* const page = ::mmap(nullptr, sizeof(LaszipBooks), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) throw std::bad_alloc();
  return *new (page) LaszipBooks;
}

}  // namespace

LaszipFaults laszip_faults;
LaszipBooks& laszip_books = shared_books();

namespace {

void misuse(const std::string& text) {
  std::snprintf(laszip_books.misuses, sizeof laszip_books.misuses, "%s", text.c_str());
}

constexpr char kGarble = 0x5C;
constexpr std::size_t kTable = 8;  // where LAZ tells the place of its table of chunks

struct Reader {
  bool open = false;
  std::string points;
  std::size_t record_size = 0;
  int format = 0;
  std::int64_t next = 0;
  laszip_point_struct point{};
  std::string error;
};

std::set<void*> living;

template <typename T>
T value_at(const std::string& bytes, std::size_t at) {
  T value{};
  if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The reader, when it may be used like this.
Reader* reader_of(laszip_POINTER pointer, const char* call, bool open) {
  if (living.count(pointer) == 0) {
    misuse(std::string(call) + " of what is not alive");
    return nullptr;
  }
  auto* const reader = static_cast<Reader*>(pointer);
  if (reader->open != open) {
    misuse(std::string(call) + (open ? " before opening" : " while open"));
    return nullptr;
  }
  return reader;
}

laszip_I32 fail(Reader& reader) {
  reader.error = laszip_faults.message;
  return 1;
}

/// Formats 6 and up tell what is withheld by their extended flags only.
void unpack(const std::string& record, int format, laszip_point_struct& point) {
  point.X = value_at<std::int32_t>(record, 0);
  point.Y = value_at<std::int32_t>(record, 4);
  point.Z = value_at<std::int32_t>(record, 8);
  point.intensity = value_at<std::uint16_t>(record, 12);
  const unsigned flags = static_cast<unsigned char>(record[15]);
  point.withheld_flag = format < 6 ? (flags >> 7U) & 1U : 0U;
  point.extended_classification_flags = format < 6 ? 0U : flags & 15U;
  constexpr std::array<std::size_t, 11> kColour{0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
  const std::size_t colour = kColour[static_cast<std::size_t>(format)];
  for (std::size_t k = 0; k < 3 && colour != 0; ++k) point.rgb[k] = value_at<std::uint16_t>(record, colour + 2 * k);
}

}  // namespace

std::string packed(LasFile file) {
  file.record_id = 22204;
  file.record_user = "laszip encoded";
  file.record.assign(34, '\0');
  set(file.record, 0, static_cast<std::uint16_t>(file.format < 6 ? 2 : 3));
  for (std::string& point : file.points)
    for (char& byte : point) byte = static_cast<char>(byte ^ kGarble);
  constexpr std::uint32_t kChunk = 50000;
  set(file.record, 12, kChunk);
  const auto chunks = static_cast<std::uint32_t>((file.points.size() + kChunk - 1) / kChunk);
  if (file.points.empty()) file.points.emplace_back();
  const bool none = file.points.front().empty();
  file.points.front().insert(0, kTable, '\0');
  std::string bytes = file.bytes();
  if (none) {
    set(bytes, 107, std::uint32_t{0});
    if (file.minor >= 4) set(bytes, 247, std::uint64_t{0});
  }
  std::uint32_t first = 0;
  std::memcpy(&first, bytes.data() + 96, 4);
  set(bytes, first, static_cast<std::int64_t>(bytes.size()));
  bytes += std::string(kTable, '\0');
  set(bytes, bytes.size() - 4, chunks);
  bytes[104] = static_cast<char>(bytes[104] | -128);
  return bytes;
}

}  // namespace sparsha::pipeline::testing

using namespace sparsha::pipeline::testing;

laszip_I32 laszip_create(laszip_POINTER* pointer) {
  if (laszip_faults.create) return 1;
  auto* const reader = new Reader;
  living.insert(reader);
  ++laszip_books.created;
  laszip_books.process = ::getpid();
  *pointer = reader;
  return 0;
}

laszip_I32 laszip_destroy(laszip_POINTER pointer) {
  if (living.erase(pointer) == 0) {
    misuse("destroy of what is not alive");
    return 1;
  }
  auto* const reader = static_cast<Reader*>(pointer);
  if (reader->open) misuse("destroy while open");
  delete reader;
  ++laszip_books.destroyed;
  return 0;
}

laszip_I32 laszip_get_error(laszip_POINTER pointer, laszip_CHAR** error) {
  if (living.count(pointer) == 0) return 1;
  *error = static_cast<Reader*>(pointer)->error.data();
  return 0;
}

laszip_I32 laszip_open_reader(laszip_POINTER pointer, const laszip_CHAR* file_name, laszip_BOOL* is_compressed) {
  Reader* const reader = reader_of(pointer, "open", false);
  if (reader == nullptr) return 1;
  std::FILE* const file = std::fopen(file_name, "rb");
  if (laszip_faults.open || file == nullptr) {
    if (file != nullptr) std::fclose(file);
    return fail(*reader);
  }
  std::string bytes;
  char part[4096];
  for (std::size_t n = 0; (n = std::fread(part, 1, sizeof part, file)) > 0;) bytes.append(part, n);
  std::fclose(file);
  reader->format = bytes[104] & 0x3F;
  reader->record_size = value_at<std::uint16_t>(bytes, 105);
  const auto first = value_at<std::uint32_t>(bytes, 96);
  reader->points = bytes.substr(std::min<std::size_t>(bytes.size(), first + kTable));
  *is_compressed = (bytes[104] & 0xC0) != 0 ? 1 : 0;
  reader->open = true;
  ++laszip_books.opened;
  return 0;
}

laszip_I32 laszip_get_point_pointer(laszip_POINTER pointer, laszip_point_struct** point_pointer) {
  Reader* const reader = reader_of(pointer, "the point's place", true);
  if (reader == nullptr) return 1;
  if (laszip_faults.point_pointer) return fail(*reader);
  *point_pointer = &reader->point;
  return 0;
}

laszip_I32 laszip_read_point(laszip_POINTER pointer) {
  Reader* const reader = reader_of(pointer, "read", true);
  if (reader == nullptr) return 1;
  if (reader->next == laszip_faults.read && laszip_faults.instead) laszip_faults.instead();
  const std::size_t at = static_cast<std::size_t>(reader->next) * reader->record_size;
  if (reader->next == laszip_faults.read || at + reader->record_size > reader->points.size()) return fail(*reader);
  std::string record = reader->points.substr(at, reader->record_size);
  for (char& byte : record) byte = static_cast<char>(byte ^ kGarble);
  unpack(record, reader->format, reader->point);
  ++reader->next;
  ++laszip_books.reads;
  return 0;
}

laszip_I32 laszip_close_reader(laszip_POINTER pointer) {
  Reader* const reader = reader_of(pointer, "close", true);
  if (reader == nullptr) return 1;
  if (laszip_faults.close) ::raise(SIGSEGV);
  reader->open = false;
  ++laszip_books.closed;
  return 0;
}
