// The section plane: where it begins, and its steps.
#include <numbers>

#include <Eigen/Geometry>

#include "viewer/marks/marking.h"

namespace sparsha::viewer {
namespace {

using Priority = haptics::Announcement::Priority;

}  // namespace

void Marking::switch_section(const Eigen::Vector3d& centre_m) {
  auto& section = marks_.notes.section;
  if (section) {
    section.reset();
  } else {
    section.emplace();
    section->at_m = centre_m;
    // Along the newest profile, if there is one: the stone is cut where it was measured.
    const auto& measures = marks_.notes.measures;
    if (!measures.empty() && measures.back().kind == Measure::Kind::profile) {
      const Eigen::Vector3d along = measures.back().points_m[1] - measures.back().points_m[0];
      Eigen::Vector3d out(along.y(), -along.x(), 0.0);
      if (out.norm() > 1e-12) {
        section->at_m = measures.back().points_m[0];
        section->out = (out.y() > 0.0 ? Eigen::Vector3d(-out) : out).normalized();
      }
    }
  }
  tell_(section ? "Section plane on" : "Section plane off", Priority::information);
  save();
}

bool Marking::move_section(Action action, double width_m) {
  auto& section = marks_.notes.section;
  if (!section) {
    tell_("There is no section plane", Priority::information);
    return true;
  }
  constexpr double kStep = 0.02;  // window widths
  constexpr double kTurn_rad = std::numbers::pi / 12.0;
  if (action == Action::section_turn)
    section->out = Eigen::AngleAxisd(kTurn_rad, Eigen::Vector3d::UnitZ()) * section->out;
  else
    section->at_m += (action == Action::section_near ? kStep : -kStep) * width_m * section->out;
  save();
  return true;
}

}  // namespace sparsha::viewer
