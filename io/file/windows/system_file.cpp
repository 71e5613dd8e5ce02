// Sources: Microsoft's reference of the Windows API. Files are opened so that others may rename and remove them meanwhile, as on other
// systems (FILE_SHARE_DELETE). A lock lies beyond all bytes, because Windows refuses reading those that are locked.
#include "io/file/system_file.h"

#include <windows.h>

#include <fcntl.h>
#include <io.h>

#include <array>
#include <cerrno>

#include "io/file/windows/wide.h"

namespace cloudbake {

namespace {

constexpr DWORD kShareAll = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

int failNow() {
  errno = errnoOf(::GetLastError());
  return -1;
}

int failureOf(BOOL succeeded) { return succeeded ? 0 : errnoOf(::GetLastError()); }

// Windows does not tell a missing folder from a file in its place, or from a name that is too long for a folder's entry.
int failAt(const std::filesystem::path& path) {
  constexpr size_t kLongestName = 255;
  failNow();
  if (errno != ENOENT) return -1;
  for (const std::filesystem::path& name : path)
    if (name.native().size() > kLongestName) {
      errno = ENAMETOOLONG;
      return -1;
    }
  for (std::filesystem::path above = path.parent_path(); above.has_relative_path(); above = above.parent_path()) {
    const DWORD attributes = ::GetFileAttributesW(longPath(above).c_str());
    if (attributes == INVALID_FILE_ATTRIBUTES) continue;
    errno = attributes & FILE_ATTRIBUTE_DIRECTORY ? ENOENT : ENOTDIR;
    break;
  }
  return -1;
}

int openAs(const std::filesystem::path& path, DWORD access, DWORD how, DWORD flags = FILE_ATTRIBUTE_NORMAL) {
  const HANDLE handle = ::CreateFileW(longPath(path).c_str(), access, kShareAll, nullptr, how, flags, nullptr);
  if (handle == INVALID_HANDLE_VALUE) return failAt(path);
  const int descriptor = ::_open_osfhandle(reinterpret_cast<intptr_t>(handle), _O_BINARY | _O_NOINHERIT);
  if (descriptor < 0) ::CloseHandle(handle);
  return descriptor;
}

std::optional<FileStatus> statusOfHandle(HANDLE handle) {
  const DWORD type = ::GetFileType(handle);
  FileStatus status;
  if (type == FILE_TYPE_CHAR || type == FILE_TYPE_PIPE) {
    status.kind = type == FILE_TYPE_CHAR ? FileKind::kCharacterDevice : FileKind::kPipe;
    return status;
  }
  BY_HANDLE_FILE_INFORMATION info{};
  if (!::GetFileInformationByHandle(handle, &info)) {
    failNow();
    return std::nullopt;
  }
  const auto join = [](DWORD high, DWORD low) { return uint64_t(high) << 32 | low; };
  if (info.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) status.kind = FileKind::kFolder;
  status.device = info.dwVolumeSerialNumber;
  status.number = join(info.nFileIndexHigh, info.nFileIndexLow);
  status.size = join(info.nFileSizeHigh, info.nFileSizeLow);
  status.changed = int64_t(join(info.ftLastWriteTime.dwHighDateTime, info.ftLastWriteTime.dwLowDateTime)) * 100;
  status.permissions = info.dwFileAttributes & FILE_ATTRIBUTE_READONLY ? 0444 : 0666;
  status.names = info.nNumberOfLinks;
  status.is_own = true;  // who may remove a file is decided by Windows
  return status;
}

std::optional<FileStatus> statusAt(const std::filesystem::path& path, DWORD flags) {
  const HANDLE handle = ::CreateFileW(longPath(path).c_str(), FILE_READ_ATTRIBUTES, kShareAll, nullptr, OPEN_EXISTING,
                                      FILE_FLAG_BACKUP_SEMANTICS | flags, nullptr);
  if (handle == INVALID_HANDLE_VALUE) {
    failAt(path);
    return std::nullopt;
  }
  const auto status = statusOfHandle(handle);
  ::CloseHandle(handle);
  return status;
}

}  // namespace

std::wstring longPath(const std::filesystem::path& path) {
  constexpr size_t kLongest = 240;  // of 260, which hold a name in a folder, too
  std::error_code error;
  std::filesystem::path full = std::filesystem::absolute(path, error).lexically_normal();
  if (error || full.native().size() < kLongest || full.native().starts_with(L"\\\\?\\")) return path.native();
  full.make_preferred();
  if (full.native().starts_with(L"\\\\")) return L"\\\\?\\UNC" + full.native().substr(1);
  return L"\\\\?\\" + full.native();
}

void* handleOf(int descriptor) { return reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor)); }

