// The real-time loop: reads a device, renders, writes the force, 1000 times a second and more, watched by a watchdog.
//
//   haptics::Servo         start(), post(command), collect(), stop(): called by one thread; a thread of its own does
//   the
//                          rest. stop() and the destructor end in zero force
//   haptics::ServoOptions  the renderer's options, and whether SCHED_FIFO and locked memory are asked for
//   haptics::Command       another window, another stiffness, a guide: carried out between two ticks
//   haptics::Seqlock       read() gives the newest haptics::State on any thread and never makes the servo wait
//   haptics::ServoFigures  ticks, lateness in nanoseconds, faults; read after stop()
//
// Device, state and queues are the caller's and outlive the servo; surfaces come back through collect(), so that
// nothing is freed on the servo's thread. Where real-time priority is not granted the loop runs without it and says so
// (real_time()). A pause beyond the watchdog's patience, twice the period at least, ends in zero force.
#pragma once

#include "haptics/servo/servo.h"
#include "sparsha/renderer.h"
