// Computations that run side by side, one per ray, so that the next values that all of them ask for are computed at once.
#pragma once

#include <coroutine>
#include <exception>
#include <span>
#include <utility>
#include <vector>

namespace cloudbake {

/// A computation that asks and goes on with the answer: a coroutine in which `co_await request` is the answer. It is made by calling a
/// coroutine function that returns it, and runs up to its first question. What the coroutine function takes by reference must outlive it.
/// All three types have a default.
template <typename Request, typename Answer, typename Result>
class Asking {
 public:
  struct promise_type {
    Request request{};
    Answer answer{};
    Result result{};

    Asking get_return_object() { return Asking(std::coroutine_handle<promise_type>::from_promise(*this)); }
    std::suspend_never initial_suspend() noexcept { return {}; }
    std::suspend_always final_suspend() noexcept { return {}; }
    void return_value(Result value) { result = std::move(value); }
    [[noreturn]] void unhandled_exception() { throw; }
    auto await_transform(const Request& asked) {
      request = asked;
      struct Waiting {
        promise_type& promise;
        bool await_ready() const noexcept { return false; }
        void await_suspend(std::coroutine_handle<>) const noexcept {}
        Answer await_resume() const noexcept { return promise.answer; }
      };
      return Waiting{*this};
    }
  };

  Asking(Asking&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  ~Asking() {
    if (handle_) handle_.destroy();
  }

  bool asks() const { return !handle_.done(); }
  const Request& request() const { return handle_.promise().request; }
  /// Goes on up to the next question or to the end.
  void take(const Answer& answer) {
    handle_.promise().answer = answer;
    handle_.resume();
  }
  /// Once it asks no more.
  const Result& result() const { return handle_.promise().result; }

 private:
  explicit Asking(std::coroutine_handle<promise_type> handle) : handle_(handle) {}
  std::coroutine_handle<promise_type> handle_;
};

/// Runs one computation; answer(request) → Answer.
template <typename Request, typename Answer, typename Result, typename AnswerOne>
Result runAlone(Asking<Request, Answer, Result> task, const AnswerOne& answer) {
  while (task.asks()) task.take(answer(task.request()));
  return task.result();
}

/// Runs all of them to their ends; answer_all(span of requests, span of answers) fills the answers in.
template <typename Request, typename Answer, typename Result, typename AnswerAll>
void runSideBySide(std::span<Asking<Request, Answer, Result>> tasks, const AnswerAll& answer_all) {
  std::vector<Asking<Request, Answer, Result>*> asking;
  for (auto& task : tasks)
    if (task.asks()) asking.push_back(&task);
  std::vector<Request> requests;
  std::vector<Answer> answers;
  while (!asking.empty()) {
    requests.clear();
    for (const auto* task : asking) requests.push_back(task->request());
    answers.resize(requests.size());
    answer_all(std::span<const Request>(requests), std::span<Answer>(answers));
    size_t kept = 0;
    for (size_t i = 0; i < asking.size(); ++i) {
      asking[i]->take(answers[i]);
      if (asking[i]->asks()) asking[kept++] = asking[i];
    }
    asking.resize(kept);
  }
}

}  // namespace cloudbake
