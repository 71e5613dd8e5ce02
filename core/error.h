// The error types. An error is thrown where it is found and caught in app/main, or in a batch where the work on one asset ends. Each type
// has its exit code.
#pragma once

#include <algorithm>
#include <exception>
#include <string>

namespace cloudbake {

/// Exit codes of every command; `cloudbake --help` prints them.
enum class ExitCode {
  kDone = 0,
  kUsage = 1,          ///< wrong command line, option out of range
  kSystem = 2,         ///< the system refused: a missing file, no permission, a full disk
  kInput = 3,          ///< bytes were read but are unusable, or exceed a limit
  kInternal = 4,       ///< a bug in cloudbake
  kBound = 5,          ///< an error bound was exceeded, or some assets of a batch failed
  kTryAgain = 75,      ///< locked by another run
  kHungUp = 129,       ///< stopped by SIGHUP
  kInterrupted = 130,  ///< stopped by SIGINT
  kBrokenPipe = 141,   ///< stopped by SIGPIPE
  kTerminated = 143    ///< stopped by SIGTERM
};

/// Base of all errors: where it happened (file, line, column; 0 = unknown) and a message that says what is wrong and how to cure it.
class Error : public std::exception {
 public:
  Error(ExitCode exit_code, std::string in_file, int at_line, int at_column, std::string what_and_cure)
      : code(exit_code), file(std::move(in_file)), line(at_line), column(at_column), message(std::move(what_and_cure)) {
    text_ = file;
    if (line > 0) text_ += ":" + std::to_string(line);
    if (line > 0 && column > 0) text_ += ":" + std::to_string(column);
    text_ += (text_.empty() ? "" : ": ") + message;
    std::replace(text_.begin(), text_.end(), '\0', ' ');  // from a damaged file; it would end what()
  }
  /// `FILE:LINE:COLUMN: message`, without the parts that are unknown.
  const char* what() const noexcept override { return text_.c_str(); }

  ExitCode code;
  std::string file;
  int line, column;
  std::string message;

 private:
  std::string text_;
};

/// The command line is wrong.
struct UsageError : Error {
  explicit UsageError(std::string what_and_cure) : Error(ExitCode::kUsage, "", 0, 0, std::move(what_and_cure)) {}
};

/// A file was read but cannot be used, or asks for more than a limit allows.
struct InputError : Error {
  InputError(std::string in_file, std::string what_and_cure) : InputError(std::move(in_file), 0, 0, std::move(what_and_cure)) {}
  InputError(std::string in_file, int at_line, std::string what_and_cure)
      : InputError(std::move(in_file), at_line, 0, std::move(what_and_cure)) {}
  InputError(std::string in_file, int at_line, int at_column, std::string what_and_cure)
      : Error(ExitCode::kInput, std::move(in_file), at_line, at_column, std::move(what_and_cure)) {}
};

/// More memory is needed than there is, or than a limit allows. With more of it the same run may succeed.
struct MemoryError : InputError {
  MemoryError(std::string in_file, std::string what_and_cure) : InputError(std::move(in_file), std::move(what_and_cure)) {}
};

/// The system refused to read or write a file.
struct IoError : Error {
  IoError(std::string in_file, std::string what_and_cure) : Error(ExitCode::kSystem, std::move(in_file), 0, 0, std::move(what_and_cure)) {}
};

/// Runs `body`. If it throws an error that names no file, the error is thrown again with `file` as its file.
template <class Body>
auto namingFile(const std::string& file, const Body& body) {
  try {
    return body();
  } catch (const MemoryError& error) {
    if (!error.file.empty()) throw;
    throw MemoryError(file, error.message);
  } catch (const InputError& error) {
    if (!error.file.empty()) throw;
    throw InputError(file, error.line, error.column, error.message);
  } catch (const Error& error) {
    if (!error.file.empty() || error.code == ExitCode::kUsage) throw;
    throw Error(error.code, file, error.line, error.column, error.message);
  }
}

}  // namespace cloudbake
