// Khronos glTF 2.0 specification (ISO/IEC 12113), section 3.7 (meshes).
#include "pipeline/scan/formats/gltf/gltf.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <Eigen/LU>

#include "pipeline/scan/foreign_text.h"
#include "pipeline/scan/formats/gltf/accessor.hpp"
#include "pipeline/scan/formats/gltf/draco.hpp"
#include "pipeline/scan/formats/gltf/look.hpp"
#include "pipeline/scan/formats/gltf/scene.hpp"
#include "pipeline/scan/formats/gltf/shared_vertices.hpp"
#include "pipeline/scan/formats/gltf/splats.hpp"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

using gltf::Accessor;
using gltf::Document;
using gltf::Json;
using gltf::Place;

/// Extensions that may be required: those that are read, and some that change neither form nor colour of vertices.
constexpr std::array<std::string_view, 9> kKnown{
    "KHR_node_visibility",     "KHR_mesh_quantization",   "KHR_texture_transform",
    "KHR_texture_basisu",      "EXT_texture_webp",        "KHR_lights_punctual",
    "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_draco_mesh_compression"};
void refuse_extensions(const Document& document) {
  const auto required = document.root().find("extensionsRequired");
  if (required == document.root().end() || !required->is_array()) return;
  for (const Json& entry : *required) {
    if (!entry.is_string()) continue;
    const std::string name = entry.get<std::string>();
    const bool known = name.starts_with("KHR_materials_") || name.starts_with("KHR_gaussian_splatting") ||
                       name == "KHR_spz_gaussian_splats_compression" ||
                       std::find(kKnown.begin(), kKnown.end(), name) != kKnown.end();
    if (!known) {
      throw document.file().error("the file needs the extension " + in_quotes(name) + ", which is not known here",
                                  "a file without it");
    }
  }
}

void multiply(Light& light, const Light& by) {
  for (std::size_t k = 0; k < light.size(); ++k) light[k] *= by[k];
}

/// Of channels from 0 to 1 as pictures have them.
std::uint32_t packed(const std::array<double, 4>& c) {
  const auto byte = [](double value) { return colour_byte(value, ColourScale::unit); };
  return pack_rgba(byte(c[0]), byte(c[1]), byte(c[2]), byte(c[3]));
}

constexpr std::size_t kMostNamed = 8;  ///< sentences of a kind

enum class Mode : std::uint8_t { points = 0, triangles = 4, strip = 5, fan = 6 };

/// One primitive of a mesh.
struct Primitive {
  Place place;
  Mode mode = Mode::triangles;
  Accessor positions;
  std::uint64_t source = 0;  ///< positions of one source are the same
  std::optional<Accessor> normals, colours, indices;
  gltf::Look look;
  std::optional<Accessor> texture;  ///< coordinates, where the look's picture can be read
  std::optional<gltf::Splats> splats;
  std::vector<std::pair<std::string, Accessor>> numbers;  ///< attributes of its own with one number each

  [[nodiscard]] gltf::SharedVertices::Use use() const {
    return {source, positions.size(), indices ? &*indices : nullptr, mode == Mode::points};
  }
  [[nodiscard]] std::uint64_t triangles() const {
    const std::uint64_t corners = indices ? indices->size() : positions.size();
    if (mode == Mode::points || corners < 3) return 0;
    return mode == Mode::triangles ? corners / 3 : corners - 2;
  }
};

class Reader {
 public:
  Reader(const ScanFile& file, ScanWriter& out) : file_(file), out_(out), document_(file) {}

  void read() {
    refuse_extensions(document_);
    RawScan& scan = out_.scan();
    scan.format = document_.is_binary() ? "glTF 2.0 binary" : "glTF 2.0 text";
    scan.unit = scene::LengthUnit::m;
    const auto generator = document_.root().at("asset").find("generator");
    if (generator != document_.root().at("asset").end() && generator->is_string())
      scan.notes.push_back("glTF: written by " + printable(generator->get<std::string>()));
    const gltf::Shown shown = gltf::shown_meshes(document_);
    if (shown.instances.empty())
      throw file_.empty(shown.hidden > 0 ? "all meshes of its scene are hidden (KHR_node_visibility)"
                                         : "no node of its scene shows a mesh",
                        "a scene with a mesh or with points");
    std::vector<std::vector<Primitive>> meshes(static_cast<std::size_t>(document_.size_of("meshes")));
    std::uint64_t total = 0, triangles = 0;
    for (const gltf::Instance& instance : shown.instances) {
      (void)document_.item("meshes", instance.mesh, "nodes");
      std::vector<Primitive>& mesh = meshes[static_cast<std::size_t>(instance.mesh)];
      if (mesh.empty()) {
        mesh = primitives_of(instance.mesh);
        for (const Primitive& primitive : mesh) vertices_.look_at(primitive.use());
      }
      if (gltf::is_morphed(document_, instance)) morphed_.insert(instance.mesh);
      vertices_.stand_at(instance.place);
      for (const Primitive& primitive : mesh) {
        total += vertices_.most_given_by(primitive.use());
        triangles += primitive.triangles();
      }
      refuse_many(total, triangles);
    }
    out_.expect_mesh(total, triangles);
    name_fields(shown, meshes);
    out_.begin(total, colour_, false, normals_);
    vertices_.begin_again();
    for (const gltf::Instance& instance : shown.instances) {
      vertices_.stand_at(instance.place);
      for (Primitive& primitive : meshes[static_cast<std::size_t>(instance.mesh)]) add(primitive, instance.place);
    }
    warn(shown);
  }

