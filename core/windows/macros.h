// Included before all of our sources on Windows: it makes windows.h, which headers of libraries include too, leave out what is seldom
// needed, and takes back macros whose names are words.
#pragma once

#define NOMINMAX
#define WIN32_LEAN_AND_MEAN
#define NOGDI
#include <windows.h>

#undef near
#undef far
#undef NEAR
#undef FAR
#define NEAR
#define FAR
#undef small
#undef interface
#undef ERROR
