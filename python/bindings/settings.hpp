// What a configuration is made of, given as Python's dicts and lists.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/threads/progress.h"
#include "scene/config/config.h"

namespace sparsha::python {

/// As a text of a configuration that `yaml::parse_text` reads.
[[nodiscard]] std::string text_of(const pybind11::handle& value);
/// {"grid": {"size": 400}} as {"grid.size=400"}, as --set has it.
[[nodiscard]] std::vector<std::string> settings_of(const pybind11::dict& settings);
/// One path or a sequence of paths. Raises TypeError.
[[nodiscard]] std::vector<std::string> paths_of(const pybind11::handle& given, const char* name);

/// One path. Raises TypeError.
[[nodiscard]] std::string path_of(const pybind11::handle& given, const char* name);

/// A configuration in memory; paths in it are relative to the present folder.
[[nodiscard]] scene::Config config_of_text(const std::string& text, const std::vector<std::string>& settings);

}  // namespace sparsha::python
