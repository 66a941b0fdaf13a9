// What stands where a scan's file is named: a folder and a shell's pattern are no files, and the error says what to
// write instead.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sparsha::pipeline {

/// Throws Error{input} for a folder, with the scans in it by name, and for a shell's pattern that is no file's name.
void require_file_name(const std::filesystem::path& file);

/// What to write for a folder: the first files in it that have a scan's ending, and how many there are; empty where
/// there are none.
[[nodiscard]] std::string scans_in(const std::filesystem::path& folder);

/// True for a file whose name has the ending of some format of scans; it need not be there.
[[nodiscard]] bool has_ending_of_scan(const std::filesystem::path& file);

/// Scans as an error names them that is about all of them together: the first three, and how many more.
[[nodiscard]] std::string names_together(const std::vector<std::string>& files);

}  // namespace sparsha::pipeline
