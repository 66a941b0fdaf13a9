// What processes beside the program give up for good: a fault in them, or in what they are given to read, is to lead
// nowhere. Linux with seccomp (x86-64, arm64); elsewhere these do nothing.
#pragma once

namespace sparsha::system {

enum class Confinement {
  /// For another program that is run: it gains no rights (no_new_privs), traces no process, mounts nothing, loads
  /// nothing into the system.
  helper,
  /// For a process that writes to a device alone: besides, it runs no program, opens no connection but to this
  /// machine's own sockets, and creates, renames, removes and re-owns no file.
  watch
};

/// Of the calling thread and all that it starts, not to be undone. What is given up fails with EPERM. False where the
/// system does not do it, or not all of it.
bool confine_thread(Confinement what) noexcept;

/// A process that only has to say something: no core files, 256 open files, 4 GB of addresses, 10 minutes of computing.
void limit_helper(long process) noexcept;

}  // namespace sparsha::system
