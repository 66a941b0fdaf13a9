// Marks for the inner loop: what every tick runs through, and what only seldom ones do.
#pragma once

#if defined(__GNUC__)
#define SPARSHA_HOT [[gnu::always_inline]]
#define SPARSHA_SELDOM [[gnu::noinline]]
#else
#define SPARSHA_HOT
#define SPARSHA_SELDOM
#endif
