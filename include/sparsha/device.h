// The interface that a haptic device implements, and the devices that need no hardware.
//
//   haptics::Device                 info(), wait(), read(), write(), zero(): all but info() from the servo's thread,
//   where
//                                   nothing may allocate, lock or throw; only wait() may block
//   haptics::DeviceSample           one position: metres, device frame (x right, y up, z towards the person), seconds
//   haptics::DeviceInfo             workspace in metres, limits of force (N), of its growth (N/s), least damping (N
//   s/m) haptics::make_simulated_device  a hand in software that follows a seeded script: the same samples each time
//
// The caller owns the device, which outlives the servo. sparsha/device_plugin.h is the same in C, for drivers that are
// loaded by the program at run time.
#pragma once

#include "haptics/device/device.h"
#include "haptics/device/simulated/simulated_device.h"
