// Any text as a configuration: a Config that reads back from its own YAML, or an Error with a place.
#include <string_view>

#include "base/error.h"
#include "base/yaml/yaml.h"
#include "scene/config/config.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sparsha;
  try {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const scene::Config config = scene::parse_config(yaml::parse_text(text, "fuzz.yaml"), {});
    const std::string written = scene::to_yaml(config);
    const scene::Config again = scene::parse_config(yaml::parse_text(written, "again.yaml"), {});
    if (scene::to_yaml(again) != written) __builtin_trap();
  } catch (const Error& error) {
    if (error.place().file == "again.yaml") __builtin_trap();  // what we write we must read
  }
  return 0;
}
