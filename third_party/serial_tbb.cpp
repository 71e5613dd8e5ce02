// What oneTBB's headers call, for a system without threads (WebAssembly in a page): tasks wait in a stack, and the one thread runs them
// while it waits for a group. As in oneTBB's dispatcher, a task that throws cancels its group, is cancelled itself, and whoever waits gets
// the exception.
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

// The program is compiled for threads. If it is linked for one thread, values of the thread have addresses from 0, and wasm-ld 14 would add
// the place of the first one.
asm(".globaltype __tls_base, i32\n.globl __tls_base\n__tls_base:\n");

namespace tbb::detail::r1 {

class tbb_exception_ptr {
 public:
  std::exception_ptr exception;
};

struct task_group_context_impl {
  static void begin(d1::task_group_context& context) {
    context.my_cancellation_requested = 0;
    context.my_exception = nullptr;
    context.my_state = d1::task_group_context::state::isolated;
    context.my_parent = nullptr;
  }
  static void end(d1::task_group_context& context) {
    if (context.is_proxy()) return;
    delete context.my_exception.exchange(nullptr);
  }
  static bool cancel(d1::task_group_context& context) { return context.actual_context().my_cancellation_requested.exchange(1) == 0; }
  static bool isCancelled(d1::task_group_context& context) { return context.actual_context().my_cancellation_requested != 0; }
  static void keep(d1::task_group_context& context, std::exception_ptr exception) {
    d1::task_group_context& actual = context.actual_context();
    if (cancel(context) || !actual.my_exception) delete actual.my_exception.exchange(new tbb_exception_ptr{std::move(exception)});
  }
  static std::exception_ptr takeException(d1::task_group_context& context) {
    tbb_exception_ptr* kept = context.actual_context().my_exception.exchange(nullptr);
    const std::exception_ptr exception = kept ? kept->exception : nullptr;
    delete kept;
    return exception;
  }
};

class task_dispatcher {
 public:
  static bool goesOn(const d1::wait_context& group) { return group.continue_execution(); }
};

namespace {

struct Waiting {
  d1::task* task;
  d1::task_group_context* context;
};
std::vector<Waiting> waiting;
d1::task_group_context* current = nullptr;

void runTask(d1::task* task, d1::task_group_context& context) {
  d1::task_group_context* const outer = std::exchange(current, &context);
  d1::execution_data data{&context, 0, d1::no_slot};
  while (task) try {
      task = task_group_context_impl::isCancelled(context) ? task->cancel(data) : task->execute(data);
    } catch (...) {
      task_group_context_impl::keep(context, std::current_exception());
    }
  current = outer;
}

}  // namespace

void spawn(d1::task& task, d1::task_group_context& context) { waiting.push_back({&task, &context}); }
void spawn(d1::task& task, d1::task_group_context& context, d1::slot_id) { r1::spawn(task, context); }
void submit(d1::task& task, d1::task_group_context& context, arena*, std::uintptr_t) { r1::spawn(task, context); }

void wait(d1::wait_context& group, d1::task_group_context& context) {
  while (task_dispatcher::goesOn(group)) {
    if (waiting.empty()) std::abort();  // nobody else could end it
    const Waiting next = waiting.back();
    waiting.pop_back();
    runTask(next.task, *next.context);
  }
  if (const std::exception_ptr exception = task_group_context_impl::takeException(context)) std::rethrow_exception(exception);
}

void execute_and_wait(d1::task& task, d1::task_group_context& of_task, d1::wait_context& group, d1::task_group_context& of_group) {
  runTask(&task, of_task);
  r1::wait(group, of_group);
}

d1::slot_id execution_slot(const d1::execution_data*) { return 0; }
d1::task_group_context* current_context() { return current; }
void notify_waiters(std::uintptr_t) {}

void initialize(d1::task_group_context& context) { task_group_context_impl::begin(context); }
void destroy(d1::task_group_context& context) { task_group_context_impl::end(context); }
void reset(d1::task_group_context& context) { task_group_context_impl::end(context), task_group_context_impl::begin(context); }
bool cancel_group_execution(d1::task_group_context& context) { return task_group_context_impl::cancel(context); }
bool is_group_execution_cancelled(d1::task_group_context& context) { return task_group_context_impl::isCancelled(context); }
void capture_fp_settings(d1::task_group_context&) {}

void initialize(d1::task_arena_base&) {}
void terminate(d1::task_arena_base&) {}
bool attach(d1::task_arena_base&) { return true; }
void execute(d1::task_arena_base&, d1::delegate_base& work) { work(); }
void isolate_within_arena(d1::delegate_base& work, std::intptr_t) { work(); }
int max_concurrency(const d1::task_arena_base*) { return 1; }

void create(d1::global_control&) {}
void destroy(d1::global_control&) {}
std::size_t global_control_active_value(int) { return 1; }

// One item after the other goes through all filters.
class pipeline {
 public:
  explicit pipeline(const d1::filter_node& chain) { add(chain); }
  void run(d1::task_group_context& context) {
    for (;;) {
      void* item = (*filters_.front())(nullptr);
      if (has_ended_ || task_group_context_impl::isCancelled(context)) break;
      for (std::size_t i = 1; i < filters_.size(); ++i) item = (*filters_[i])(item);
    }
  }
  static void end(d1::base_filter& filter) { filter.my_pipeline->has_ended_ = true; }

