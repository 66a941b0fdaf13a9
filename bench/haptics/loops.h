#pragma once

#include <filesystem>
#include <vector>

namespace sparsha::bench {

/// Random hands (mass, damping, grip, press, undeclared delay, encoder) rest on and stroke random windows of scenes and
/// formulas: energy delivered, and swing of those that rest. Prints quantiles and the worst.
bool write_loops(const std::vector<std::filesystem::path>& scenes, int loops);

}  // namespace sparsha::bench
