#if defined(SPARSHA_HAVE_UMOCKDEV)
#include "emulator/umockdev_library.h"

#include "base/error.h"
#include "base/system/library.h"

namespace sparsha::emulator {
namespace {

template <typename Function>
void find(void* library, Function& function, const char* name) {
  function = reinterpret_cast<Function>(system::symbol(library, name));
  if (function == nullptr)
    throw Error(ErrorKind::device, {}, std::string("umockdev has no ") + name, "umockdev 0.17 or later");
}

Umockdev load() {
  void* const library = system::load_library("libumockdev.so.0");
  if (library == nullptr)
    throw Error(ErrorKind::device, {}, "no emulated USB bus: umockdev is not installed",
                "Debian's packages umockdev and libumockdev0");
  Umockdev table{};
  find(library, table.testbed_new, "umockdev_testbed_new");
  find(library, table.add_from_string, "umockdev_testbed_add_from_string");
  find(library, table.remove_device, "umockdev_testbed_remove_device");
  find(library, table.uevent, "umockdev_testbed_uevent");
  find(library, table.attach_ioctl, "umockdev_testbed_attach_ioctl");
  find(library, table.detach_ioctl, "umockdev_testbed_detach_ioctl");
  find(library, table.ioctl_base_new, "umockdev_ioctl_base_new");
  find(library, table.get_request, "umockdev_ioctl_client_get_request");
  find(library, table.get_arg, "umockdev_ioctl_client_get_arg");
  find(library, table.complete, "umockdev_ioctl_client_complete");
  find(library, table.resolve, "umockdev_ioctl_data_resolve");
  find(library, table.set_ptr, "umockdev_ioctl_data_set_ptr");
  find(library, table.ref, "umockdev_ioctl_data_ref");
  find(library, table.unref, "umockdev_ioctl_data_unref");
  find(library, table.object_ref, "g_object_ref");
  find(library, table.object_unref, "g_object_unref");
  find(library, table.weak_ref, "g_object_weak_ref");
  find(library, table.signal_connect, "g_signal_connect_data");
  return table;
}

}  // namespace

const Umockdev& umockdev() {
  static const Umockdev table = load();
  return table;
}

}  // namespace sparsha::emulator
#endif
