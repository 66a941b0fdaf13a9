#include "viewer/window/keys.h"

#include <cctype>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/actions/actions.h"

namespace sparsha::viewer {
namespace {

/// Keys without a character; 0 for others.
int named_key(int glfw_key) {
  if (glfw_key >= GLFW_KEY_F1 && glfw_key <= GLFW_KEY_F12) return key::kF1 + glfw_key - GLFW_KEY_F1;
  switch (glfw_key) {
    case GLFW_KEY_LEFT:
      return key::kLeft;
    case GLFW_KEY_RIGHT:
      return key::kRight;
    case GLFW_KEY_UP:
      return key::kUp;
    case GLFW_KEY_DOWN:
      return key::kDown;
    case GLFW_KEY_PAGE_UP:
      return key::kPageUp;
    case GLFW_KEY_PAGE_DOWN:
      return key::kPageDown;
    case GLFW_KEY_HOME:
      return key::kHome;
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
      return key::kEnter;
    case GLFW_KEY_ESCAPE:
      return key::kEscape;
    case GLFW_KEY_TAB:
      return key::kTab;
    case GLFW_KEY_DELETE:
      return key::kDelete;
    case GLFW_KEY_BACKSPACE:
      return key::kBackspace;
    case GLFW_KEY_SPACE:
      return ' ';
    case GLFW_KEY_KP_ADD:
      return '+';
    case GLFW_KEY_KP_SUBTRACT:
      return '-';
    default:
      return 0;
  }
}

}  // namespace

int key_of(int glfw_key, const char* name, bool (*bound)(int key)) {
  if (const int named = named_key(glfw_key); named != 0) return named;
  const bool printable = glfw_key > GLFW_KEY_SPACE && glfw_key <= GLFW_KEY_GRAVE_ACCENT;  // its code is its character
  if (glfw_key >= GLFW_KEY_0 && glfw_key <= GLFW_KEY_9 && bound(glfw_key)) return glfw_key;
  const bool one_byte = name != nullptr && name[0] != '\0' && name[1] == '\0';
  if (!one_byte) return printable ? glfw_key : 0;
  const int character = std::toupper(static_cast<unsigned char>(name[0]));
  // The place of a letter is never meant by another character: it may be Q, which leaves.
  const bool by_place = printable && std::isalpha(glfw_key) == 0 && std::isalpha(character) == 0 && !bound(character);
  return by_place ? glfw_key : character;
}

}  // namespace sparsha::viewer
