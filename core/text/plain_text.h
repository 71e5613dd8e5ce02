// The one place that mends the bytes of text files: every reader of text calls it first.
#pragma once

#include <string>
#include <string_view>

namespace cloudbake {

/// The bytes without a byte-order mark of UTF-8.
std::string_view withoutByteOrderMark(std::string_view bytes);

/// The text of a file as its readers expect it: without a byte-order mark, and with every line ended by "\n" or "\r\n". A carriage return
/// alone, which ended lines on old Macs, becomes "\n", so that line numbers stay right. `storage` holds the text if it had to be changed;
/// it and `bytes` must outlive the result. `file` is for messages. Throws InputError for UTF-16 and UTF-32, with or without a mark.
std::string_view plainText(std::string_view bytes, const std::string& file, std::string& storage);

}  // namespace cloudbake
