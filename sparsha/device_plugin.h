/* A haptic device of your own for Sparsha, as a shared library: `sparsha explore SCENE --device plugin:FILE.so`.
 *
 * The library is loaded at run time into a process of its own; nothing of Sparsha is linked, and nothing of yours is
 * linked into Sparsha. Export one function, sparsha_device_plugin_entry(), that returns a table which stays.
 *
 * Units and frame: metres, newtons, seconds; right-handed, x right, y up, z towards the person, zero in the middle of
 * the workspace.
 *
 * Threads: open(), info(), read(), write() and close() are called by one thread, one after the other. zero() may be
 * called by another at any time, also while one of those is still running, also after the library has crashed: it must
 * switch the motors off and may do nothing else. It is called again and again while something is wrong.
 *
 * Order: open(); info() once; then at rate_hz, or a thousand times a second, read() and write(); zero() and close() at
 * the end. After a crash or a hang the library is loaded anew by another process, which calls open(), zero() and
 * close(): where a driver holds its last force, that ends it.
 *
 * What may not happen: read(), write() and zero() may not wait for longer than a millisecond, may not throw, and may
 * not end the process. A value that is not a number, a position that no hand can have come to, another rate than that
 * of info(), a call that hangs for 10 ms or a crash end in zero force and a message. */
#ifndef SPARSHA_DEVICE_PLUGIN_H
#define SPARSHA_DEVICE_PLUGIN_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SPARSHA_DEVICE_PLUGIN_VERSION 1u

#if defined(_WIN32)
#define SPARSHA_DEVICE_PLUGIN_EXPORT __declspec(dllexport)
#else
#define SPARSHA_DEVICE_PLUGIN_EXPORT __attribute__((visibility("default")))
#endif

/* What the device can do. Be honest: a delay that is too short or a force that is too great costs stability. */
typedef struct sparsha_device_info {
  char name[64];                  /* UTF-8, ended by a zero */
  double workspace_width_m;       /* of a cube that the hand reaches everywhere */
  double max_force_n;             /* that the motors hold in every direction */
  double least_damping_n_s_per_m; /* of hand and device together; 0 where nobody has measured it */
  double slew_n_per_s;            /* greatest growth of force; 1500 is usual */
  double rate_hz;                 /* of new positions, 100 to 10000; 0 = 1000 */
  double fastest_m_per_s;         /* no hand moves it faster; 0 = 5 */
  uint32_t delay_ticks;           /* from a force's writing to the hand, 0 to 4 */
  /* Longest way of the grip between two steps of the encoders, micrometres, at most 1000; 0: unknown, taken as finer
   * than 100. If steps are coarser and not given here, a slow hand looks like a device that repeats its positions, and
   * its walls become soft. */
  uint32_t encoder_step_um;
} sparsha_device_info;

typedef struct sparsha_device_sample {
  double position_m[3];
  double orientation[4]; /* w, x, y, z of a unit quaternion; all zero where it is not measured */
  double delay_s;        /* from a force to a position that shows it, where it is measured; else 0 */
  uint64_t buttons;      /* bit 0 right, 1 front, 2 centre, 3 left */
  uint8_t fresh;         /* 0: nothing new since the last call */
  uint8_t homed;         /* 0: positions mean nothing yet, or an emergency stop is on: no force */
  uint8_t connected;     /* 0: unplugged */
  uint8_t reserved[5];
} sparsha_device_sample;

/* Functions that return int: 0 = done; anything else ends the force. The call is made again at the next tick; after a
 * write() that fails, with zero force for half a second. */
typedef struct sparsha_device_plugin {
  uint32_t version; /* SPARSHA_DEVICE_PLUGIN_VERSION */
  uint32_t size;    /* sizeof(sparsha_device_plugin) */
  /* May take ten seconds. Not 0: `problem` is a sentence's end for the person, ended by a zero. */
  int (*open)(char* problem, uint32_t problem_size);
  int (*info)(sparsha_device_info* info);
  int (*read)(sparsha_device_sample* sample);
  /* To be held until the next call. Never longer than max_force_n; zero until the hand has been in free space. */
  int (*write)(const double force_n[3]);
  void (*zero)(void);
  void (*close)(void);
} sparsha_device_plugin;

SPARSHA_DEVICE_PLUGIN_EXPORT const sparsha_device_plugin* sparsha_device_plugin_entry(void);

#ifdef __cplusplus
}
#endif

#endif
