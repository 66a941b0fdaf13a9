#include "python/bindings/monitor.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "app/exploration/devices.h"
#include "base/error.h"
#include "haptics/conformance/each_sample.h"
#include "python/bindings/running.hpp"
#include "python/bindings/settings.hpp"

namespace sparsha::python {
namespace py = pybind11;

namespace {

struct Heard {
  std::string name;
  std::vector<double> time_s;
  std::vector<haptics::DeviceSample> samples;
};

Heard listen(const std::string& device, double seconds, Progress& progress) {
  haptics::DeviceRequest request;
  request.watch_only = true;
  request.stop = [&] { return progress.cancelled(); };
  const auto opened = app::make_device(device, std::move(request));
  Heard heard;
  heard.name = opened->info().name;
  haptics::each_sample(*opened, [&](const haptics::DeviceSample& sample, double time_s) {
    heard.time_s.push_back(time_s);
    heard.samples.push_back(sample);
    return time_s < seconds && !progress.cancelled();
  });
  opened->zero();
  progress.throw_if_cancelled();
  return heard;
}

template <typename Value, typename Get>
py::array_t<Value> column(const Heard& heard, const Get& get) {
  py::array_t<Value> values(static_cast<py::ssize_t>(heard.samples.size()));
  for (std::size_t n = 0; n < heard.samples.size(); ++n) values.mutable_data()[n] = get(heard.samples[n]);
  return values;
}

py::dict monitor(const std::string& device, double seconds, const py::object& progress) {
  if (!(seconds > 0.0 && seconds <= 3600.0))
    throw usage_error(fmt::format("seconds is {}", seconds), "above 0 to 3600");
  const Heard heard = run(progress, [&](Progress& told) { return listen(device, seconds, told); });
  const auto count = static_cast<py::ssize_t>(heard.samples.size());
  py::array_t<double> positions({count, py::ssize_t{3}});
  for (std::size_t n = 0; n < heard.samples.size(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      positions.mutable_data()[3 * n + static_cast<std::size_t>(axis)] = heard.samples[n].position_m[axis];
    }
  }
  py::dict told;
  told["name"] = str_of(heard.name);
  told["time"] = py::array_t<double>(count, heard.time_s.data());
  told["position"] = positions;
  told["buttons"] = column<std::uint64_t>(heard, [](const haptics::DeviceSample& s) { return s.buttons; });
  told["fresh"] = column<bool>(heard, [](const haptics::DeviceSample& s) { return s.fresh; });
  told["homed"] = column<bool>(heard, [](const haptics::DeviceSample& s) { return s.homed; });
  return told;
}

}  // namespace

void bind_monitor(py::module_& module) {
  module.def("monitor", &monitor, py::arg("device"), py::arg("seconds") = 1.0, py::kw_only(),
             py::arg("progress") = py::none(),
             R"(Listens to a haptic device a thousand times a second; the force is zero throughout.

device: as --device has it, e.g. "falcon", "simulated" or "plugin:FILE.so". seconds: above 0 to 3600.
Returns {"name": str, "time": (n,) seconds, "position": (n, 3) metres of the device frame, "buttons": (n,) bits,
"fresh": (n,) bool, False where the device said nothing new, "homed": (n,) bool}.
Raises DeviceError with what to do when it is missing or silent for a second; UsageError for another name;
KeyboardInterrupt.)");
}

}  // namespace sparsha::python
