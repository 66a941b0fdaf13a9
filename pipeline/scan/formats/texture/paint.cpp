#include "pipeline/scan/formats/texture/paint.h"

#include "base/error.h"
#include "pipeline/scan/cloud.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {

std::uint32_t Paint::picture(const std::string& name, Wrap wrap) {
  const auto [place, added] = numbers_.try_emplace({name, wrap}, static_cast<std::uint32_t>(names_.size()));
  if (added) names_.push_back({name, wrap});
  return place->second;
}

void Paint::lay(std::uint64_t vertex, std::uint32_t picture, double u, double v) {
  if (vertex >= spots_.size()) spots_.resize(static_cast<std::size_t>(vertex) + 1);
  Spot& spot = spots_[static_cast<std::size_t>(vertex)];
  if (spot.picture == kNone) spot = {picture, static_cast<float>(u), static_cast<float>(v)};
}

void Paint::colour(const ScanFile& file, std::uint32_t number) {
  const std::string& name = names_[number].name;
  const std::unique_ptr<MappedFile> bytes = open_beside(file, name);
  const ColourPicture picture = decode_picture(bytes->text(), name);
  const Wrap wrap = names_[number].wrap;
  if (rgba_.empty()) rgba_.resize(spots_.size(), kNoColour);
  for (std::size_t k = 0; k < spots_.size(); ++k) {
    const Spot& spot = spots_[k];
    if (spot.picture != number) continue;
    Light light = sample(picture, static_cast<double>(spot.u), 1.0 - static_cast<double>(spot.v), wrap, wrap);
    light[3] = 1.0;
    rgba_[k] = colour_of(light);
    any_ = true;
    if ((k & 0xFFFFU) == 0) file.throw_if_cancelled();
  }
}

void Paint::dry(const ScanFile& file, std::vector<std::string>& warnings) {
  constexpr std::size_t kMostNamed = 8;
  std::vector<bool> used(names_.size());
  for (const Spot& spot : spots_)
    if (spot.picture != kNone) used[spot.picture] = true;
  std::size_t failed = 0;
  for (std::uint32_t number = 0; number < names_.size(); ++number) {
    if (!used[number]) continue;
    try {
      colour(file, number);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      if (++failed > kMostNamed) continue;
      const bool named = error.place().file == names_[number].name;
      warnings.push_back("a texture's colours are missing: " +
                         (named ? in_quotes(names_[number].name) + " is " + error.wrong() : error.wrong()));
    }
  }
  if (failed > kMostNamed)
    warnings.push_back("colours of " + std::to_string(failed - kMostNamed) + " more textures are missing");
  spots_ = {};
}

std::uint32_t Paint::operator[](std::uint64_t vertex) const {
  return vertex < rgba_.size() ? rgba_[static_cast<std::size_t>(vertex)] : kNoColour;
}

}  // namespace sparsha::pipeline
