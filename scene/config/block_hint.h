// A key that stands at the top of a configuration though it belongs into a block.
#pragma once

#include <span>
#include <string_view>

#include "base/yaml.h"

namespace sparsha::scene {

/// "block.key" of keys whose name is in one block alone.
[[nodiscard]] std::span<const std::string_view> keys_of_one_block() noexcept;

/// Throws Error{usage} with the place and the path of the first key of `root` that is one of these without its block.
void refuse_keys_without_block(const yaml::Node& root);

}  // namespace sparsha::scene
