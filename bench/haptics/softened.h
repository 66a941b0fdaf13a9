#pragma once

namespace sparsha::bench {

/// What the account of a later loop costs: hands in loops that are as they say stroke six gratings; prints the least
/// stiffness that is left of the wished one for each delay that the device leaves undeclared.
bool write_softened();

}  // namespace sparsha::bench
