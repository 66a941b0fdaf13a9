// `sparsha device emulate`.
#pragma once

#include "app/commands/commands.h"

namespace sparsha::app {

void add_emulate(Command device, const CommonOptions& common, Run& run);

}  // namespace sparsha::app
