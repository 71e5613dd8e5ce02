// Source: Microsoft's reference of the Windows API. The same bytes are printed as on other systems: no line end gets another character.
#include "app/terminal.h"

#include <windows.h>

#include <fcntl.h>
#include <io.h>
#include <shellapi.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "io/file/windows/wide.h"

namespace cloudbake {

void prepareTerminal(int& argc, char**& argv) {
  static std::vector<std::string> words;
  static std::vector<char*> pointers;
  wchar_t** const wide = ::CommandLineToArgvW(::GetCommandLineW(), &argc);
  for (int i = 0; i < argc; ++i) words.push_back(narrowText(wide[i]));
  ::LocalFree(wide);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  argv = pointers.data();

  ::SetConsoleOutputCP(CP_UTF8);
  for (std::FILE* stream : {stdin, stdout, stderr}) ::_setmode(::_fileno(stream), _O_BINARY);
  _fmode = _O_BINARY;
}

bool isTerminal() {
  const HANDLE console = ::GetStdHandle(STD_ERROR_HANDLE);
  DWORD mode = 0;
  return ::GetConsoleMode(console, &mode) && ::SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

size_t terminalWidth() {
  CONSOLE_SCREEN_BUFFER_INFO info{};
  const bool is_known = ::GetConsoleScreenBufferInfo(::GetStdHandle(STD_ERROR_HANDLE), &info);
  return is_known && info.dwSize.X > 0 ? size_t(info.dwSize.X) : kUsualWidth;
}

}  // namespace cloudbake
