#include "pipeline/scan/formats/threemf/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <set>

#include "base/text/lower_case.h"
#include "pipeline/scan/foreign_text.h"
#include "pipeline/scan/formats/threemf/unit.h"
#include "pipeline/scan/formats/threemf/xml.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::threemf {
namespace {

constexpr std::string_view kUsualModel = "3d/3dmodel.model";

std::string part_name(std::string_view path) {
  if (path.starts_with('/')) path.remove_prefix(1);
  return lower_case(path);
}

std::string read_text(const ScanFile& file, const ZipArchive& archive, std::string_view part) {
  std::string text = archive.read(part);
  if (const char* const encoding = wide_encoding(text)) {
    throw file.error("the archive's part " + in_quotes(part) + " is text in " + encoding,
                     "XML in UTF-8; reading the package in a slicer and writing it again makes it so");
  }
  return text;
}

/// Of the package's relations the one that names its model.
std::string root_model(const ScanFile& file, const ZipArchive& archive) {
  constexpr std::string_view kRelations = "_rels/.rels";
  if (archive.has(kRelations)) {
    const std::string text = read_text(file, archive, kRelations);
    XmlTags tags(file, text);
    while (tags.next()) {
      if (!tags.opens() || tags.name() != "Relationship") continue;
      if (tags.value("Type").value_or("").ends_with("/3dmodel")) return part_name(tags.value("Target").value_or(""));
    }
  }
  return std::string(kUsualModel);
}

/// Twelve numbers: the rows of a matrix that rows of coordinates are multiplied with.
Eigen::Matrix4d parse_place(const XmlTags& tags) {
  Eigen::Matrix4d place = Eigen::Matrix4d::Identity();
  std::optional<std::string_view> text = tags.value("transform");
  if (!text) return place;
  for (int k = 0; k < 12; ++k) {
    const std::string_view word = take_word(*text);
    double value = 0.0;
    const char* const stop = parse_number(word.data(), word.data() + word.size(), value);
    if (word.empty() || stop != word.data() + word.size() || !std::isfinite(value)) {
      throw tags.error("a transform has no number " + std::to_string(k + 1), "twelve numbers");
    }
    place(k % 3, k / 3) = value;
  }
  if (!take_word(*text).empty()) throw tags.error("a transform has more than twelve numbers", "twelve numbers");
  return place;
}

/// Extensions that may be required: those that are read, and those that change no form.
constexpr std::array<std::string_view, 4> kKnown{"http://schemas.microsoft.com/3dmanufacturing/core/2015/02",
                                                 "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
                                                 "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
                                                 "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07"};

/// Without what a model requires, its meshes are no more than a part or a coarse stand-in of its objects.
void refuse_extensions(const XmlTags& tags) {
  std::string_view prefixes = tags.value("requiredextensions").value_or("");
  for (std::string_view prefix = take_word(prefixes); !prefix.empty(); prefix = take_word(prefixes)) {
    const std::optional<std::string_view> name = tags.namespace_of(prefix);
    if (name && std::find(kKnown.begin(), kKnown.end(), *name) != kKnown.end()) continue;
    constexpr std::string_view kCommon = "/3dmanufacturing/";
    const std::size_t own = name ? name->find(kCommon) : std::string_view::npos;
    throw tags.error(
        "the model requires the extension " + in_quotes(prefix) +
            (!name                           ? ", which it does not declare"
             : own == std::string_view::npos ? " (" + in_quotes(*name) + ")"
                                             : " (" + in_quotes(name->substr(own + kCommon.size())) + ")") +
            ", which is not known here",
        "a 3MF of plain meshes, or the mesh as STL, OBJ or PLY");
  }
}

/// Elements within an object that give it form and are of no extension that is read.
constexpr std::array<std::string_view, 5> kForms{"beam", "ball", "boolean", "displacementmesh", "levelset"};

std::uint32_t parse_vertex_number(const XmlTags& tags, std::string_view name) {
  const double value = tags.number(name);
  constexpr double kMost = 4294967294.0;
  if (!(value >= 0.0) || value > kMost || value != std::floor(value)) {
    throw tags.error("a triangle's " + in_quotes(name) + " is no number of a vertex", "0 and more");
  }
  return static_cast<std::uint32_t>(value);
}

class Reader {
 public:
  Reader(const ScanFile& file, const ZipArchive& archive) : file_(file), archive_(archive) {}

