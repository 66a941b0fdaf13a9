// report.html: one page that needs nothing but itself.
#pragma once

#include <string>
#include <vector>

#include "pipeline/report/images.h"
#include "pipeline/report/report.h"

namespace sparsha::pipeline {

/// `encoded` holds the pictures' PNG bytes. The page loads nothing from anywhere and runs no script.
[[nodiscard]] std::string report_html(const scene::Scene& scene, const Report& report,
                                      const std::vector<Picture>& pictures, const std::vector<std::string>& encoded);

}  // namespace sparsha::pipeline
