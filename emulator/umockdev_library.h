// umockdev and what it needs of GLib, found when the program asks for an emulated bus: no other start of it pays for
// them.
#pragma once

#include <umockdev.h>

namespace sparsha::emulator {

struct Umockdev {
  decltype(&::umockdev_testbed_new) testbed_new;
  decltype(&::umockdev_testbed_add_from_string) add_from_string;
  decltype(&::umockdev_testbed_remove_device) remove_device;
  decltype(&::umockdev_testbed_uevent) uevent;
  decltype(&::umockdev_testbed_attach_ioctl) attach_ioctl;
  decltype(&::umockdev_testbed_detach_ioctl) detach_ioctl;
  decltype(&::umockdev_ioctl_base_new) ioctl_base_new;
  decltype(&::umockdev_ioctl_client_get_request) get_request;
  decltype(&::umockdev_ioctl_client_get_arg) get_arg;
  decltype(&::umockdev_ioctl_client_complete) complete;
  decltype(&::umockdev_ioctl_data_resolve) resolve;
  decltype(&::umockdev_ioctl_data_set_ptr) set_ptr;
  decltype(&::umockdev_ioctl_data_ref) ref;
  decltype(&::umockdev_ioctl_data_unref) unref;
  decltype(&::g_object_ref) object_ref;
  decltype(&::g_object_unref) object_unref;
  decltype(&::g_object_weak_ref) weak_ref;
  decltype(&::g_signal_connect_data) signal_connect;
};

/// Throws Error{device} where it is not installed.
[[nodiscard]] const Umockdev& umockdev();

}  // namespace sparsha::emulator