 private:
  struct Delete {
    void operator()(d1::base_filter* filter) const {
      filter->~base_filter();
      r1::deallocate_memory(filter);
    }
  };
  void add(const d1::filter_node& node) {
    if (node.left && node.right) {
      add(*node.left);
      add(*node.right);
    } else {
      filters_.emplace_back(node.create_filter())->my_pipeline = this;
    }
  }
  std::vector<std::unique_ptr<d1::base_filter, Delete>> filters_;
  bool has_ended_ = false;
};

void parallel_pipeline(d1::task_group_context& context, std::size_t, const d1::filter_node& chain) { pipeline(chain).run(context); }
void set_end_of_input(d1::base_filter& filter) { pipeline::end(filter); }

void* allocate_memory(std::size_t bytes) { return ::operator new(bytes); }
void deallocate_memory(void* block) { ::operator delete(block); }
bool is_tbbmalloc_used() { return false; }
constexpr std::align_val_t kLine{128};
void* cache_aligned_allocate(std::size_t bytes) { return ::operator new(bytes, kLine); }
void cache_aligned_deallocate(void* block) { ::operator delete(block, kLine); }
std::size_t cache_line_size() { return std::size_t(kLine); }
void* allocate(d1::small_object_pool*& pool, std::size_t bytes) {
  static char any_pool;  // an address for what is never looked at
  pool = reinterpret_cast<d1::small_object_pool*>(&any_pool);
  return cache_aligned_allocate(bytes);
}
void* allocate(d1::small_object_pool*& pool, std::size_t bytes, const d1::execution_data&) { return allocate(pool, bytes); }
void deallocate(d1::small_object_pool&, void* block, std::size_t) { cache_aligned_deallocate(block); }
void deallocate(d1::small_object_pool&, void* block, std::size_t, const d1::execution_data&) { cache_aligned_deallocate(block); }

void wait_on_address(void*, d1::delegate_base&, std::uintptr_t) { std::abort(); }
void notify_by_address(void*, std::uintptr_t) {}
void notify_by_address_one(void*) {}
void notify_by_address_all(void*) {}

void throw_exception(exception_id id) {
  switch (id) {
    case exception_id::bad_alloc: throw std::bad_alloc();
    case exception_id::out_of_range: throw std::out_of_range("Index out of requested size range");
    case exception_id::reservation_length_error: throw std::length_error("Attempt to exceed implementation defined length limits");
    default: throw std::runtime_error("a container or a group of tasks was used in a wrong way");
  }
}

}  // namespace tbb::detail::r1
