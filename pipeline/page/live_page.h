// The page of `view`: scenes of mesh clouds, live in a browser, in one file.
#pragma once

#include <span>
#include <string>

#include "pipeline/page/live_scene.h"

namespace cloudbake {

/// Where a page is: in a file it may not ask for anything; the page of a server receives new scenes from it.
enum class PageKind { kFile, kServed };

/// What the page shows, as JSON: the scenes, the first one at first, and their looks. A server sends this text for a changed scene.
std::string livePageData(std::span<const LiveScene> scenes);

/// The page, with the name of its first scene as title. `scenes` is not empty.
std::string livePage(std::span<const LiveScene> scenes, PageKind kind = PageKind::kFile);

}  // namespace cloudbake
