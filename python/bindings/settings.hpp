// What a configuration is made of, given as Python's dicts and lists.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/threads/progress.h"
#include "scene/config/config.h"

namespace sparsha::python {

/// As a text of a configuration that `yaml::parse_text` reads.
[[nodiscard]] std::string text_of(const pybind11::handle& value);
/// {"grid": {"size": 400}} as {"grid.size=400"}, as --set has it.
[[nodiscard]] std::vector<std::string> settings_of(const pybind11::dict& settings);
/// The core's text for Python: bytes that are no UTF-8, as names of files may have, become lone surrogates, of which
/// os.fsencode() makes the same bytes again.
[[nodiscard]] pybind11::str str_of(std::string_view text);
/// The reverse. Raises UnicodeEncodeError for other lone surrogates.
[[nodiscard]] std::string bytes_of(const pybind11::handle& text);

/// What a sequence (collections.abc.Sequence) holds; nothing where `given` is a path or no sequence.
[[nodiscard]] std::optional<pybind11::list> items_of(const pybind11::handle& given);

/// One path or a sequence of paths, as os.fsencode() has them. Raises TypeError, UsageError for a NUL within.
[[nodiscard]] std::vector<std::string> paths_of(const pybind11::handle& given, const char* name);

/// One path. Raises TypeError, UsageError.
[[nodiscard]] std::string path_of(const pybind11::handle& given, const char* name);

/// How many threads are asked for, 0 to 1024 as of the program's --threads; 0: one a core. Raises TypeError,
/// UsageError.
[[nodiscard]] unsigned threads_of(const pybind11::handle& given);

/// A configuration in memory; paths in it are relative to the present folder.
[[nodiscard]] scene::Config config_of_text(const std::string& text, const std::vector<std::string>& settings);

}  // namespace sparsha::python