 private:
  /// A mesh that many nodes show is read as often: a file must not become hundreds of times as large in memory.
  void refuse_many(std::uint64_t vertices, std::uint64_t triangles) const {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    constexpr std::uint64_t kVertex = 64, kTriangle = 24;  // bytes, with what is looked for beside them
    constexpr std::uint64_t kTimes = 32, kAlways = 512'000'000;
    const std::uint64_t needed = vertices < kMost && triangles < kMost ? kVertex * vertices + kTriangle * triangles : 0;
    if (needed == 0 ? vertices > 0 || triangles > 0 : needed > kTimes * file_.bytes.size() + kAlways) {
      throw file_.error(
          fmt::format("its nodes show meshes of {} vertices and {} triangles together{}", vertices, triangles,
                      needed > 0 ? fmt::format(", which need about {} MB in memory", needed / 1'000'000U + 1) : ""),
          "a model of one object, not one that repeats a mesh many times");
    }
  }

  std::vector<Primitive> primitives_of(std::uint64_t number) {
    const Place place = fmt::format("meshes[{}]", number);
    const Json& mesh = document_.item("meshes", number, place);
    std::vector<Primitive> result;
    const auto list = mesh.find("primitives");
    if (list == mesh.end() || !list->is_array()) throw document_.error(place, "has no list 'primitives'");
    for (std::size_t k = 0; k < list->size(); ++k) {
      const Place here = fmt::format("{}.primitives[{}]", place, k);
      if (!(*list)[k].is_object()) throw document_.error(here, "no object", "{...}");
      if (auto primitive = primitive_of((*list)[k], here)) result.push_back(std::move(*primitive));
    }
    return result;
  }

  std::optional<Primitive> primitive_of(const Json& json, const Place& place) {
    const std::uint64_t mode = document_.whole(json, "mode", 4, place);
    if (mode > 6) throw document_.error(place, fmt::format("mode {}", mode), "0 to 6");
    if (mode >= 1 && mode <= 3) {
      ++lines_;
      return std::nullopt;
    }
    const auto attributes = json.find("attributes");
    if (attributes == json.end() || !attributes->is_object()) throw document_.error(place, "has no 'attributes'");
    if (!attributes->contains("POSITION")) {
      ++without_places_;
      return std::nullopt;
    }
    if (gltf::Splats::are_packed(json)) return packed_splats(json, *attributes, place);
    const std::unique_ptr<const gltf::DracoMesh> packed = gltf::DracoMesh::of(document_, json, place);
    const auto accessor = [&](const char* name) -> std::optional<Accessor> {
      const std::optional<std::uint64_t> index = document_.whole(*attributes, name, place + ".attributes");
      if (!index) return std::nullopt;
      if (packed && packed->has(name)) return Accessor(document_, *index, place + "." + name, *packed, name);
      return Accessor(document_, *index, place + "." + name);
    };
    Primitive primitive{place,
                        static_cast<Mode>(mode),
                        *accessor("POSITION"),
                        packed ? next_of_its_own() : document_.required(*attributes, "POSITION", place),
                        accessor("NORMAL"),
                        accessor("COLOR_0"),
                        std::nullopt,
                        {},
                        std::nullopt,
                        std::nullopt,
                        {}};
    const auto size = primitive.positions.size();
    require(primitive.positions, 3, 3, size);
    if (primitive.normals) require(*primitive.normals, 3, 3, size);
    if (primitive.colours) {
      require(*primitive.colours, 3, 4, size);
      // The standard allows no others (3.7.2.1).
      if (!is_floating(primitive.colours->type()) && primitive.colours->normalise()) ++scaled_colours_;
    }
    if (const std::optional<std::uint64_t> indices = document_.whole(json, "indices", place)) {
      if (packed) {
        primitive.indices.emplace(document_, *indices, place + ".indices", *packed, "");
        primitive.mode = Mode::triangles;
      } else {
        primitive.indices.emplace(document_, *indices, place + ".indices");
      }
      require(*primitive.indices, 1, 1, primitive.indices->size());
      const ScalarType type = primitive.indices->type();
      if (type != ScalarType::u8 && type != ScalarType::u16 && type != ScalarType::u32)
        throw document_.error(primitive.indices->place(), "indices that are no unsigned numbers",
                              "componentType 5121, 5123 or 5125");
    }
    primitive.splats = gltf::Splats::of(document_, json, size, place);
    primitive.look = gltf::look_of(document_, json, place);
    lay_texture(primitive, accessor);
    for (const auto& [name, value] : attributes->items()) {
      if (!name.starts_with('_') || !value.is_number_unsigned()) continue;
      std::optional<Accessor> numbers = accessor(name.c_str());
      if (numbers->components() == 1 && numbers->size() == size)
        primitive.numbers.emplace_back(name.substr(1), std::move(*numbers));
    }
    return primitive;
  }

