#include "preview/side_by_side.h"

#include <gtest/gtest.h>

#include <memory>

using namespace cloudbake;

namespace {

using Answers = std::vector<int>;
using Task = Asking<int, int, Answers>;

// Asks first, first + 1, …
Task ask(int first, int count) {
  Answers answers;
  for (int i = 0; i < count; ++i) {
    const int answer = co_await (first + i);
    answers.push_back(answer);
  }
  co_return answers;
}

struct Failure {};

// Fails after `questions` of them. It holds what it is given until it ends.
Task fail(int questions, std::shared_ptr<int> held) {
  for (int i = 0; i < questions; ++i) *held = co_await i;
  if (*held != -1) throw Failure();
  co_return Answers{};
}

int square(int request) { return request * request; }

void squareAll(std::span<const int> requests, std::span<int> answers) {
  ASSERT_EQ(requests.size(), answers.size());
  for (size_t i = 0; i < requests.size(); ++i) answers[i] = square(requests[i]);
}

}  // namespace

TEST(SideBySide, EachGetsWhatItWouldGetAlone) {
  const std::vector<int> counts{3, 0, 7, 1, 0, 4, 4, 2};
  std::vector<Task> tasks;
  for (size_t i = 0; i < counts.size(); ++i) tasks.push_back(ask(int(100 * i), counts[i]));
  size_t rounds = 0, questions = 0;
  runSideBySide(std::span(tasks), [&](std::span<const int> requests, std::span<int> answers) {
    ++rounds, questions += requests.size();
    squareAll(requests, answers);
  });
  for (size_t i = 0; i < counts.size(); ++i) {
    EXPECT_EQ(tasks[i].result(), runAlone(ask(int(100 * i), counts[i]), square)) << i;
    EXPECT_EQ(tasks[i].result().size(), size_t(counts[i])) << i;
  }
  EXPECT_EQ(rounds, 7U) << "the most questions of one";
  EXPECT_EQ(questions, 21U);
}

TEST(SideBySide, HasAnAnswerPerQuestionAndAResultAtTheEnd) {
  Task task = ask(5, 1);
  EXPECT_EQ(task.request(), 5);
  EXPECT_THROW(task.result(), std::logic_error);
  task.take(25);
  EXPECT_FALSE(task.asks());
  EXPECT_THROW(task.request(), std::logic_error);
  EXPECT_THROW(task.take(0), std::logic_error);
  const Task moved = std::move(task);
  EXPECT_EQ(moved.result(), Answers{25});
  EXPECT_FALSE(task.asks());  // NOLINT(bugprone-use-after-move)
  EXPECT_THROW(task.result(), std::logic_error);
}

// Whether it fails at its start or later, it is freed once, and the others go on.
TEST(SideBySide, AFailureComesOutOfTheResult) {
  const auto held = std::make_shared<int>(0);
  for (const int questions : {0, 1, 3}) {
    std::vector<Task> tasks;
    tasks.push_back(fail(questions, held));
    tasks.push_back(ask(1, 2));
    runSideBySide(std::span(tasks), squareAll);
    EXPECT_THROW(tasks[0].result(), Failure) << questions;
    EXPECT_EQ(tasks[1].result(), (Answers{1, 4})) << questions;
  }
  EXPECT_EQ(held.use_count(), 1);
}
