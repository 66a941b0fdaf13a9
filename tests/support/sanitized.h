// SPARSHA_SANITIZED: 1 where AddressSanitizer or ThreadSanitizer watch the tests, whichever the compiler; else 0.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SPARSHA_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SPARSHA_SANITIZED 1
#endif
#endif
#ifndef SPARSHA_SANITIZED
#define SPARSHA_SANITIZED 0
#endif
