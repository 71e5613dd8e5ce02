// Copies of the program that run beside it, in threads of Node, and what is sent between them. A copy that crashes harms no other.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cloudbake {

/// A copy of the program; it is stopped with this object.
class Helper {
 public:
  /// `words` is its command line, without the program's name.
  explicit Helper(const std::vector<std::string>& words);
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
  int from = 0;  ///< its number; 0 is the process that started this one
  Kind kind = Kind::kBytes;
  std::string bytes{};  ///< of kEnded the exit code, of kCrashed what happened
};

/// Waits for the next message; nothing if none came in this time.
std::optional<HelperMessage> receiveMessage(std::optional<double> seconds = std::nullopt);

/// Sends bytes to the process that started this one.
void sendToParent(std::string_view bytes);

}  // namespace cloudbake
