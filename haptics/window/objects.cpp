#include "haptics/window/objects.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/error.h"
#include "haptics/around/object_surface.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace {

using ObjectPointer = std::shared_ptr<const ObjectSurface>;

/// The objects that windows hold now: a nearer view of an object needs no second one.
class HeldObjects {
 public:
  ObjectPointer of(const std::shared_ptr<const scene::Charts>& charts, const AroundFriction& friction) {
    const std::lock_guard lock(mutex_);
    std::erase_if(held_, [](const Held& held) { return held.object.expired(); });
    for (const Held& held : held_) {
      ObjectPointer object = held.object.lock();
      if (object && object->charts == charts && held.friction.mu_dynamic == friction.mu_dynamic &&
          held.friction.mu_static == friction.mu_static)
        return object;
    }
    ObjectPointer object = make_object_surface(*charts, friction, charts);
    held_.push_back({object, friction});
    return object;
  }

 private:
  struct Held {
    std::weak_ptr<const ObjectSurface> object;
    AroundFriction friction;
  };
  std::mutex mutex_;
  std::vector<Held> held_;
};

/// Keeps an object for a window's surface.
struct WithObject {
  SurfacePointer surface;
  ObjectPointer object;
};

}  // namespace

AroundFriction around_friction(const scene::SceneDescription& scene, bool friction) {
  if (!scene.config.friction || !friction) return {};
  const scene::FrictionConfig& law = *scene.config.friction;
  const double mu_dynamic = std::clamp(law.mu_0, 0.0, law.mu_max);
  return {mu_dynamic, std::max(law.mu_static, mu_dynamic)};
}

void attach_object(HapticWindow& window, const scene::SceneDescription& scene) {
  static HeldObjects objects;
  if (!scene.charts) throw Error(ErrorKind::failure, {}, "a whole object without charts", "a scene built with around");
  const AroundFriction friction = around_friction(scene, window.effects.friction);
  auto kept = std::make_shared<WithObject>(WithObject{std::move(window.surface), objects.of(scene.charts, friction)});
  window.object = kept->object.get();
  const MongeSurface* const surface = kept->surface.get();
  window.surface = SurfacePointer(std::move(kept), surface);
}

}  // namespace sparsha::haptics