int errnoOf(unsigned long error) {
  switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_DRIVE:
    case ERROR_BAD_NETPATH:
    case ERROR_BAD_NET_NAME:
    case ERROR_INVALID_NAME: return ENOENT;
    case ERROR_DIRECTORY: return ENOTDIR;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS: return EEXIST;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
    case ERROR_USER_MAPPED_FILE: return EACCES;
    case ERROR_WRITE_PROTECT: return EROFS;
    case ERROR_LOCK_VIOLATION:
    case ERROR_IO_PENDING: return EWOULDBLOCK;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL: return ENOSPC;
    case ERROR_FILENAME_EXCED_RANGE: return ENAMETOOLONG;
    case ERROR_NOT_ENOUGH_MEMORY:
    case ERROR_OUTOFMEMORY: return ENOMEM;
    case ERROR_TOO_MANY_OPEN_FILES: return EMFILE;
    case ERROR_BROKEN_PIPE:
    case ERROR_NO_DATA: return EPIPE;
    default: return EIO;
  }
}

std::wstring wideText(const std::string& text) {
  std::wstring wide(size_t(::MultiByteToWideChar(CP_UTF8, 0, text.data(), int(text.size()), nullptr, 0)), L'\0');
  ::MultiByteToWideChar(CP_UTF8, 0, text.data(), int(text.size()), wide.data(), int(wide.size()));
  return wide;
}

std::string narrowText(const std::wstring& text) {
  std::string narrow(size_t(::WideCharToMultiByte(CP_UTF8, 0, text.data(), int(text.size()), nullptr, 0, nullptr, nullptr)), '\0');
  ::WideCharToMultiByte(CP_UTF8, 0, text.data(), int(text.size()), narrow.data(), int(narrow.size()), nullptr, nullptr);
  return narrow;
}

std::optional<FileStatus> statusOf(const std::filesystem::path& path) { return statusAt(path, 0); }

std::optional<FileStatus> statusOfName(const std::filesystem::path& path) { return statusAt(path, FILE_FLAG_OPEN_REPARSE_POINT); }

std::optional<FileStatus> statusOf(int descriptor) { return statusOfHandle(handleOf(descriptor)); }

int whyNotWritable(const std::filesystem::path& path) {
  const HANDLE handle = ::CreateFileW(longPath(path).c_str(), GENERIC_WRITE, kShareAll, nullptr, OPEN_EXISTING, 0, nullptr);
  if (handle == INVALID_HANDLE_VALUE) return errnoOf(::GetLastError());
  ::CloseHandle(handle);
  return 0;
}

int openToRead(const std::filesystem::path& path, bool) { return openAs(path, GENERIC_READ, OPEN_EXISTING); }

int openToWrite(const std::filesystem::path& path) { return openAs(path, GENERIC_WRITE, OPEN_EXISTING); }

int openNew(const std::filesystem::path& path, uint32_t) { return openAs(path, GENERIC_READ | GENERIC_WRITE | DELETE, CREATE_NEW); }

int openNamed(const std::filesystem::path& path) {
  return openAs(path, GENERIC_READ, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL | FILE_FLAG_OPEN_REPARSE_POINT);
}

int openLockFile(const std::filesystem::path& path) { return openAs(path, GENERIC_READ | GENERIC_WRITE, OPEN_ALWAYS); }

int lockNow(int descriptor, LockKind kind) {
  OVERLAPPED place{};
  place.Offset = 0xFFFFFFFE;
  place.OffsetHigh = 0x7FFFFFFF;
  const DWORD flags = LOCKFILE_FAIL_IMMEDIATELY | (kind == LockKind::kExclusive ? LOCKFILE_EXCLUSIVE_LOCK : 0);
  return failureOf(::LockFileEx(handleOf(descriptor), flags, 0, 1, 0, &place));
}

int setPermissions(int, uint32_t) { return 0; }  // a file that may only be read is never replaced

int syncFile(int descriptor) { return failureOf(::FlushFileBuffers(handleOf(descriptor))); }

int syncFolder(const std::filesystem::path&) { return 0; }  // MOVEFILE_WRITE_THROUGH has done it

int renameFile(const std::filesystem::path& from, const std::filesystem::path& to) {
  return failureOf(::MoveFileExW(longPath(from).c_str(), longPath(to).c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH));
}

void removeName(const wchar_t* path) noexcept { ::DeleteFileW(path); }

std::string hostName() {
  std::array<wchar_t, 256> name{};
  DWORD size = name.size();
  return ::GetComputerNameW(name.data(), &size) ? narrowText({name.data(), size}) : "";
}

}  // namespace cloudbake
