// Wavefront's MTL: http://paulbourke.net/dataformats/mtl/, with what files in use make of it.
#include "pipeline/scan/formats/obj/materials.h"

#include <array>
#include <limits>
#include <map>
#include <optional>

#include "base/error.h"
#include "pipeline/scan/formats/obj/statements.h"

namespace sparsha::pipeline::obj {
namespace {

constexpr std::size_t kHead = 1 << 16;

/// A picture as a material lays it: place = offset + scale * coordinate.
struct Map {
  std::uint32_t picture = 0;
  std::array<double, 2> offset{0, 0}, scale{1, 1};
};

/// All that follows the keyword, without blanks around it; names may have blanks.
std::string rest_of(std::string_view statement) {
  (void)take_word(statement);
  const std::size_t begin = statement.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return "";
  return std::string(statement.substr(begin, statement.find_last_not_of(" \t\r") - begin + 1));
}

bool is_number(std::string_view word, double& value) {
  const char* const end = word.data() + word.size();
  return !word.empty() && parse_number(word.data(), end, value) == end;
}

/// One to three numbers, of which the first two count.
void take_numbers(std::string_view& rest, std::array<double, 2>& values) {
  for (std::size_t k = 0; k < 3; ++k) {
    std::string_view ahead = rest;
    double value = 0.0;
    if (!is_number(take_word(ahead), value)) return;
    if (k < 2) values[k] = value;
    rest = ahead;
  }
}

/// "-s 2 2 -clamp on a picture.jpg".
std::optional<Map> map_of(std::string_view statement, Paint& paint) {
  static const std::map<std::string_view, int> kOptions{{"-blendu", 1}, {"-blendv", 1}, {"-boost", 1},   {"-bm", 1},
                                                        {"-cc", 1},     {"-clamp", 1},  {"-imfchan", 1}, {"-mm", 2},
                                                        {"-texres", 1}, {"-type", 1}};
  Map map;
  Wrap wrap = Wrap::repeat;
  (void)take_word(statement);
  for (std::string_view ahead = statement;; statement = ahead) {
    const std::string_view word = take_word(ahead);
    std::array<double, 2> ignored{};
    if (word == "-o" || word == "-s" || word == "-t") {
      take_numbers(ahead, word == "-o" ? map.offset : word == "-s" ? map.scale : ignored);
      continue;
    }
    const auto option = kOptions.find(word);
    if (option == kOptions.end()) break;
    for (int k = 0; k < option->second; ++k) {
      if (take_word(ahead) == "on" && word == "-clamp") wrap = Wrap::clamp;
    }
  }
  const std::string name = rest_of("map " + std::string(statement));
  if (name.empty()) return std::nullopt;
  map.picture = paint.picture(name, wrap);
  return map;
}

class Painter {
 public:
  Painter(const ScanFile& file, ScanWriter& out) : file_(file), out_(out) {}

  Paint paint() {
    read_libraries();
    if (maps_.empty()) return {};
    Statements statements(file_.bytes);
    std::string_view statement;
    std::size_t told = 0;
    while (statements.next(statement)) {
      take(statement);
      if (statements.offset() - told > (1U << 22)) {
        told = statements.offset();
        file_.throw_if_cancelled();
        out_.expect_mesh(vertices_, triangles_);
      }
    }
    out_.expect_mesh(vertices_, triangles_);
    coordinates_ = {};
    paint_.dry(file_, out_.scan().warnings);
    return std::move(paint_);
  }

 private:
  /// Libraries are named before the first vertex, as all programs have it.
  void read_libraries() {
    Statements statements(file_.bytes.substr(0, kHead));
    std::string_view statement;
    while (statements.next(statement) && !is_vertex(statement)) {
      if (!begins_with(statement, "mtllib")) continue;
      const std::string name = rest_of(statement);
      try {
        const std::unique_ptr<MappedFile> library = open_beside(file_, name);
        read_library(library->text());
      } catch (const Cancelled&) {
        throw;
      } catch (const Error& error) {
        out_.scan().notes.push_back("OBJ: materials are not read: " + error.wrong());
      }
    }
  }

  void read_library(std::string_view text) {
    constexpr std::size_t kMostMaterials = 65536;
    Statements statements(text);
    std::string_view statement;
    std::string material;
    while (statements.next(statement)) {
      if (begins_with(statement, "newmtl")) {
        material = rest_of(statement);
      } else if (begins_with(statement, "map_Kd") || begins_with(statement, "map_kd")) {
        if (maps_.size() == kMostMaterials) throw file_.error("too many materials", "fewer");
        if (const std::optional<Map> map = map_of(statement, paint_)) maps_.insert_or_assign(material, *map);
      }
    }
  }

  void take(std::string_view statement) {
    if (is_vertex(statement)) {
      ++vertices_;
    } else if (begins_with(statement, "vt")) {
      std::array<double, 2> place{};
      std::string_view rest = statement.substr(2);
      take_numbers(rest, place);
      coordinates_.push_back({static_cast<float>(place[0]), static_cast<float>(place[1])});
    } else if (begins_with(statement, "usemtl")) {
      const auto found = maps_.find(rest_of(statement));
      map_ = found == maps_.end() ? nullptr : &found->second;
    } else if (const std::size_t keyword = face_keyword(statement); keyword > 0) {
      face(statement.substr(keyword));
    }
  }

  /// What is wrong with a face is said when it is read as one.
  void face(std::string_view rest) {
    std::uint64_t corners = 0;
    for (std::string_view word = take_word(rest); !word.empty() && word[0] != '#'; word = take_word(rest)) {
      ++corners;
      const char* const end = word.data() + word.size();
      std::int64_t vertex = 0, coordinate = 0;
      const char* const slash = parse_integer(word.data(), end, vertex);
      if (map_ == nullptr || slash == nullptr || slash == end || *slash != '/' ||
          parse_integer(slash + 1, end, coordinate) == nullptr)
        continue;
      const std::uint64_t n = number(vertex, vertices_), k = number(coordinate, coordinates_.size());
      if (n >= vertices_ || k >= coordinates_.size()) continue;
      const std::array<float, 2>& place = coordinates_[static_cast<std::size_t>(k)];
      paint_.lay(n, map_->picture, map_->offset[0] + map_->scale[0] * static_cast<double>(place[0]),
                 map_->offset[1] + map_->scale[1] * static_cast<double>(place[1]));
    }
    if (corners > 2) triangles_ += corners - 2;
  }
  /// From 0; negative ones count back from the last so far.
  static std::uint64_t number(std::int64_t index, std::uint64_t count) {
    const std::int64_t from_zero = index < 0 ? static_cast<std::int64_t>(count) + index : index - 1;
    return from_zero < 0 ? std::numeric_limits<std::uint64_t>::max() : static_cast<std::uint64_t>(from_zero);
  }

  const ScanFile& file_;
  ScanWriter& out_;
  Paint paint_;
  std::map<std::string, Map> maps_;
  const Map* map_ = nullptr;
  std::vector<std::array<float, 2>> coordinates_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
};

}  // namespace

Paint paint_of(const ScanFile& file, ScanWriter& out) { return Painter(file, out).paint(); }

}  // namespace sparsha::pipeline::obj