  /// All of their numbers are in one stream; their accessors tell how many there are.
  Primitive packed_splats(const Json& json, const Json& attributes, const Place& place) {
    Accessor positions(document_, document_.required(attributes, "POSITION", place), place + ".POSITION",
                       Accessor::kFormOnly);
    std::optional<gltf::Splats> splats = gltf::Splats::of(document_, json, positions.size(), place);
    return {place,
            Mode::points,
            std::move(positions),
            next_of_its_own(),
            std::nullopt,
            std::nullopt,
            std::nullopt,
            {},
            std::nullopt,
            std::move(splats),
            {}};
  }

  /// A source of positions that no other primitive has, beside those that are accessors' numbers.
  std::uint64_t next_of_its_own() { return --own_source_; }

  void require(const Accessor& accessor, std::size_t least, std::size_t most, std::uint64_t size) const {
    if (accessor.components() < least || accessor.components() > most)
      throw document_.error(accessor.place(), fmt::format("{} numbers an element", accessor.components()),
                            fmt::format("{}", least));
    if (accessor.size() != size)
      throw document_.error(accessor.place(), fmt::format("{} elements", accessor.size()),
                            fmt::format("{}, as there are positions", size));
  }

  /// A picture that cannot be read takes its material's factor with it: what it would tint is missing.
  template <typename Find>
  void lay_texture(Primitive& primitive, const Find& accessor) {
    gltf::Look& look = primitive.look;
    if (!look.why.empty()) why_.insert(look.why);
    if (!look.image) return;
    primitive.texture = accessor(fmt::format("TEXCOORD_{}", look.coordinates).c_str());
    if (primitive.texture) {
      require(*primitive.texture, 2, 2, primitive.positions.size());
    } else {
      ++not_laid_;
    }
    if (!primitive.texture || pictures_.find(*look.image) == nullptr) {
      primitive.texture.reset();
      look = {};
    }
  }

  void name_fields(const gltf::Shown& shown, const std::vector<std::vector<Primitive>>& meshes) {
    for (const gltf::Instance& instance : shown.instances) {
      for (const Primitive& primitive : meshes[static_cast<std::size_t>(instance.mesh)]) {
        if (primitive.splats) slots_.try_emplace("opacity", ScanWriter::kUnwanted);
        colour_ = colour_ || primitive.colours || primitive.texture || primitive.splats ||
                  (primitive.look.factor && colour_of(*primitive.look.factor) != kWhite);
        normals_ = normals_ || primitive.normals;
        for (const auto& [name, numbers] : primitive.numbers) slots_.try_emplace(name, ScanWriter::kUnwanted);
      }
    }
    RawScan& scan = out_.scan();
    scan.fields = {"x", "y", "z"};
    if (normals_) scan.fields.insert(scan.fields.end(), {"nx", "ny", "nz"});
    if (colour_) scan.fields.insert(scan.fields.end(), {"red", "green", "blue", "alpha"});
    for (auto& [name, slot] : slots_) {
      scan.fields.push_back(name);
      slot = out_.want(name);
    }
  }

