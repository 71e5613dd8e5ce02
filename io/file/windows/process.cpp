// Sources: Microsoft's reference of the Windows API. The C library of a new process takes the numbers of its descriptors from
// STARTUPINFO.lpReserved2: a count, a byte of flags for each, and a handle for each (the C runtime's ioinit.cpp; libuv's process-stdio.c
// does the same).
#include "io/file/process.h"

#include <windows.h>

#include <fcntl.h>
#include <io.h>
#include <psapi.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <mutex>
#include <random>
#include <utility>

#include "io/file/windows/wide.h"

namespace cloudbake {

namespace {

[[noreturn]] void fail(const std::string& file, const std::string& what, DWORD error, const std::string& cure = "") {
  throw IoError(file, what + ": " + std::strerror(errnoOf(error)) + "; " + cure + "close other programs and try again");
}

struct Handle {
  HANDLE value = nullptr;
  Handle() = default;
  explicit Handle(HANDLE opened) : value(opened) {}
  Handle(Handle&& other) noexcept : value(std::exchange(other.value, nullptr)) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (value && value != INVALID_HANDLE_VALUE) ::CloseHandle(value);
  }
};

// What other processes may know of the environment: where programs and folders are, what Windows itself needs, and how to write to the
// console.
constexpr auto kPassedOn =
    std::to_array<const wchar_t*>({L"APPDATA", L"HOMEDRIVE", L"HOMEPATH", L"LOCALAPPDATA", L"NO_COLOR", L"PATH", L"SystemDrive",
                                   L"SystemRoot", L"TEMP", L"TERM", L"TMP", L"USERPROFILE", L"WINEDEBUG", L"WINEPREFIX"});

std::wstring environmentOfChild() {
  std::wstring block;
  for (const wchar_t* name : kPassedOn) {
    std::wstring value(::GetEnvironmentVariableW(name, nullptr, 0), L'\0');
    if (value.empty()) continue;
    value.resize(::GetEnvironmentVariableW(name, value.data(), DWORD(value.size())));
    block += name + (L"=" + value);
    block += L'\0';
  }
  return block + L'\0';
}

// A word as CommandLineToArgvW reads it: backslashes count only before a quotation mark.
std::wstring quoted(const std::wstring& word) {
  std::wstring text = L"\"";
  size_t backslashes = 0;
  for (const wchar_t character : word) {
    if (character == L'"') text.append(backslashes + 1, L'\\');
    backslashes = character == L'\\' ? backslashes + 1 : 0;
    text += character;
  }
  return text.append(backslashes, L'\\') + L'"';
}

// The table of descriptors for the C library of a new process. Handles that it inherits are appended to `owned`.
std::string descriptorTable(std::span<const Inherited> inherited, std::vector<Handle>& owned) {
  constexpr char kOpen = 1, kPipe = 8, kDevice = 0x40;
  int count = 3;
  for (const auto& [number, source] : inherited) count = std::max(count, number + 1);
  std::vector<char> flags(size_t(count), 0);
  std::vector<HANDLE> handles(size_t(count), INVALID_HANDLE_VALUE);
  const auto give = [&](int number, HANDLE source) {
    const DWORD type = ::GetFileType(source);
    Handle copy;
    if (!::DuplicateHandle(::GetCurrentProcess(), source, ::GetCurrentProcess(), &copy.value, 0, TRUE, DUPLICATE_SAME_ACCESS)) return;
    flags[size_t(number)] = char(kOpen | (type == FILE_TYPE_PIPE ? kPipe : type == FILE_TYPE_CHAR ? kDevice : 0));
    handles[size_t(number)] = owned.emplace_back(std::move(copy)).value;
  };
  const auto is_listed = [&](int number) {
    return std::any_of(inherited.begin(), inherited.end(), [&](const Inherited& one) { return one.number == number; });
  };
  for (const auto& [number, source] : inherited) {
    if (source >= 0) {
      give(number, handleOf(source));
    } else {
      const Handle none(
          ::CreateFileW(L"NUL", GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE, nullptr, OPEN_EXISTING, 0, nullptr));
      give(number, none.value);
    }
  }
  for (int stream = 0; stream < 3; ++stream)
    if (const HANDLE handle = handleOf(stream); !is_listed(stream) && handle != INVALID_HANDLE_VALUE) give(stream, handle);
  std::string table(sizeof count, '\0');
  std::memcpy(table.data(), &count, sizeof count);
  table.append(flags.data(), flags.size());
  table.append(reinterpret_cast<const char*>(handles.data()), handles.size() * sizeof(HANDLE));
  return table;
}

// The processes that this one starts end with it: the system closes the job then.
void addToJob(HANDLE process) {
  static const HANDLE job = [] {
    const HANDLE made = ::CreateJobObjectW(nullptr, nullptr);
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits{};
    limits.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE;
    ::SetInformationJobObject(made, JobObjectExtendedLimitInformation, &limits, sizeof limits);
    return made;
  }();
  ::AssignProcessToJobObject(job, process);
}

double secondsOf(const FILETIME& time) { return double(uint64_t(time.dwHighDateTime) << 32 | time.dwLowDateTime) * 1e-7; }

ProcessUsage usageOf(HANDLE process) {
  FILETIME begun{}, ended{}, kernel{}, user{};
  ::GetProcessTimes(process, &begun, &ended, &kernel, &user);
  PROCESS_MEMORY_COUNTERS counters{};
  ::GetProcessMemoryInfo(process, &counters, sizeof counters);
  return {secondsOf(kernel) + secondsOf(user), counters.PeakWorkingSetSize};
}

std::mutex usage_of_ended_mutex;
ProcessUsage usage_of_ended;  // of the processes that were waited for

constexpr int kKillSignal = 9;      // as on other systems
constexpr int kKilledCode = 0xC1B;  // the exit code of a process that killProcess has ended

// The signal that Linux would have sent for an exit code that stands for an exception.
int signalOf(DWORD code) {
  switch (code) {
    case EXCEPTION_ACCESS_VIOLATION:
    case EXCEPTION_IN_PAGE_ERROR:
    case EXCEPTION_STACK_OVERFLOW:
    case EXCEPTION_GUARD_PAGE:
    case 0xC0000374:  // STATUS_HEAP_CORRUPTION
      return SIGSEGV;
    case EXCEPTION_ILLEGAL_INSTRUCTION:
    case EXCEPTION_PRIV_INSTRUCTION: return SIGILL;
    case EXCEPTION_FLT_DIVIDE_BY_ZERO:
    case EXCEPTION_INT_DIVIDE_BY_ZERO:
    case EXCEPTION_INT_OVERFLOW: return SIGFPE;
    case 0x40000015:  // STATUS_FATAL_APP_EXIT
      return SIGABRT;
    case kKilledCode:
    case 0xC0000044:  // STATUS_QUOTA_EXCEEDED, of a job whose time is over
    case ERROR_NOT_ENOUGH_QUOTA: return kKillSignal;
    default: return 0;
  }
}

}  // namespace

