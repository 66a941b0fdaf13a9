// Little-endian: a mark, how many sheets, then each sheet's head and its arrays.
#include "scene/folder/sheets_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/files/files.h"

namespace sparsha::scene {
namespace {

constexpr std::string_view kMark = "sparsha charts 1";
constexpr std::string_view kMarkOfMore = "sparsha charts 2";  // with the layers that heights and slopes do not have
constexpr std::uint32_t kAllMore = 0b11111;
static_assert(sizeof(float) == sizeof(std::uint32_t), "layers have four bytes a node");
constexpr std::size_t kHead = 5 * sizeof(std::int32_t);
constexpr std::size_t kNode = 3 * sizeof(float) + 1;
constexpr std::int32_t kMostNodes = 1 << 24;  // along a side
constexpr std::int32_t kFarthest = 1 << 30;   // first node
static_assert(std::endian::native == std::endian::little, "charts.bin is written as it lies in memory");

template <typename Value>
void put(std::string& bytes, const Value* values, std::size_t count) {
  const std::size_t at = bytes.size();
  bytes.resize(at + count * sizeof(Value));
  if (count > 0) std::memcpy(bytes.data() + at, values, count * sizeof(Value));
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file)
      : file_(file.string()), bytes_(read_file(file, std::numeric_limits<std::size_t>::max() / 2)) {}

  template <typename Value>
  void take(Value* values, std::size_t count) {
    if (count * sizeof(Value) > left()) throw bad("the file ends within a sheet");
    if (count > 0) std::memcpy(values, bytes_.data() + at_, count * sizeof(Value));
    at_ += count * sizeof(Value);
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] Error bad(const std::string& what) const {
    return input_error(file_, what, "charts.bin of a scene, as sparsha build wrote it");
  }

 private:
  std::string file_;
  std::string bytes_;
  std::size_t at_ = 0;
};

constexpr float kHighest_m = 1e12F;  // no scene is so large

bool keeps_its_word(const Sheet& sheet) {
  const auto nx = static_cast<std::size_t>(sheet.nx);
  for (std::size_t node = 0; node < sheet.count(); ++node) {
    const unsigned mask = sheet.mask[node];
    if ((mask & ~unsigned{Sheet::kMeasured | Sheet::kCell}) != 0) return false;
    const bool known = std::abs(sheet.height_m[node]) <= kHighest_m && std::isfinite(sheet.slope_u[node]) &&
                       std::isfinite(sheet.slope_v[node]);
    if (sheet.measured(node) && !known) return false;
    if (sheet.measured(node) && !sheet.texture_m.empty() && !std::isfinite(sheet.texture_m[node])) return false;
    if ((mask & Sheet::kCell) == 0) continue;
    if (node % nx + 1 >= nx || node + nx >= sheet.count()) return false;
    for (const std::size_t corner : {node, node + 1, node + nx, node + nx + 1}) {
      if (!sheet.measured(corner)) return false;
    }
  }
  return true;
}

/// Calls use(values) for each layer of a sheet, const or not, whose bit is set, in their order in the file.
template <typename AnySheet, typename Use>
void for_more(AnySheet& sheet, std::uint32_t more, const Use& use) {
  if ((more & 1U) != 0) use(sheet.texture_m);
  if ((more & 2U) != 0) use(sheet.curvature_per_m);
  if ((more & 4U) != 0) use(sheet.colour_rgba);
  if ((more & 8U) != 0) use(sheet.intensity);
  if ((more & 16U) != 0) use(sheet.error_m);
}

/// Bits of the layers that all sheets have.
std::uint32_t more_of(const std::vector<Sheet>& sheets) {
  if (sheets.empty()) return 0;
  std::uint32_t more = kAllMore;
  for (const Sheet& sheet : sheets) {
    for (std::uint32_t bit = 1; bit <= kAllMore; bit <<= 1U)
      for_more(sheet, bit, [&](const auto& values) {
        if (values.size() != sheet.count()) more &= ~bit;
      });
  }
  return more;
}

}  // namespace

void write_sheets(const std::filesystem::path& file, const std::vector<Sheet>& sheets) {
  const std::uint32_t more = more_of(sheets);
  std::string bytes(more != 0 ? kMarkOfMore : kMark);
  const std::uint64_t count = sheets.size();
  put(bytes, &count, 1);
  if (more != 0) put(bytes, &more, 1);
  for (const Sheet& sheet : sheets) {
    const std::array<std::int32_t, 5> head{static_cast<std::int32_t>(sheet.side), sheet.first_u, sheet.first_v,
                                           sheet.nx, sheet.ny};
    put(bytes, head.data(), head.size());
    for (const std::vector<float>* values : {&sheet.height_m, &sheet.slope_u, &sheet.slope_v}) {
      put(bytes, values->data(), values->size());
    }
    put(bytes, sheet.mask.data(), sheet.mask.size());
    for_more(sheet, more, [&](const auto& values) { put(bytes, values.data(), sheet.count()); });
  }
  write_file(file, bytes);
}

std::vector<Sheet> read_sheets(const std::filesystem::path& file) {
  Reader reader(file);
  std::array<char, kMark.size()> mark{};
  if (reader.left() < mark.size() + sizeof(std::uint64_t)) throw reader.bad("the file is too short");
  reader.take(mark.data(), mark.size());
  const std::string_view found(mark.data(), mark.size());
  if (found != kMark && found != kMarkOfMore) throw reader.bad("these are not the charts of this version");
  std::uint64_t count = 0;
  std::uint32_t more = 0;
  reader.take(&count, 1);
  if (found == kMarkOfMore) reader.take(&more, 1);
  if ((more & ~kAllMore) != 0) throw reader.bad("these are layers of another version");
  if (count > reader.left() / kHead) throw reader.bad("the file is shorter than its sheets");
  std::vector<Sheet> sheets(count);
  for (Sheet& sheet : sheets) {
    std::array<std::int32_t, 5> head{};
    reader.take(head.data(), head.size());
    const auto [side, first_u, first_v, nx, ny] = head;
    const auto near = [](std::int32_t first) { return first >= -kFarthest && first <= kFarthest; };
    if (side < 0 || side >= static_cast<std::int32_t>(kSides) || nx < 1 || ny < 1 || nx > kMostNodes ||
        ny > kMostNodes || !near(first_u) || !near(first_v)) {
      throw reader.bad("a sheet has an impossible side or size");
    }
    sheet.side = static_cast<Side>(side);
    sheet.first_u = first_u;
    sheet.first_v = first_v;
    sheet.nx = nx;
    sheet.ny = ny;
    if (sheet.count() > reader.left() / kNode) throw reader.bad("the file ends within a sheet");
    for (std::vector<float>* values : {&sheet.height_m, &sheet.slope_u, &sheet.slope_v}) {
      values->resize(sheet.count());
      reader.take(values->data(), sheet.count());
    }
    sheet.mask.resize(sheet.count());
    reader.take(sheet.mask.data(), sheet.count());
    for_more(sheet, more, [&](auto& values) {
      if (sheet.count() > reader.left() / sizeof(values[0])) throw reader.bad("the file ends within a sheet");
      values.resize(sheet.count());
      reader.take(values.data(), sheet.count());
    });
    if (!keeps_its_word(sheet)) throw reader.bad("a sheet has nodes that are called measured and are not");
  }
  if (reader.left() != 0) throw reader.bad("the file is longer than its sheets");
  return sheets;
}

}  // namespace sparsha::scene
