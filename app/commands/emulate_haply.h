// `sparsha device emulate --device haply`.
#pragma once

#include <string>
#include <vector>

#include "app/commands/commands.h"
#include "emulator/person.h"

namespace sparsha::app {

struct HaplyEmulation {
  std::vector<std::string> faults;
  std::string log;  ///< CSV of all messages; empty: none
  emulator::PersonOptions person;
};

/// "name: what it is", one a line.
[[nodiscard]] std::string haply_faults();
/// Runs a program beside an emulated Inverse Service, on the ports that the real one has, or those of
/// SPARSHA_HAPLY_PORT and SPARSHA_HAPLY_EVENTS_PORT. The program's exit code. Throws Error{usage} for another fault,
/// Error{failure} where a port is taken.
int emulate_haply(const HaplyEmulation& emulation, const CommonOptions& common);

}  // namespace sparsha::app
