// Marks for the inner loop: what every tick runs through, what only seldom ones do, what the next will read.
#pragma once

#if defined(__GNUC__)
#define SPARSHA_HOT [[gnu::always_inline]]
#define SPARSHA_SELDOM [[gnu::noinline]]
#define SPARSHA_PREFETCH(address) __builtin_prefetch(address)
#else
#define SPARSHA_HOT
#define SPARSHA_SELDOM
#define SPARSHA_PREFETCH(address) static_cast<void>(address)
#endif
