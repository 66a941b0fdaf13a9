// Results as complete sentences, one a line, for speech and braille (--plain).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "haptics/session/session.h"
#include "pipeline/build/build.h"

namespace sparsha::app {

/// "1 contact", "2 contacts".
[[nodiscard]] std::string counted(std::uint64_t count, const char* one, const char* several);
/// "12 percent".
[[nodiscard]] std::string percent(double share);
/// Down to micrometres, in whole words.
[[nodiscard]] std::string exact_length(double metres);

/// What a run of `explore` amounted to.
[[nodiscard]] std::string summary_sentences(const haptics::SessionSummary& summary, std::uint64_t strikes);
/// What a scene was built of and how good it is.
[[nodiscard]] std::string build_sentences(const scene::Scene& scene, const pipeline::Report& report,
                                          const std::filesystem::path& folder);
/// "The step read is 40 percent done, and about 3 seconds are left."
[[nodiscard]] std::string progress_sentence(const std::string& stage, double fraction, double left_s);

}  // namespace sparsha::app
