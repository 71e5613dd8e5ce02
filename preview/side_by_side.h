// Computations that run side by side, one per ray, so that the next values that all of them ask for are computed at once.
// docs/architecture.md, Difficult parts, says what they rely on.
#pragma once

#include <coroutine>
#include <exception>
#include <functional>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

namespace cloudbake {

/// A parameter of a coroutine function that is not copied, because it outlives the computation. The compiler refuses a temporary object.
template <typename T>
using Outliving = std::reference_wrapper<const T>;

/// A computation that asks and goes on with the answer: a coroutine in which `co_await request` is the answer. It is made by calling a
/// coroutine function that returns it, and runs up to its first question. All three types have a default. A call that does not fit, such as
/// an answer where nothing was asked, throws std::logic_error. An error in the coroutine ends it and is thrown by result().
template <typename Request, typename Answer, typename Result>
class Asking {
 public:
  struct promise_type {
    Request request{};
    Answer answer{};
    Result result{};
    std::exception_ptr failure{};

    Asking get_return_object() { return Asking(std::coroutine_handle<promise_type>::from_promise(*this)); }
    std::suspend_never initial_suspend() noexcept { return {}; }
    std::suspend_always final_suspend() noexcept { return {}; }
    void return_value(Result value) { result = std::move(value); }
    // Were it thrown on from here, GCC would free a coroutine twice that fails before its first question.
    void unhandled_exception() noexcept { failure = std::current_exception(); }
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

  bool asks() const { return handle_ && !handle_.done(); }
  const Request& request() const { return promiseIf(asks()).request; }
  /// Goes on up to the next question or to the end.
  void take(const Answer& answer) {
    promiseIf(asks()).answer = answer;
    handle_.resume();
  }
  /// Once it asks no more.
  const Result& result() const {
    const promise_type& ended = promiseIf(handle_ && handle_.done());
    if (ended.failure) std::rethrow_exception(ended.failure);
    return ended.result;
  }

 private:
  explicit Asking(std::coroutine_handle<promise_type> handle) : handle_(handle) {}
  promise_type& promiseIf(bool fits) const {
    if (!fits) throw std::logic_error("Asking: a question, an answer or a result where there is none");
    return handle_.promise();
  }
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

template <typename Request, typename Answer, typename Result, typename... Parameters>
struct std::coroutine_traits<cloudbake::Asking<Request, Answer, Result>, Parameters...> {
  static_assert((!std::is_reference_v<Parameters> && ...), "a computation outlives the call: it takes values, or Outliving<T>");
  using promise_type = typename cloudbake::Asking<Request, Answer, Result>::promise_type;
};
