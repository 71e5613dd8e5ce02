#include "core/text/maker.h"

namespace cloudbake {

bool namesMaker(std::string_view bytes) {
  constexpr std::string_view kName = "cloudbake ", kDigits = "0123456789";
  for (size_t at = 0; (at = bytes.find(kName, at)) != bytes.npos;) {
    at += kName.size();
    const size_t dot = bytes.find_first_not_of(kDigits, at);
    if (dot == bytes.npos) return false;
    if (dot > at && bytes[dot] == '.' && dot + 1 < bytes.size() && kDigits.find(bytes[dot + 1]) != kDigits.npos) return true;
  }
  return false;
}

}  // namespace cloudbake