  /// Of vertex n: the product of its own colour, the material's and the picture's.
  std::uint32_t colour(const Primitive& primitive, const ColourPicture* picture, std::uint64_t n) const {
    if (primitive.splats) return primitive.splats->colour(n);
    Light light = primitive.look.factor.value_or(Light{1, 1, 1, 1});
    if (primitive.colours) {
      std::array<double, 4> c = (*primitive.colours)(n);
      if (primitive.colours->components() < 4) c[3] = 1.0;
      // Bytes are written as they are in pictures by nearly all programs; finer numbers are light, as the standard
      // says.
      if (primitive.colours->type() == ScalarType::u8) {
        if (!primitive.look.factor && picture == nullptr) return packed(c);
        for (std::size_t k = 0; k < 3; ++k) c[k] = linear_of_srgb(c[k]);
      }
      multiply(light, c);
    }
    if (picture != nullptr) {
      const std::array<double, 4> at = (*primitive.texture)(n);
      multiply(light, primitive.look.light(*picture, at[0], at[1]));
    }
    return colour_of(light);
  }

  static Eigen::Vector3d position(const Primitive& primitive, std::uint64_t n) {
    if (primitive.splats) {
      if (const std::optional<std::array<double, 3>> p = primitive.splats->centre(n))
        return {(*p)[0], (*p)[1], (*p)[2]};
    }
    const std::array<double, 4> p = primitive.positions(n);
    return {p[0], p[1], p[2]};
  }

  void add(Primitive& primitive, const Eigen::Matrix4d& place) {
    const auto first = static_cast<std::uint32_t>(out_.records());
    const Eigen::Matrix3d linear = place.topLeftCorner<3, 3>();
    const Eigen::Vector3d shift = place.topRightCorner<3, 1>();
    const double turns = linear.determinant();
    const Eigen::Matrix3d of_normals = linear.inverse().transpose();
    // Decoded again where many pictures had no room together.
    const std::shared_ptr<const ColourPicture> picture =
        primitive.texture ? pictures_.find(*primitive.look.image) : nullptr;
    const bool coloured = primitive.colours || picture || primitive.splats || (colour_ && primitive.look.factor);
    out_.set_attributes(coloured, false, primitive.normals.has_value());
    const std::optional<std::vector<std::uint32_t>> some = vertices_.given_by(primitive.use());
    const std::uint64_t count = some ? some->size() : primitive.positions.size();
    for (std::uint64_t k = 0; k < count; ++k) {
      const std::uint64_t n = some ? (*some)[k] : k;
      if (primitive.splats && !add_opacity(*primitive.splats, n)) continue;
      const Eigen::Vector3d at = linear * position(primitive, n) + shift;
      if (primitive.normals) {
        const std::array<double, 4> v = (*primitive.normals)(n);
        const Eigen::Vector3d normal = of_normals * Eigen::Vector3d(v[0], v[1], v[2]);
        out_.set_normal(normal.x(), normal.y(), normal.z());
      }
      for (const auto& [name, numbers] : primitive.numbers) {
        const int slot = slots_.at(name);
        if (slot != ScanWriter::kUnwanted) out_.set_field(slot, numbers(n)[0]);
      }
      if (coloured) {
        out_.add(at.x(), at.y(), at.z(), colour(primitive, picture.get(), n));
      } else {
        out_.add(at.x(), at.y(), at.z());
      }
      if ((k & 0xFFFF) == 0xFFFF) file_.throw_if_cancelled();
    }
    if (primitive.splats) primitive.splats->warn(out_.scan());
    if (primitive.mode != Mode::points) add_faces(primitive, some, first, turns < 0.0);
  }

  /// False, and an invalid record, for a splat that is no surface.
  bool add_opacity(gltf::Splats& splats, std::uint64_t n) {
    if (!splats.keeps(n)) {
      out_.add_invalid();
      return false;
    }
    const int slot = slots_.at("opacity");
    if (slot != ScanWriter::kUnwanted) out_.set_field(slot, splats.opacity(n));
    return true;
  }

