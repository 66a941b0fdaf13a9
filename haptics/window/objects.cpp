#include "haptics/window/objects.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/error.h"
#include "haptics/around/object_surface.h"
#include "scene/area/regions.h"
#include "scene/material/friction_law.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace {

using ObjectPointer = std::shared_ptr<const ObjectSurface>;

constexpr double kWorkspace_m = 0.1;  // that shows the whole object: borders of parts are as wide as under that hand

/// What two objects of the same charts differ by.
struct Look {
  bool texture = true;
  std::vector<double> friction{};          // numbers of the law and of parts; empty: frictionless
  std::vector<scene::Area> rough_parts{};  // that have friction of their own

  bool operator==(const Look& other) const = default;
};

Look look_of(const scene::SceneDescription& scene, const Effects& effects) {
  Look look{effects.texture || !has_envelope(*scene.charts)};
  if (!scene.config.friction || !effects.friction) return look;
  const scene::FrictionConfig& law = *scene.config.friction;
  look.friction = {static_cast<double>(law.law), law.mu_static, law.mu_0, law.mu_max, scene.friction_c_m};
  for (std::size_t part = 0; part < scene.config.parts.size(); ++part) {
    const scene::PartTouch& touch = scene.config.parts[part].touch;
    if (!touch.mu_dynamic) continue;
    look.rough_parts.push_back(scene::area_of(scene, part));
    look.friction.insert(look.friction.end(), {*touch.mu_dynamic, touch.mu_static.value_or(-1.0)});
  }
  return look;
}

ObjectPointer make_object(const scene::SceneDescription& scene, const Look& look, const ObjectSurface* like = nullptr) {
  AroundFriction friction;
  const scene::Charts& charts = *scene.charts;
  std::optional<scene::FrictionLaw> law;
  if (!look.friction.empty()) {
    law.emplace(scene, kWorkspace_m / std::max(box_of(charts).sizes().maxCoeff(), charts.spacing_m), kWorkspace_m);
    friction.mu_dynamic = std::clamp(scene.config.friction->mu_0, 0.0, scene.config.friction->mu_max);
    friction.mu_static = std::max(scene.config.friction->mu_static, friction.mu_dynamic);
    friction.at = [&](const Eigen::Vector3d& object_m, double curvature_per_m) -> std::array<float, 2> {
      const auto mu = law->at(charts.origin_m + object_m, curvature_per_m);
      return {mu.mu_dynamic, mu.mu_static};
    };
  }
  return make_object_surface(charts, friction, scene.charts, look.texture, like);
}

/// The objects that windows hold now: a nearer view of an object needs no second one.
class HeldObjects {
 public:
  ObjectPointer of(const scene::SceneDescription& scene, const Effects& effects) {
    Look look = look_of(scene, effects);
    const std::lock_guard lock(mutex_);
    std::erase_if(held_, [](const Held& held) { return held.object.expired(); });
    ObjectPointer like;
    for (const Held& held : held_) {
      ObjectPointer object = held.object.lock();
      if (!object || object->charts != scene.charts) continue;
      if (held.look == look) return object;
      like = std::move(object);
    }
    ObjectPointer object = make_object(scene, look, like.get());
    held_.push_back({object, std::move(look)});
    return object;
  }

 private:
  struct Held {
    std::weak_ptr<const ObjectSurface> object;
    Look look;
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

std::shared_ptr<const ObjectSurface> whole_object(const scene::SceneDescription& scene, const Effects& effects) {
  if (!scene.charts) throw Error(ErrorKind::failure, {}, "a whole object without charts", "a scene built with around");
  return make_object(scene, look_of(scene, effects));
}

void attach_object(HapticWindow& window, const scene::SceneDescription& scene) {
  static HeldObjects objects;
  if (!scene.charts) throw Error(ErrorKind::failure, {}, "a whole object without charts", "a scene built with around");
  auto kept = std::make_shared<WithObject>(WithObject{std::move(window.surface), objects.of(scene, window.effects)});
  window.object = kept->object.get();
  const MongeSurface* const surface = kept->surface.get();
  window.surface = SurfacePointer(std::move(kept), surface);
}

}  // namespace sparsha::haptics
