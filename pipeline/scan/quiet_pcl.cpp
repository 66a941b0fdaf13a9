#include "pipeline/scan/quiet_pcl.h"

#include <pcl/console/print.h>

#include <mutex>

namespace sparsha::pipeline {
namespace {

// PCL knows one level for the whole process.
std::mutex mutex;
int present = 0;
pcl::console::VERBOSITY_LEVEL before = pcl::console::L_INFO;

}  // namespace

QuietPcl::QuietPcl() {
  const std::lock_guard lock(mutex);
  if (present++ > 0) return;
  before = pcl::console::getVerbosityLevel();
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
}

QuietPcl::~QuietPcl() {
  const std::lock_guard lock(mutex);
  if (--present == 0) pcl::console::setVerbosityLevel(before);
}

}  // namespace sparsha::pipeline
