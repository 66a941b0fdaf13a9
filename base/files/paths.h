// Names of files that lead where the system would go, through symbolic links too.
#pragma once

#include <filesystem>

namespace sparsha {

/// `path` without '.' and '..', absolute or relative as it was. '..' behind a symbolic link is where the system goes,
/// the folder of what the link points to; other links keep their names. Files need not be there.
[[nodiscard]] std::filesystem::path without_dots(const std::filesystem::path& path);

/// Throws Error{usage} where the system takes no name as long as that of `output`, the place of something to be
/// written.
void require_possible_name(const std::filesystem::path& output);

/// `file` as it is found from `folder`, by whichever name the folder is reached: relative to the folder, or absolute
/// where there is no such way. Both are relative to the present folder; an empty `folder` is that one.
[[nodiscard]] std::filesystem::path path_from(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace sparsha
