// What oneTBB calls to suspend a task, which no task of this program does: Emscripten has no contexts.
#include <stdlib.h>
#include <ucontext.h>

int getcontext(ucontext_t* context) {
  (void)context;
  return 0;
}

void makecontext(ucontext_t* context, void (*function)(void), int count, ...) {
  (void)context, (void)function, (void)count;
  abort();
}

int swapcontext(ucontext_t* from, const ucontext_t* to) {
  (void)from, (void)to;
  abort();
}
