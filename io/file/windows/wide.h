// Paths and errors of Windows.
#pragma once

#include <filesystem>
#include <string>

namespace cloudbake {

/// A path for calls of Windows: one that is long is absolute and begins with \\?\, because without this Windows takes at most 260
/// characters.
std::wstring longPath(const std::filesystem::path& path);

/// The errno that stands for an error of Windows (GetLastError).
int errnoOf(unsigned long error);

/// The handle of Windows behind a descriptor.
void* handleOf(int descriptor);

/// UTF-8 as UTF-16, and back.
std::wstring wideText(const std::string& text);
std::string narrowText(const std::wstring& text);

}  // namespace cloudbake
