// Libraries that are opened late, when they are needed. late/NAME.cpp lists the functions of libcloudbake_NAME.so and includes this file.
// The library compiles it with CLOUDBAKE_IN_LATE_LIBRARY into a table of these functions. The program compiles it into stand-ins that call
// through the table; programs that are linked with the real functions, such as the tests, need neither. docs/architecture.md, Difficult
// parts, says what this relies on.
//   LIBRARY              NAME
//   FUNCTIONS(FUNCTION)  a FUNCTION(result, name, (parameters), (arguments)) for each
#pragma once

#include <dlfcn.h>

#include <string>
#include <type_traits>

#include "core/error.h"
#include "io/file/own_library.h"

#define STRING_OF(name) #name
#define FILE_OF(name) "libcloudbake_" STRING_OF(name) ".so"

namespace cloudbake::LIBRARY {

#define IS_DECLARED(result, name, parameters, arguments) \
  static_assert(std::is_same_v<result parameters, decltype(cloudbake::name)>, #name " is declared otherwise in its header");
FUNCTIONS(IS_DECLARED)

/// The version and the list of functions: a table with other ones is that of another build.
#define DECLARATION(result, name, parameters, arguments) "; " #result " " #name #parameters
constexpr const char* kContents = CLOUDBAKE_VERSION FUNCTIONS(DECLARATION);

struct Table {
  const char* contents;
#define POINTER(result, name, parameters, arguments) decltype(&cloudbake::name) name;
  FUNCTIONS(POINTER)
};

#ifdef CLOUDBAKE_IN_LATE_LIBRARY

/// The one symbol that the library exports.
#define ADDRESS(result, name, parameters, arguments) , cloudbake::name
extern "C" __attribute__((visibility("default"))) const Table cloudbakeTable{kContents FUNCTIONS(ADDRESS)};

}  // namespace cloudbake::LIBRARY

#else

/// Throws IoError if the library is missing or of another build.
inline const Table& open() {
  const auto fail = [](const std::string& why) -> const Table& {
    throw IoError(FILE_OF(LIBRARY), "cannot be used: " + why + "; install cloudbake as a whole");
  };
  const auto file = ownLibrary(FILE_OF(LIBRARY));
  if (!file) return fail("it is not beside the program");
  void* library = ::dlopen(file->c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);  // objects that it made may live on
  if (!library) return fail(::dlerror());
  const auto* table = static_cast<const Table*>(::dlsym(library, "cloudbakeTable"));
  if (!table) return fail(::dlerror());
  const std::string contents = table->contents;
  if (contents != kContents) return fail("it is of another build, of version " + contents.substr(0, contents.find(';')));
  return *table;
}

inline const Table& table() {
  static const Table& opened = open();
  return opened;
}

}  // namespace cloudbake::LIBRARY

namespace cloudbake {
#define STAND_IN(result, name, parameters, arguments) \
  result name parameters { return LIBRARY::table().name arguments; }
FUNCTIONS(STAND_IN)
}  // namespace cloudbake

#endif
