// User studies: the visitor's rating and the session's figures, one row a session.
#pragma once

#include <filesystem>
#include <string>

#include "haptics/session/session.h"

namespace sparsha::app {

/// NAME.csv; empty without a name.
[[nodiscard]] std::filesystem::path study_file(const std::string& name);
/// Throws Error{usage} when NAME cannot be a file's name or NAME.csv is something else than a study; "" is none.
void check_study(const std::string& name);
/// Asks on the terminal how real it felt, 1 to 10. 0 without an answer: after Enter or three wrong ones, once the user
/// asks to stop, and at once where nobody can be asked: without a terminal, or when another signal than Ctrl-C's has
/// ended the session.
[[nodiscard]] int ask_realism();
/// Appends one row to NAME.csv, with a header when it is new; several programs may do so at once. Throws
/// Error{failure}.
void append_study(const std::string& name, const haptics::SessionSummary& summary, int realism);

}  // namespace sparsha::app
