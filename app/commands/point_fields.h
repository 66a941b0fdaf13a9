// What `sparsha info` says of the numbers that points have beside their places.
#pragma once

#include <string>

#include "pipeline/scan/fields.h"

namespace sparsha::app {

/// False for what is the same for all points: formats have room for much that programs leave at 0.
[[nodiscard]] bool is_worth_showing(const pipeline::FieldTally& tally);
/// "0: 30.5 %, 2: 69.5 %" of few whole numbers, with the names of LAS classes; else "0.1 to 3.5, median 1.2".
/// `percent`: the word behind a share.
[[nodiscard]] std::string field_words(const pipeline::FieldTally& tally, const char* percent = " %");

}  // namespace sparsha::app
