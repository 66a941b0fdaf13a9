// A key that stands at the top of a configuration though it belongs into a block.
#pragma once

#include <span>
#include <string_view>

#include "base/yaml/yaml.h"

namespace sparsha::scene {

/// "block.key" of keys whose name is in one block alone.
[[nodiscard]] std::span<const std::string_view> keys_of_one_block() noexcept;

/// Throws Error{usage} on the first key of `root` that `reader` was not asked for, with the path of the key of a block
/// that it is or is near to.
void finish_root(const yaml::MapReader& reader, const yaml::Node& root);

}  // namespace sparsha::scene
