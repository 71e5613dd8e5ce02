// std::filesystem::path of libstdc++ takes bytes as text of the C library's locale, by mbrtowc(3), whose only locale on Windows is the ANSI
// code page. The program is linked with --wrap=mbrtowc, so that this one is called: bytes are UTF-8 (RFC 3629).
#include <cstdint>
#include <cwchar>

extern "C" size_t __wrap_mbrtowc(wchar_t* out, const char* bytes, size_t count, std::mbstate_t* state);

// A character that takes two units of UTF-16 is returned as two: its first three bytes make the first, and the state keeps what the fourth
// byte needs to make the second.
extern "C" size_t __wrap_mbrtowc(wchar_t* out, const char* bytes, size_t count, std::mbstate_t* state) {
  constexpr size_t kInvalid = size_t(-1), kIncomplete = size_t(-2);
  constexpr int kPending = 0x100;
  if (!bytes || count == 0) return bytes ? kIncomplete : 0;
  const auto at = [&](size_t i) { return uint32_t(static_cast<unsigned char>(bytes[i])); };
  const auto isNext = [&](size_t i) { return (at(i) & 0xC0) == 0x80; };
  const auto give = [&](uint32_t unit, size_t length) {
    if (out) *out = wchar_t(unit);
    return length;
  };
  if (state && (*state & kPending) != 0) {
    if (!isNext(0)) return kInvalid;
    const uint32_t low = 0xDC00 | uint32_t(*state & 0xF) << 6 | (at(0) & 0x3F);
    *state = 0;
    return give(low, 1);
  }
  const uint32_t first = at(0);
  if (first < 0x80) return give(first, first == 0 ? 0 : 1);
  const size_t length = first >= 0xF0 && first < 0xF5 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first >= 0xF5) return kInvalid;
  for (size_t i = 1; i < length; ++i) {
    if (i == count) return kIncomplete;
    if (!isNext(i)) return kInvalid;
  }
  if (length == 2) return give((first & 0x1F) << 6 | (at(1) & 0x3F), 2);
  if (length == 3) {
    const uint32_t code = (first & 0xF) << 12 | (at(1) & 0x3F) << 6 | (at(2) & 0x3F);
    return code < 0x800 || (code >= 0xD800 && code < 0xE000) ? kInvalid : give(code, 3);
  }
  const uint32_t upper = (first & 0x7) << 8 | (at(1) & 0x3F) << 2 | (at(2) & 0x3F) >> 4;  // the code point without its last 10 bits
  if (upper < 0x40 || upper >= 0x440 || !state) return kInvalid;
  *state = kPending | int(at(2) & 0xF);
  return give(0xD800 | (upper - 0x40), 3);
}
