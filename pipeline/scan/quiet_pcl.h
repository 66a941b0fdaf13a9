// PCL without its messages.
#pragma once

namespace sparsha::pipeline {

/// While one exists, on any thread, PCL prints nothing: what it would say is an error or a warning of ours, or no error
/// here.
class QuietPcl {
 public:
  QuietPcl();
  ~QuietPcl();
  QuietPcl(const QuietPcl&) = delete;
  QuietPcl& operator=(const QuietPcl&) = delete;
};

}  // namespace sparsha::pipeline
