#include "bench/peers/own.h"

#include <stdexcept>

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

class Own : public Peer {
 public:
  Own(const haptics::MongeSurface& surface, bool paper, const haptics::SolverOptions& options)
      : surface_(copy(surface)), options_(options), paper_(paper) {}
  void place(const Vector3d& hand) override { state_ = haptics::start_proxy(*surface_, hand); }
  Touched update(const Vector3d& hand) override {
    const haptics::ProxyUpdate found = paper_ ? haptics::update_paper(*surface_, hand, state_, options_)
                                              : haptics::update_exact(*surface_, hand, state_, options_);
    Touched touched;
    touched.proxy = found.position;
    touched.contact = found.contact;
    if (found.contact) touched.force_m = found.position - hand;
    return touched;
  }
  [[nodiscard]] std::size_t bytes() const override { return surface_->height_m.size() * sizeof(float); }

 private:
  /// From bare heights, so that what a window does before it can be touched counts.
  static std::shared_ptr<const haptics::MongeSurface> copy(const haptics::MongeSurface& surface) {
    haptics::SurfaceParts parts;
    parts.lattice = surface.lattice;
    parts.height_m = surface.height_m;
    return haptics::make_surface(std::move(parts));
  }

  std::shared_ptr<const haptics::MongeSurface> surface_;
  haptics::SolverOptions options_;
  bool paper_;
  haptics::ProxyState state_;
};

}  // namespace

PeerPointer make_own(const haptics::MongeSurface& surface, const std::string& method, haptics::SolverOptions options) {
  if (method == "exact")
    options.shape = haptics::CellShape::bilinear;
  else if (method == "rounded")
    options.shape = haptics::CellShape::rounded;
  else if (method == "c1")
    options.shape = haptics::CellShape::c1;
  else if (method != "paper")
    throw std::invalid_argument("unknown method " + method);
  return std::make_unique<Own>(surface, method == "paper", options);
}

}  // namespace sparsha::bench
