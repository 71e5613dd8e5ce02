#include "io/file/wasm/helper.h"

#include <utility>

#include "core/wasm/host.h"

namespace cloudbake {

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += word + '\0';
  return text;
}

}  // namespace

Helper::Helper(const std::vector<std::string>& words) : number_(cloudbake_start(joined(words).c_str())) {}
Helper::Helper(Helper&& other) noexcept : number_(std::exchange(other.number_, 0)) {}
Helper::~Helper() {
  if (number_ > 0) cloudbake_stop(number_);
}
void Helper::send(std::string_view bytes) const { cloudbake_send(number_, bytes.data(), bytes.size()); }

std::optional<HelperMessage> receiveMessage(std::optional<double> seconds) {
  const int from = cloudbake_receive(seconds ? 1000 * *seconds : -1);
  if (from < 0) return std::nullopt;
  HelperMessage message{from, HelperMessage::Kind(cloudbake_message_kind()), std::string(cloudbake_message_size(), '\0')};
  cloudbake_take_message(message.bytes.data());
  return message;
}

void sendToParent(std::string_view bytes) { cloudbake_send(0, bytes.data(), bytes.size()); }

}  // namespace cloudbake
