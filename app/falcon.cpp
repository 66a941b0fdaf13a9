// Until the driver is in, a Falcon is never found, and asking for one says so.
#include "app/falcon.h"

#include "pipeline/base/error.h"

namespace sparsha::app {

std::unique_ptr<haptics::Device> open_falcon() {
  throw Error(ErrorKind::device, {}, "this version has no driver for the Novint Falcon yet",
              "--device pointer, simulated or playback:FILE");
}

std::unique_ptr<haptics::Device> find_falcon() { return nullptr; }

}  // namespace sparsha::app
