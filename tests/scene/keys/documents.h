// The smallest configurations that hold one key with one value, made of the table of scene/keys, to be put to the
// readers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/config/config.h"
#include "scene/keys/keys.h"

namespace sparsha::scene::test {

/// Names and values of one block, as YAML.
using Fields = std::vector<std::pair<std::string, std::string>>;

/// A value of that form.
[[nodiscard]] std::string sample(const Key& key, const Form& form);
/// A value of the key's first form.
[[nodiscard]] std::string sample(const Key& key);

/// The configuration in which `block` ("" is the root) has these fields, and, there and around, what must be there.
[[nodiscard]] std::string document(std::string_view block, Fields fields, bool complete = true);
/// The same with one key, beside what it needs.
[[nodiscard]] std::string document(const Key& key, const std::string& value);
/// The same without the key.
[[nodiscard]] std::string document_without(const Key& key);
/// What the key needs at the root.
[[nodiscard]] std::string at_root(const Key& key);

/// What the reader says, or nothing when it takes the text.
[[nodiscard]] std::optional<Error> refusal(const std::string& text);
[[nodiscard]] Config parsed(const std::string& text);

}  // namespace sparsha::scene::test
