// Functions of the C library that Emscripten's has in another way: the words of errors are those of glibc, and locks of files, which Node
// lacks, are files with the number of their process. The linker turns calls of strerror into __wrap_strerror (cmake/wasm.cmake).
#include <sys/file.h>

#include <cerrno>

#include "core/wasm/host.h"

extern "C" {

char* __real_strerror(int error);  // NOLINT(bugprone-reserved-identifier): the linker's names

char* __wrap_strerror(int error) {  // NOLINT(bugprone-reserved-identifier)
  const auto other = [&]() -> const char* {
    switch (error) {
      case EBUSY: return "Device or resource busy";
      case EDQUOT: return "Disk quota exceeded";
      case EILSEQ: return "Invalid or incomplete multibyte or wide character";
      case EIO: return "Input/output error";
      case ELOOP: return "Too many levels of symbolic links";
      case EMFILE: return "Too many open files";
      case ENAMETOOLONG: return "File name too long";
      case ENOMEM: return "Cannot allocate memory";
      case EOPNOTSUPP: return "Operation not supported";
      case EOVERFLOW: return "Value too large for defined data type";
      case EXDEV: return "Invalid cross-device link";
      default: return nullptr;
    }
  }();
  return other ? const_cast<char*>(other) : __real_strerror(error);
}

int flock(int file, int operation) {
  const int error = cloudbake_lock(file, (operation & LOCK_EX) != 0);
  if (error != 0) errno = error;
  return error == 0 ? 0 : -1;
}

}  // extern "C"
