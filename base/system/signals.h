// The signals by which others ask a program to end, and the standard streams that they started it with.
#pragma once

namespace sparsha::system {

/// Hands every signal by which a person, a terminal, a limit or another program asks this one to end to `asked`, which
/// is given its number and must be safe in a signal handler, and lets through those that the launcher has held. SIGABRT
/// too, where another process sent it. SIGHUP stays ignored where it was (nohup). A write that meets a closed pipe or a
/// limit becomes an error of that write. May be called before main().
void route_ending_signals(void (*asked)(int number)) noexcept;

/// Opens those of the standard streams that were closed, so that no file of the program takes their place: input is at
/// its end, messages are lost, and results cannot be written, which is an error as on a full disk.
void open_standard_streams() noexcept;

}  // namespace sparsha::system
