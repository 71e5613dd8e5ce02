// Opens the libraries that are loaded only when they are needed. Each has a table of functions (modules/NAME.h), which the module defines
// (NAME_table.cpp). The program is linked with stand-ins (NAME_calls.cpp) that call through the table; programs that are linked with the
// real functions, such as the tests, do not need the module.
#pragma once

#include <dlfcn.h>

#include <string>

#include "core/error.h"
#include "io/file/own_library.h"

namespace cloudbake {

/// The one symbol that a module exports is this pointer to its table, whose first member is the version of cloudbake, because a table of
/// another version has other functions. Throws IoError if the library is missing or of another version.
template <class Table>
const Table& openModule(const char* library_name) {
  const auto fail = [&](const std::string& why) -> const Table& {
    throw IoError(library_name, "cannot be used: " + why + "; install cloudbake as a whole");
  };
  const auto file = ownLibrary(library_name);
  if (!file) return fail("it is not beside the program");
  // It is never closed: objects that it made live as long as they like.
  void* library = ::dlopen(file->c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) return fail(::dlerror());
  const auto* table = static_cast<const Table*>(::dlsym(library, "cloudbakeModule"));
  if (!table) return fail(::dlerror());
  if (std::string(table->version) != CLOUDBAKE_VERSION) return fail(std::string("it is of version ") + table->version);
  return *table;
}

}  // namespace cloudbake
