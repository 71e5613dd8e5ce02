#include "io/file/wasm/helper.h"

#include <utility>

#include "core/wasm/host.h"

namespace cloudbake {

Helper::Helper() : number_(cloudbake_start_helper()) {}
Helper::Helper(Helper&& other) noexcept : number_(std::exchange(other.number_, 0)) {}
Helper::~Helper() {
  if (number_ > 0) cloudbake_stop(number_);
}
void Helper::send(std::string_view bytes) const { cloudbake_send(number_, bytes.data(), bytes.size()); }

std::optional<HelperMessage> receiveMessage() {
  const int from = cloudbake_receive();
  if (from < 0) return std::nullopt;
  HelperMessage message{from, HelperMessage::Kind(cloudbake_message_kind()), std::string(cloudbake_message_size(), '\0')};
  cloudbake_take_message(message.bytes.data());
  return message;
}

void sendToParent(std::string_view bytes) { cloudbake_send(0, bytes.data(), bytes.size()); }

}  // namespace cloudbake
