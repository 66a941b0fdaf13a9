#include "haptics/surface/large_pages.h"

#include "base/system.h"

namespace sparsha::haptics {

std::vector<float> reserve_large(std::size_t count) {
  std::vector<float> values;
  values.reserve(count);
  system::advise_large_pages(values.data(), count * sizeof(float));
  return values;
}

}  // namespace sparsha::haptics
