// POSIX: the signals by which others ask a program to end.
#pragma once

#include <csignal>

namespace sparsha::system {

inline constexpr int kEndingSignals[] = {
    SIGINT,    SIGTERM, SIGHUP, SIGQUIT, SIGABRT, SIGXCPU, SIGALRM, SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2,
#if defined(SIGPOLL)
    SIGPOLL,
#endif
#if defined(SIGPWR)
    SIGPWR,
#endif
#if defined(SIGSTKFLT)
    SIGSTKFLT,
#endif
};

}  // namespace sparsha::system
