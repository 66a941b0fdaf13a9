// The version of Sparsha, in one place: CMake reads it here. Semantic versioning (https://semver.org): while the first
// number is 0, a change of the second may break programs.
#pragma once

#define SPARSHA_VERSION_MAJOR 0
#define SPARSHA_VERSION_MINOR 1
#define SPARSHA_VERSION_PATCH 0

/// Grows with every version: 1000000 * major + 1000 * minor + patch. For #if.
#define SPARSHA_VERSION_NUMBER (1000000 * SPARSHA_VERSION_MAJOR + 1000 * SPARSHA_VERSION_MINOR + SPARSHA_VERSION_PATCH)

namespace sparsha {

/// The version of these headers. Any thread, no cost.
struct Version {
  int major = SPARSHA_VERSION_MAJOR;
  int minor = SPARSHA_VERSION_MINOR;
  int patch = SPARSHA_VERSION_PATCH;
};

}  // namespace sparsha
