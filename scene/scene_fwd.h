// Names of scene/scene.h and scene/config/config.h for those who pass scenes on and do not look into them.
#pragma once

#include <memory>

namespace sparsha::scene {

struct Config;
class Scene;
struct ScanSource;
struct SceneDescription;
using ScenePointer = std::shared_ptr<const Scene>;

/// Which files a scene folder may name as its clips and layers.
enum class Trust { own_folder, any_file };

}  // namespace sparsha::scene