std::filesystem::path thisProgram() {
  std::wstring path(260, L'\0');
  for (DWORD size; (size = ::GetModuleFileNameW(nullptr, path.data(), DWORD(path.size()))) == path.size();) path.resize(2 * path.size());
  return path.c_str();
}

void openPipe(Descriptor& to_read, Descriptor& to_write) {
  HANDLE read = nullptr, write = nullptr;
  if (!::CreatePipe(&read, &write, nullptr, 1 << 16)) fail("", "cannot create a pipe", ::GetLastError());
  to_read.close(), to_write.close();
  to_read.number = ::_open_osfhandle(reinterpret_cast<intptr_t>(read), _O_BINARY | _O_NOINHERIT);
  to_write.number = ::_open_osfhandle(reinterpret_cast<intptr_t>(write), _O_BINARY | _O_NOINHERIT);
}

// Windows keeps such a file in memory as long as it can, and removes it when it is closed.
void openInMemory(Descriptor& file, std::string_view bytes) {
  file.close();
  std::random_device draw;
  std::error_code none;
  const std::filesystem::path path =
      std::filesystem::temp_directory_path(none) / ("cloudbake-" + std::to_string(draw()) + std::to_string(draw()));
  const HANDLE handle = ::CreateFileW(path.c_str(), GENERIC_READ | GENERIC_WRITE | DELETE, FILE_SHARE_READ | FILE_SHARE_DELETE, nullptr,
                                      CREATE_NEW, FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
  if (handle == INVALID_HANDLE_VALUE) fail("", "cannot create a file in memory", ::GetLastError());
  file.number = ::_open_osfhandle(reinterpret_cast<intptr_t>(handle), _O_BINARY | _O_NOINHERIT);
  if (writeAll(file.number, bytes) != 0) fail("", "cannot create a file in memory", ::GetLastError());
  ::_lseeki64(file.number, 0, SEEK_SET);
}

pid_t startProcess(const std::filesystem::path& program, std::vector<std::string> words, std::span<const Inherited> inherited) {
  if (!program.is_absolute()) throw IoError(program.string(), "cannot start this program: its path is not absolute");
  std::wstring command_line;
  for (const std::string& word : words) command_line += (command_line.empty() ? L"" : L" ") + quoted(wideText(word));
  std::wstring environment = environmentOfChild();

  std::vector<Handle> owned;
  std::string table = descriptorTable(inherited, owned);
  const auto streamOf = [&](size_t number) {
    HANDLE handle = nullptr;
    int count = 0;
    std::memcpy(&count, table.data(), sizeof count);
    std::memcpy(&handle, table.data() + sizeof count + size_t(count) + number * sizeof handle, sizeof handle);
    return handle;
  };
  STARTUPINFOEXW start{};
  start.StartupInfo.cb = sizeof start;
  start.StartupInfo.dwFlags = STARTF_USESTDHANDLES;
  start.StartupInfo.hStdInput = streamOf(0);
  start.StartupInfo.hStdOutput = streamOf(1);
  start.StartupInfo.hStdError = streamOf(2);
  start.StartupInfo.cbReserved2 = WORD(table.size());
  start.StartupInfo.lpReserved2 = reinterpret_cast<BYTE*>(table.data());

  // Other handles that happen to be inheritable are not for this process.
  std::vector<HANDLE> handles;
  for (const Handle& one : owned) handles.push_back(one.value);
  SIZE_T size = 0;
  ::InitializeProcThreadAttributeList(nullptr, 1, 0, &size);
  std::vector<char> memory(size);
  start.lpAttributeList = reinterpret_cast<LPPROC_THREAD_ATTRIBUTE_LIST>(memory.data());
  ::InitializeProcThreadAttributeList(start.lpAttributeList, 1, 0, &size);
  ::UpdateProcThreadAttribute(start.lpAttributeList, 0, PROC_THREAD_ATTRIBUTE_HANDLE_LIST, handles.data(), handles.size() * sizeof(HANDLE),
                              nullptr, nullptr);
  PROCESS_INFORMATION process{};
  const BOOL started = ::CreateProcessW(program.c_str(), command_line.data(), nullptr, nullptr, TRUE,
                                        CREATE_UNICODE_ENVIRONMENT | EXTENDED_STARTUPINFO_PRESENT | CREATE_SUSPENDED, environment.data(),
                                        nullptr, &start.StartupInfo, &process);
  const DWORD error = ::GetLastError();
  ::DeleteProcThreadAttributeList(start.lpAttributeList);
  if (!started) fail(program.string(), "cannot start this program", error, "check that it is installed, or ");
  addToJob(process.hProcess);
  ::ResumeThread(process.hThread);
  ::CloseHandle(process.hThread);
  return reinterpret_cast<pid_t>(process.hProcess);
}

ProcessEnd waitForProcess(pid_t process) {
  const Handle handle(reinterpret_cast<HANDLE>(process));
  ::WaitForSingleObject(handle.value, INFINITE);
  DWORD code = 0;
  ::GetExitCodeProcess(handle.value, &code);
  {
    const ProcessUsage usage = usageOf(handle.value);
    const std::lock_guard lock(usage_of_ended_mutex);
    usage_of_ended.processor_seconds += usage.processor_seconds;
    usage_of_ended.peak_memory = std::max(usage_of_ended.peak_memory, usage.peak_memory);
  }
  const int signal = signalOf(code);
  return signal != 0 ? ProcessEnd{0, signal} : ProcessEnd{int(code), 0};
}

void killProcess(pid_t process) { ::TerminateProcess(reinterpret_cast<HANDLE>(process), kKilledCode); }

bool isFault(int signal) {
  constexpr std::array kFaults{SIGABRT, SIGFPE, SIGILL, SIGSEGV};
  return std::find(kFaults.begin(), kFaults.end(), signal) != kFaults.end();
}

std::string signalText(int signal) {
  switch (signal) {
    case SIGABRT: return "Aborted";
    case SIGFPE: return "Floating point exception";
    case SIGILL: return "Illegal instruction";
    case SIGSEGV: return "Segmentation fault";
    case kKillSignal: return "Killed";
    default: return "signal " + std::to_string(signal);
  }
}

// Windows cannot wait for a pipe: it is asked again and again, ever more rarely.
bool waitForBytes(int descriptor, std::chrono::milliseconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  for (DWORD pause = 0;; pause = std::min<DWORD>(pause + 1, 10)) {
    DWORD bytes = 0;
    if (!::PeekNamedPipe(handleOf(descriptor), nullptr, 0, nullptr, &bytes, nullptr) || bytes > 0) return true;
    if (std::chrono::steady_clock::now() >= end) return false;
    ::Sleep(pause);
  }
}

void endWithParent() {}  // by its job

void limitThisProcess(uint64_t seconds, uint64_t memory) {
  const HANDLE job = ::CreateJobObjectW(nullptr, nullptr);
  JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits{};
  limits.BasicLimitInformation.LimitFlags =
      JOB_OBJECT_LIMIT_PROCESS_TIME | JOB_OBJECT_LIMIT_PROCESS_MEMORY | JOB_OBJECT_LIMIT_DIE_ON_UNHANDLED_EXCEPTION;
  limits.BasicLimitInformation.PerProcessUserTimeLimit.QuadPart = LONGLONG(seconds) * 10'000'000;
  limits.ProcessMemoryLimit = memory;
  ::SetInformationJobObject(job, JobObjectExtendedLimitInformation, &limits, sizeof limits);
  ::AssignProcessToJobObject(job, ::GetCurrentProcess());
}

ProcessUsage usageOfProcesses() {
  ProcessUsage all = usageOf(::GetCurrentProcess());
  const std::lock_guard lock(usage_of_ended_mutex);
  all.processor_seconds += usage_of_ended.processor_seconds;
  all.peak_memory = std::max(all.peak_memory, usage_of_ended.peak_memory);
  return all;
}

}  // namespace cloudbake
