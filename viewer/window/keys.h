// Keys of a keyboard of any layout to those that actions are bound to.
#pragma once

namespace sparsha::viewer {

/// `glfw_key`: the place of the key, named as on a US keyboard; `name`: what the layout prints on it, or null. A digit
/// that `bound` knows is told by its place (AZERTY has no unshifted digits), letters by their names, other characters
/// by their names where these are bound, else by their place: brackets are keys on few keyboards. So are all keys of
/// other alphabets. 0 for keys without a meaning here.
[[nodiscard]] int key_of(int glfw_key, const char* name, bool (*bound)(int key));

}  // namespace sparsha::viewer
