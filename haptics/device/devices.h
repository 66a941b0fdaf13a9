// How devices are made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "haptics/device/device.h"
#include "haptics/shared/seqlock.h"
#include "haptics/shared/state.h"

namespace sparsha::haptics {

/// A simulated hand (docs/architecture.md, "Simulated hand") that does a seeded round of free space, approach, press,
/// stroke and lift: first touch within 3 s, at least 20 % of ticks in contact. `duration_s` 0 = for ever.
[[nodiscard]] std::unique_ptr<Device> make_simulated_device(std::uint64_t seed, double duration_s);

/// The hand is where the viewer's pointer is.
[[nodiscard]] std::unique_ptr<Device> make_pointer_device(std::shared_ptr<const Seqlock<PointerSample>> pointer);

/// Plays a recording (run.csv) tick by tick. Throws Error{input}.
[[nodiscard]] std::unique_ptr<Device> make_playback_device(const std::filesystem::path& recording);

}  // namespace sparsha::haptics
