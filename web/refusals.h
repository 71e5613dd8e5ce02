// Whether the module has refused something that only the whole program can do.
#pragma once

namespace cloudbake {

/// Set by every function of refusals.cpp. A call clears it before it begins.
inline bool has_refused = false;

}  // namespace cloudbake
