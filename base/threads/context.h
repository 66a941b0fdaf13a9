// What long work is given: threads to share it out to, and where to report.
#pragma once

#include "base/threads/progress.h"
#include "base/threads/thread_pool.h"

namespace sparsha {

/// Both outlive the work.
struct Context {
  ThreadPool& pool;
  Progress& progress;
};

}  // namespace sparsha
