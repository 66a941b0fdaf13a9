#include "bench/peers/embree.h"

#include <stdexcept>

#ifdef SPARSHA_HAVE_EMBREE
#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <vector>

#include "bench/peers/triangle_tree.h"
#endif

namespace sparsha::bench {

#ifdef SPARSHA_HAVE_EMBREE
namespace {

using Eigen::Vector3d;

class Embree : public Peer {
 public:
  explicit Embree(const haptics::MongeSurface& surface) : surface_(surface), device_(rtcNewDevice("threads=1")) {
    if (device_ == nullptr) throw std::runtime_error("Embree gives no device");
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const int nx = surface.lattice.nx, ny = surface.lattice.ny;
    vertices_ = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                            3 * sizeof(float), surface.lattice.count()));
    triangle_count_ = 2 * static_cast<std::size_t>(nx - 1) * static_cast<std::size_t>(ny - 1);
    triangles_ = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                3 * sizeof(unsigned), triangle_count_));
    if (vertices_ == nullptr || triangles_ == nullptr) throw std::runtime_error("Embree gives no memory");
    fill(nx, ny);
    rtcSetGeometryPointQueryFunction(geometry, closest);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree cannot build its tree");
  }
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  void place(const Vector3d&) override {}
  Touched update(const Vector3d& hand) override {
    Touched touched;
    touched.proxy = hand;
    if (!hand.allFinite()) return touched;
    if (!(hand.z() < surface_.height(hand.x(), hand.y()))) return touched;
    hand_ = hand;
    best_squared_ = std::numeric_limits<double>::max();
    RTCPointQuery query{};
    query.x = static_cast<float>(hand.x());
    query.y = static_cast<float>(hand.y());
    query.z = static_cast<float>(hand.z());
    // The point of the surface above the hand is on the mesh or a bilinear cell's twist away from it.
    query.radius = 2.0F * static_cast<float>(surface_.height(hand.x(), hand.y()) - hand.z()) +
                   static_cast<float>(surface_.lattice.spacing_m);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &query, &context, nullptr, this);
    if (best_squared_ == std::numeric_limits<double>::max()) return touched;
    touched.contact = true;
    touched.proxy = best_;
    touched.force_m = best_ - hand;
    return touched;
  }
  /// Vertices and triangles; Embree does not say what its tree takes.
  [[nodiscard]] std::size_t bytes() const override {
    return surface_.lattice.count() * 3 * sizeof(float) + triangle_count_ * 3 * sizeof(unsigned);
  }

 private:
  void fill(int nx, int ny) {
    const double spacing = surface_.lattice.spacing_m;
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const std::size_t node = surface_.lattice.index(i, j);
        vertices_[3 * node] = static_cast<float>(i * spacing);
        vertices_[3 * node + 1] = static_cast<float>(j * spacing);
        vertices_[3 * node + 2] = surface_.height_m[node];
      }
    unsigned* next = triangles_;
    for (int j = 0; j + 1 < ny; ++j)
      for (int i = 0; i + 1 < nx; ++i) {
        const auto node = static_cast<unsigned>(j * nx + i);
        const auto above = node + static_cast<unsigned>(nx);
        for (const unsigned corner : {node, node + 1, above, node + 1, above + 1, above}) *next++ = corner;
      }
  }
  [[nodiscard]] Vector3d vertex(unsigned node) const {
    return {static_cast<double>(vertices_[3 * node]), static_cast<double>(vertices_[3 * node + 1]),
            static_cast<double>(vertices_[3 * node + 2])};
  }
  static bool closest(RTCPointQueryFunctionArguments* arguments) {
    auto& self = *static_cast<Embree*>(arguments->userPtr);
    const unsigned* corners = self.triangles_ + 3 * static_cast<std::size_t>(arguments->primID);
    const Vector3d point =
        closest_point(self.hand_, self.vertex(corners[0]), self.vertex(corners[1]), self.vertex(corners[2]));
    const double squared = (point - self.hand_).squaredNorm();
    if (!(squared < self.best_squared_)) return false;
    self.best_squared_ = squared;
    self.best_ = point;
    const auto radius = static_cast<float>(std::sqrt(squared));
    if (!(radius < arguments->query->radius)) return false;
    arguments->query->radius = radius;
    return true;
  }

  const haptics::MongeSurface surface_;
  RTCDevice device_;
  RTCScene scene_ = nullptr;
  float* vertices_ = nullptr;
  unsigned* triangles_ = nullptr;
  std::size_t triangle_count_ = 0;
  Vector3d hand_ = Vector3d::Zero();
  Vector3d best_ = Vector3d::Zero();
  double best_squared_ = 0.0;
};

}  // namespace

bool has_embree() { return true; }
PeerPointer make_embree(const haptics::MongeSurface& surface) { return std::make_unique<Embree>(surface); }
#else
bool has_embree() { return false; }
PeerPointer make_embree(const haptics::MongeSurface&) { throw std::runtime_error("built without Embree"); }
#endif

}  // namespace sparsha::bench
