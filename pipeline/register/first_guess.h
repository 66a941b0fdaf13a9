// Poses of scans that have none, from their surfaces' features.
#pragma once

#include <vector>

#include "base/threads/context.h"
#include "pipeline/register/posed_scan.h"
#include "pipeline/register/register.h"
#include "scene/config/registration.h"

namespace sparsha::pipeline {

/// Sets the poses of all scans but the first. Throws Error{input} naming a scan whose place is not found, or not for
/// sure; Cancelled. The result does not depend on the number of threads, nor on what is taken from `finished`, which
/// may be null.
[[nodiscard]] std::vector<FirstGuess> guess_poses(PosedScans& scans, const scene::RegisterConfig& config,
                                                  const Context& context, FinishedPairs* finished);

}  // namespace sparsha::pipeline
