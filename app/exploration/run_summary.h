// What a run amounted to, for people and machines.
#pragma once

#include <cstdint>
#include <string>

#include "haptics/session/session.h"

namespace sparsha::app {

[[nodiscard]] std::string summary_text(const haptics::SessionSummary& summary, std::uint64_t strikes);
[[nodiscard]] std::string summary_json(const haptics::SessionSummary& summary, std::uint64_t strikes);

}  // namespace sparsha::app
