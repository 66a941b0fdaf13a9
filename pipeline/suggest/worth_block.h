// What scans say of their points' worth, in a first configuration.
#pragma once

#include <string>
#include <vector>

#include "base/threads/progress.h"
#include "pipeline/scan/worth.h"

namespace sparsha::pipeline {

/// Filters that several scans of one object share, with reasons, and comments where nothing can be proposed.
class WorthBlock {
 public:
  /// Warns of what is left out. `file`: the scan's name.
  void add(const std::string& file, const std::vector<Worth>& worth, Progress& progress);
  /// Lines of YAML.
  [[nodiscard]] const std::string& comments() const { return comments_; }
  /// Items of `filters`, lines of YAML.
  [[nodiscard]] std::string filters() const;

 private:
  struct Proposed {
    Worth worth;
    std::string reason;
  };
  void add_filter(const Worth& worth, const std::string& reason);

  std::vector<Proposed> proposed_;
  std::string comments_;
};

}  // namespace sparsha::pipeline
