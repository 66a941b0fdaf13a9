#include "app/raw_scans/open_scans.h"

#include <utility>

namespace sparsha::app {

void OpenScans::show(std::unique_ptr<DepthScans> scans) {
  before_.reset();
  shown_ = std::move(scans);
  shown_->set_most_points(most_points_);
}

void OpenScans::touch() {
  before_.reset();
  touched_before_ = std::exchange(touched_, shown_->status().work);
}

void OpenScans::touch(std::unique_ptr<DepthScans> scans) {
  before_ = std::exchange(shown_, std::move(scans));
  shown_->set_most_points(most_points_);
  touched_before_ = std::exchange(touched_, shown_->status().work);
  rounds_ = 0;
}

void OpenScans::go_back() {
  touched_ = touched_before_;
  if (before_) shown_ = std::move(before_);
}

void OpenScans::settle() {
  // The first round may have begun before the scene came.
  if (before_ && ++rounds_ > 1) before_.reset();
}

}  // namespace sparsha::app
