// What the library throws.
//
//   sparsha::Error      what is wrong, where and what was expected; what() reads "file:line:column: error: wrong;
//   expected" sparsha::ErrorKind  usage: the caller's arguments; input: data that was read; device; failure: anything
//   else sparsha::Cancelled  the work was stopped by request and left nothing behind
//
// Functions of the servo thread are noexcept and return status values instead. Errors are values: they may be copied
// and read on any thread.
#pragma once

#include "base/error.h"
