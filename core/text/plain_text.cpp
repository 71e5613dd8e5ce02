// Byte-order marks: The Unicode Standard 15, section 23.8.
#include "core/text/plain_text.h"

#include "core/error.h"

namespace cloudbake {

namespace {

// Whether the bytes begin like UTF-16 or UTF-32: with its mark, or with two characters of ASCII.
bool isWide(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF") || bytes.starts_with(std::string_view("\0\0\xFE\xFF", 4))) return true;
  if (bytes.size() < 4) return false;
  const bool zero[] = {bytes[0] == 0, bytes[1] == 0, bytes[2] == 0, bytes[3] == 0};
  return zero[0] != zero[1] && zero[0] == zero[2] && zero[1] == zero[3];
}

// The first carriage return from `at` on that is not followed by a line feed.
size_t findLoneReturn(std::string_view text, size_t at) {
  at = text.find('\r', at);
  while (at != text.npos && at + 1 < text.size() && text[at + 1] == '\n') at = text.find('\r', at + 2);
  return at;
}

}  // namespace

std::string_view withoutByteOrderMark(std::string_view bytes) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return bytes.starts_with(kMark) ? bytes.substr(kMark.size()) : bytes;
}

std::string_view plainText(std::string_view bytes, const std::string& file, std::string& storage) {
  if (isWide(bytes)) throw InputError(file, "the text is stored as UTF-16 or UTF-32; save it as UTF-8");
  const std::string_view text = withoutByteOrderMark(bytes);
  size_t at = findLoneReturn(text, 0);
  if (at == text.npos) return text;
  storage = text;
  for (; at != storage.npos; at = findLoneReturn(storage, at + 1)) storage[at] = '\n';
  return storage;
}

}  // namespace cloudbake
