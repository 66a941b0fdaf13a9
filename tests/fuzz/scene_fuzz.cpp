// Any bytes as scene.yaml beside a small real layer: a scene that can be read, or an Error.
#include <vector>

#include "base/error.h"
#include "scene/folder/layer_file.h"
#include "scene/scene.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sparsha::scene;
  const auto file = sparsha::fuzz::as_file(data, size, "scene.yaml");
  const auto level = file.parent_path() / "level-0";
  static const bool prepared = [&] {
    std::filesystem::create_directories(level);
    const std::vector<float> heights(16, 0.5F);
    const std::vector<std::uint8_t> mask(16, 1);
    write_layer(level / "height.tif", 4, 4, std::span<const float>(heights));
    write_layer(level / "mask.tif", 4, 4, std::span<const std::uint8_t>(mask));
    return true;
  }();
  static_cast<void>(prepared);
  try {
    (void)open_scene(file.parent_path())->read(0, -1, -1, 8, 8);
  } catch (const sparsha::Error&) {
  }
  return 0;
}
