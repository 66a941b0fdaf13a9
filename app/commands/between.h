// A check of numbers on the command line.
#pragma once

namespace CLI {
class Validator;
}

namespace sparsha::app {

/// A number from `least` to `most`. Unlike CLI::Range it refuses "nan".
[[nodiscard]] CLI::Validator between(double least, double most);

}  // namespace sparsha::app
