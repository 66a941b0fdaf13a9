// Wavefront's MTL: http://paulbourke.net/dataformats/mtl/, with what files in use make of it.
#include "pipeline/scan/formats/obj/materials.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "pipeline/scan/formats/obj/statements.h"

namespace sparsha::pipeline::obj {
namespace {

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

/// A name as far as a remark behind it. What has '#' in its midst stays whole.
std::string without_remark(const std::string& name) {
  std::size_t at = name.find('#');
  while (at != std::string::npos && at > 0 && !is_blank(name[at - 1])) at = name.find('#', at + 1);
  if (at == std::string::npos) return name;
  const std::size_t end = at == 0 ? std::string::npos : name.find_last_not_of(" \t", at - 1);
  return end == std::string::npos ? "" : name.substr(0, end + 1);
}

/// Null where it is not beside the scan.
std::unique_ptr<MappedFile> open_if_there(const ScanFile& file, const std::string& name) {
  try {
    return name.empty() ? nullptr : open_beside(file, name);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    return nullptr;
  }
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
std::optional<Map> map_of(const ScanFile& file, std::string_view statement, Paint& paint) {
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
  std::string name = rest_of("map " + std::string(statement));
  if (const std::string bare = without_remark(name); bare != name && open_if_there(file, name) == nullptr) name = bare;
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
    if (!unknown_.empty()) {
      out_.scan().warnings.push_back(fmt::format(
          "{} that the libraries do not have, {} first: their colours are missing",
          unknown_.size() == 1 ? "faces use 1 material" : fmt::format("faces use {} materials", unknown_.size()),
          in_quotes(*unknown_.begin())));
    }
    paint_.dry(file_, out_.scan().warnings);
    return std::move(paint_);
  }

 private:
  /// Libraries are named before the first vertex by most programs, and anywhere by some.
  void read_libraries() {
    constexpr std::string_view kKeyword = "mtllib";
    constexpr std::size_t kStep = 1U << 22U, kLongest = 1U << 16U;
    const std::string_view text = file_.bytes;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t found = text.substr(0, at + kStep).find(kKeyword, at);
      if (found == std::string_view::npos) {
        at += std::min(kStep - kKeyword.size(), text.size() - at);
        file_.done_before(at);
        continue;
      }
      at = found + kKeyword.size();
      // It may stand in a remark or a name.
      const std::size_t before = text.substr(0, found).find_last_not_of(" \t");
      if (before != std::string_view::npos && text[before] != '\n' && text[before] != '\r') continue;
      Statements statements(text.substr(found, kLongest));
      std::string_view statement;
      if (statements.next(statement) && begins_with(statement, kKeyword)) read_named(rest_of(statement));
    }
  }

  /// One name, which may have blanks, or several; where words go together, the longest name of a file counts.
  void read_named(const std::string& names) {
    constexpr std::size_t kMostNames = 64;
    if (read_file(names)) return;
    const std::string bare = without_remark(names);
    if (bare != names && read_file(bare)) return;
    std::vector<std::size_t> begins, ends;
    for (std::size_t begin = bare.find_first_not_of(" \t"); begin != std::string::npos && begins.size() < kMostNames;) {
      const std::size_t end = std::min(bare.find_first_of(" \t", begin), bare.size());
      begins.push_back(begin);
      ends.push_back(end);
      begin = bare.find_first_not_of(" \t", end);
    }
    std::size_t read = 0;
    std::string missing;
    for (std::size_t first = 0; first < begins.size();) {
      std::size_t last = begins.size();
      while (last > first && !read_file(bare.substr(begins[first], ends[last - 1] - begins[first]))) --last;
      if (last == first) {
        missing += (missing.empty() ? "" : " ") + bare.substr(begins[first], ends[first] - begins[first]);
        last = first + 1;
      } else {
        ++read;
      }
      first = last;
    }
    const std::string& said = read == 0 ? bare : missing;
    if (!said.empty()) note_missing(said);
  }

  /// False when it cannot be read.
  bool read_file(const std::string& name) {
    if (read_.contains(name)) return true;
    const std::unique_ptr<MappedFile> library = open_if_there(file_, name);
    if (library == nullptr) return false;
    read_.insert(name);
    read_library(library->text());
    return true;
  }

  void note_missing(const std::string& name) {
    constexpr std::size_t kMostNotes = 8;
    if (++missing_ > kMostNotes) return;
    try {
      (void)open_beside(file_, name);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      out_.scan().notes.push_back("OBJ: materials are not read: " + error.wrong());
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
        materials_.insert(material);
        materials_.insert(without_remark(material));
      } else if (begins_with(statement, "map_Kd") || begins_with(statement, "map_kd")) {
        if (maps_.size() == kMostMaterials) throw file_.error("too many materials", "fewer");
        const std::optional<Map> map = map_of(file_, statement, paint_);
        if (!map) continue;
        maps_.insert_or_assign(material, *map);
        maps_.try_emplace(without_remark(material), *map);
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
      std::string name = rest_of(statement);
      if (!materials_.contains(name)) name = without_remark(name);
      if (!materials_.contains(name) && !name.empty()) unknown_.insert(name);
      const auto found = maps_.find(name);
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
  std::set<std::string> read_;       ///< libraries
  std::uint64_t missing_ = 0;        ///< of them
  std::set<std::string> materials_;  ///< of the libraries, with a picture or without
  std::set<std::string> unknown_;    ///< materials that no library has
  std::map<std::string, Map> maps_;
  const Map* map_ = nullptr;
  std::vector<std::array<float, 2>> coordinates_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
};

}  // namespace

Paint paint_of(const ScanFile& file, ScanWriter& out) { return Painter(file, out).paint(); }

}  // namespace sparsha::pipeline::obj