  /// `some`: the vertices from record `first` on, where they are not all. `mirrored`: the node's transform turns
  /// triangles inside out, which the standard undoes.
  void add_faces(const Primitive& primitive, const std::optional<std::vector<std::uint32_t>>& some, std::uint32_t first,
                 bool mirrored) {
    const std::uint64_t vertices = primitive.positions.size();
    if (some) {
      if (record_of_.size() < vertices) record_of_.resize(static_cast<std::size_t>(vertices));
      for (std::uint32_t k = 0; k < some->size(); ++k) record_of_[(*some)[k]] = k;
    }
    const std::uint64_t count = primitive.indices ? primitive.indices->size() : vertices;
    const auto corner = [&](std::uint64_t k) -> std::uint32_t {
      const std::uint64_t index = primitive.indices ? primitive.indices->index(k) : k;
      // One that does not exist is counted by finish().
      if (index >= vertices) return std::numeric_limits<std::uint32_t>::max();
      return first + (some ? record_of_[static_cast<std::size_t>(index)] : static_cast<std::uint32_t>(index));
    };
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      if (mirrored) std::swap(b, c);
      out_.add_triangle(a, b, c);
    };
    const std::uint64_t step = primitive.mode == Mode::triangles ? 3 : 1;
    for (std::uint64_t k = 0; k + 2 < count; k += step) {
      const bool odd = primitive.mode == Mode::strip && k % 2 == 1;
      const std::uint64_t a = primitive.mode == Mode::fan ? 0 : odd ? k + 1 : k;
      const std::uint64_t b = odd ? k : k + 1;
      triangle(corner(a), corner(b), corner(k + 2));
      if ((k & 0xFFFF) == 0xFFFF) file_.throw_if_cancelled();
    }
    if (primitive.mode == Mode::triangles && count % 3 != 0) ++broken_;
  }

  void warn(const gltf::Shown& shown) {
    std::vector<std::string>& warnings = out_.scan().warnings;
    const auto say = [&](std::uint64_t count, const char* one, const char* many) {
      if (count > 0) warnings.push_back(count == 1 ? one : fmt::format("{} {}", count, many));
    };
    say(shown.other_scenes, "another scene of the file is not read, only its default one",
        "other scenes of the file are not read, only its default one");
    say(shown.skinned, "a node's skin is not applied: the mesh stands as it was modelled",
        "nodes' skins are not applied: the meshes stand as they were modelled");
    say(shown.many, "a node repeats its mesh (EXT_mesh_gpu_instancing): it is read once",
        "nodes repeat their meshes (EXT_mesh_gpu_instancing): each is read once");
    say(shown.hidden, "a node's mesh is hidden (KHR_node_visibility) and left out",
        "nodes' meshes are hidden (KHR_node_visibility) and left out");
    say(shown.placed_twice, "a node has a matrix and a translation, rotation or scale beside it: the matrix is used",
        "nodes have a matrix and a translation, rotation or scale beside it: the matrices are used");
    say(vertices_.unnamed(), "a position that no index of its points names is not read",
        "positions that no index of their points names are not read");
    say(vertices_.missing(), "an index of points names a position that is not there; left out",
        "indices of points name positions that are not there; left out");
    say(scaled_colours_, "a primitive's colours are whole numbers that are not said to be normalised: they are read so",
        "primitives' colours are whole numbers that are not said to be normalised: they are read so");
    say(morphed_.size(), "a mesh's morph targets are not applied", "meshes' morph targets are not applied");
    say(lines_, "a primitive of lines is not used: it is no surface",
        "primitives of lines are not used: they are no surface");
    say(without_places_, "a primitive without positions is not used", "primitives without positions are not used");
    say(not_laid_, "a material's texture has no coordinates: its colours are missing",
        "materials' textures have no coordinates: their colours are missing");
    for (const auto& [image, why] : pictures_.why()) why_.insert(why);
    std::size_t named = 0;
    for (const std::string& why : why_) {
      if (named++ == kMostNamed) break;
      warnings.push_back("a texture's colours are missing: " + why);
    }
    if (why_.size() > kMostNamed)
      warnings.push_back(fmt::format("colours of {} more textures are missing", why_.size() - kMostNamed));
    say(broken_, "a primitive's last triangle is not whole", "primitives' last triangles are not whole");
  }

  const ScanFile& file_;
  ScanWriter& out_;
  Document document_;
  gltf::Pictures pictures_{document_};
  gltf::SharedVertices vertices_;
  std::vector<std::uint32_t> record_of_;  ///< of vertices that a primitive gives, behind its first record
  std::uint64_t own_source_ = std::numeric_limits<std::uint64_t>::max();
  std::set<std::string> why_;  ///< textures are missing
  bool colour_ = false;
  bool normals_ = false;
  std::map<std::string, int> slots_;  ///< of attributes of the file's own
  std::set<std::uint64_t> morphed_;   ///< meshes
  std::uint64_t lines_ = 0, without_places_ = 0, not_laid_ = 0, broken_ = 0, scaled_colours_ = 0;
};

}  // namespace

bool is_gltf(const ScanFile& file) {
  return gltf::is_binary(file.bytes) || is_object_of_json(file.bytes, {"\"asset\"", "\"version\""}) ||
         (file.extension == "gltf" && is_json(file.bytes));
}

void read_gltf(const ScanFile& file, ScanWriter& out) { Reader(file, out).read(); }

}  // namespace sparsha::pipeline
