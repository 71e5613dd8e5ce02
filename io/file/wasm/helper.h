// Copies of the program that help this one, in threads of Node, and what is sent between them. A copy that crashes harms no other.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace cloudbake {

/// A copy of the program with the same command line; it is stopped with this object.
class Helper {
 public:
  Helper();
  Helper(const Helper&) = delete;
  Helper& operator=(const Helper&) = delete;
  Helper(Helper&& other) noexcept;
  ~Helper();
  int number() const { return number_; }
  void send(std::string_view bytes) const;

 private:
  int number_;
};

/// What a helper has sent, or how it ended.
struct HelperMessage {
  enum class Kind { kBytes, kEnded, kCrashed };
  int from = 0;  ///< its number; 0 is the copy that started this one
  Kind kind = Kind::kBytes;
  std::string bytes{};  ///< of kEnded the exit code, of kCrashed what happened
};

/// Waits for the next message; nothing if a signal came meanwhile.
std::optional<HelperMessage> receiveMessage();

/// Sends bytes to the copy that started this one.
void sendToParent(std::string_view bytes);

}  // namespace cloudbake