  Package read() {
    const std::string root = root_model(file_, archive_);
    add_part(root);
    while (!parts_.empty()) {
      const std::string part = parts_.front();
      parts_.pop_front();
      file_.throw_if_cancelled();
      read_model(part, part == root);
    }
    return std::move(package_);
  }

 private:
  void add_part(const std::string& part) {
    if (seen_.insert(part).second) parts_.push_back(part);
  }

  Use parse_use(const XmlTags& tags, const std::string& part) {
    Use use;
    const std::optional<std::string_view> path = tags.value("path");
    use.object = {path ? part_name(*path) : part, std::string(tags.value("objectid").value_or(""))};
    use.place = parse_place(tags);
    if (path) add_part(use.object.first);
    return use;
  }

  void read_model(const std::string& part, bool root) {
    const std::string text = read_text(file_, archive_, part);
    package_.bytes += text.size();
    XmlTags tags(file_, text);
    Object* object = nullptr;
    bool model = false, whole = false;
    while (tags.next()) {
      if (!tags.opens()) {
        if (tags.name() == "object") object = nullptr;
        if (tags.name() == "model") whole = true;
        continue;
      }
      if (tags.name() == "model") {
        model = true;
        whole = tags.closes();
        refuse_extensions(tags);
        take_unit(tags, part, root);
      } else if (tags.name() == "object") {
        object = begin_object(tags, part);
        if (tags.closes()) object = nullptr;
      } else if (tags.name() == "item" && root) {
        package_.items.push_back(parse_use(tags, part));
      } else if (object != nullptr) {
        add_to(*object, tags, part);
      }
      package_.coloured = package_.coloured || tags.name() == "basematerials" || tags.name() == "colorgroup" ||
                          tags.name() == "texture2dgroup";
    }
    if (!model) throw tags.error("the part " + in_quotes(part) + " is no 3MF model", "an element 'model'");
    if (!whole) throw tags.error("the text ends within the model", "a complete file");
  }

  /// The model's unit is that of its own part. Parts that differ are brought to the unit of the first.
  void take_unit(const XmlTags& tags, const std::string& part, bool root) {
    const std::optional<std::string_view> stated = tags.value("unit");
    if (root && stated) package_.unit = *stated;
    scale_ = 1.0;
    const std::string unit(stated.value_or(package_.unit));
    if (root || unit == package_.unit) return;
    scale_ = unit_of(file_, unit).millimetres / unit_of(file_, package_.unit).millimetres;
    package_.warnings.push_back("the part " + in_quotes(part) + " is in the unit " + unit + ", the model in " +
                                package_.unit + ": its coordinates are converted");
  }

  Object* begin_object(const XmlTags& tags, const std::string& part) {
    const ObjectKey key{part, std::string(tags.value("id").value_or(""))};
    const auto [place, added] = package_.objects.try_emplace(key);
    if (!added) throw tags.error("the object " + in_quotes(key.second) + " is there twice", "each number once");
    const std::string_view type = tags.value("type").value_or("model");
    place->second.support = type == "support" || type == "solidsupport";
    return &place->second;
  }

  void add_to(Object& object, const XmlTags& tags, const std::string& part) {
    if (tags.name() == "vertex") {
      object.vertices.emplace_back(scale_ * Eigen::Vector3d(tags.number("x"), tags.number("y"), tags.number("z")));
    } else if (tags.name() == "triangle") {
      object.triangles.push_back(
          {parse_vertex_number(tags, "v1"), parse_vertex_number(tags, "v2"), parse_vertex_number(tags, "v3")});
    } else if (tags.name() == "component") {
      object.components.push_back(parse_use(tags, part));
      object.components.back().place.topRightCorner<3, 1>() *= scale_;
    } else if (std::find(kForms.begin(), kForms.end(), tags.name()) != kForms.end()) {
      ++package_.unread[std::string(tags.name())];
    }
  }

  const ScanFile& file_;
  const ZipArchive& archive_;
  Package package_;
  std::set<std::string> seen_;
  std::deque<std::string> parts_;
  double scale_ = 1.0;  ///< of the part's unit in the model's
};

}  // namespace

Package read_package(const ScanFile& file, const ZipArchive& archive) { return Reader(file, archive).read(); }

}  // namespace sparsha::pipeline::threemf
